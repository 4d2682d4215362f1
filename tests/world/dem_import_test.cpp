#include "tests/world/dem_support.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sahel::dem_test {
namespace {

namespace fs = std::filesystem;
constexpr double k_none = std::numeric_limits<double>::quiet_NaN();

int32_t ticks(double metres) {
    return static_cast<int32_t>(std::llround(metres * 131072.0));
}

/// Hills with heights that no float holds exactly.
double hills(double x, double y) {
    return 812.3 + 90.0 * std::sin(x / 37.0) * std::cos(y / 29.0) + 11.0 * std::sin((x + 2 * y) / 9.0);
}
Grid hills_grid(int w, int h) {
    return {w, h, [](int x, int y) { return hills(x, y); }};
}

TEST(DemImport, EveryCellIsTheFilesHeightToTheTick) {
    const TempFolder t;
    const Grid grid = hills_grid(300, 211);
    write_gdal(t / "a.tif", "GTiff", "Float64", grid);
    const Imported w = import_files({t / "a.tif"}, plain_options());
    ASSERT_TRUE(w.report.ok()) << w.report.error().message;
    for (int y = 0; y < 211; ++y)
        for (int x = 0; x < 300; ++x) {
            ASSERT_EQ(w.sink.surface_ticks(x, y), ticks(grid.at(x, y))) << x << ", " << y;
            ASSERT_EQ(w.sink.mask(x, y), 0);
            ASSERT_EQ(w.sink.ticks(Layer::water, x, y), 0);
            ASSERT_GE(w.sink.ticks(Layer::soil, x, y), 0);
            ASSERT_GE(w.sink.ticks(Layer::sand, x, y), 0);
        }
    EXPECT_EQ(w.sink.mask(300, 5), k_mask_outside);
    const DemImportReport& r = w.report.value();
    EXPECT_EQ(r.width, 300);
    EXPECT_EQ(r.height, 211);
    EXPECT_EQ(r.tiles, 6);
    EXPECT_EQ(r.cell_m, 1.0);
    EXPECT_EQ(r.filled_cells, 0);
    EXPECT_EQ(r.files.at(0).format, "GTiff");
    EXPECT_NEAR(r.min_m, *std::min_element(grid.h.begin(), grid.h.end()), 1e-5);
    EXPECT_NEAR(r.max_m, *std::max_element(grid.h.begin(), grid.h.end()), 1e-5);
    EXPECT_EQ(w.sink.desc.preset, "none");
    ASSERT_TRUE(w.sink.desc.georeference);
    EXPECT_EQ(w.sink.desc.georeference->origin_x, 500000.0);
    EXPECT_EQ(w.sink.desc.georeference->origin_y, 4000000.0);
    EXPECT_EQ(w.sink.desc.georeference->cell_y, -1.0);
    EXPECT_NE(w.sink.desc.georeference->projection_wkt.find("UTM zone 11N"), std::string::npos);
}

TEST(DemImport, DatumShiftsAndIsKept) {
    const TempFolder t;
    const Grid grid = hills_grid(140, 130);
    write_gdal(t / "a.tif", "GTiff", "Float64", grid);
    DemImportOptions options = plain_options();
    options.datum_m = 700.25;
    const Imported w = import_files({t / "a.tif"}, options);
    ASSERT_TRUE(w.report.ok()) << w.report.error().message;
    EXPECT_EQ(w.sink.surface_ticks(17, 99), ticks(grid.at(17, 99) - 700.25));
    EXPECT_EQ(w.sink.desc.georeference->datum_m, 700.25);
    EXPECT_NEAR(w.report.value().min_m, *std::min_element(grid.h.begin(), grid.h.end()), 1e-5);
}

TEST(DemImport, FormatsAgree) {
    const TempFolder t;
    const Grid whole{150, 140, [](int x, int y) { return std::round(hills(x, y)); }};
    write_gdal(t / "a.tif", "GTiff", "Int16", whole);
    write_gdal(t / "b.asc", "AAIGrid", "Int32", whole);
    write_gdal(t / "c.png", "PNG", "UInt16", whole);
    write_exr(t / "d.exr", whole, "Y", 1.0f);
    write_exr(t / "e.exr", whole, "height", 1.0f);
    write_raw16(t / "f.raw", whole, false);
    write_raw16(t / "g.r16", whole, true);
    // South up: rows from the bottom.
    const Grid turned{150, 140, [&](int x, int y) { return whole.at(x, 139 - y); }};
    write_gdal(t / "h.tif", "GTiff", "Float32", turned, {.y = 4000000.0 - 140.0, .cell_y = 1.0});
    DemImportOptions options = plain_options();
    options.source.raw = {.width = 150, .height = 140};
    std::vector<int32_t> first;
    for (const char* name : {"a.tif", "b.asc", "c.png", "d.exr", "e.exr", "f.raw", "g.r16", "h.tif"}) {
        options.source.raw.big_endian = std::string(name) == "g.r16";
        const Imported w = import_files({t / name}, options);
        ASSERT_TRUE(w.report.ok()) << name << ": " << w.report.error().message;
        ASSERT_EQ(w.sink.surface_ticks(31, 77), ticks(whole.at(31, 77))) << name;
        const std::vector<int32_t> all = w.sink.all({0, 0, 256, 256});
        if (first.empty()) first = all;
        EXPECT_EQ(all, first) << name;
    }
}

TEST(DemImport, RangeMapsStoredValuesToMetres) {
    const TempFolder t;
    const Grid bytes{130, 130, [](int x, int y) { return (x * 7 + y * 3) % 256; }};
    write_gdal(t / "a.png", "PNG", "Byte", bytes);
    const Grid unit{130, 130, [&](int x, int y) { return bytes.at(x, y) / 255.0; }};
    write_gdal(t / "b.tif", "GTiff", "Float64", unit);
    const Grid words{130, 130, [&](int x, int y) { return bytes.at(x, y) * 257.0; }};
    write_gdal(t / "c.png", "PNG", "UInt16", words);
    write_raw16(t / "d.r16", words, false);
    std::vector<uint8_t> raw8;
    for (const double v : bytes.h) raw8.push_back(static_cast<uint8_t>(v));
    write_bytes(t / "e.r8", raw8);
    DemImportOptions options = plain_options();
    options.source.range = DemRange{-100.0, 410.0};
    for (const char* name : {"a.png", "b.tif", "c.png", "d.r16", "e.r8"}) {
        const Imported w = import_files({t / name}, options);
        ASSERT_TRUE(w.report.ok()) << name << ": " << w.report.error().message;
        for (int i = 0; i < 130; ++i)
            ASSERT_NEAR(w.sink.surface_m(i, 129 - i), -100.0 + 2.0 * bytes.at(i, 129 - i), 1e-5) << name;
    }
}

TEST(DemImport, FeetAndScaledBandsBecomeMetres) {
    const TempFolder t;
    GDALAllRegister();
    const Grid feet{128, 128, [](int x, int y) { return 1000.0 + x + 2 * y; }};
    write_gdal(t / "a.tif", "GTiff", "Float64", feet);
    {
        auto* d = static_cast<GDALDataset*>(GDALOpen((t / "a.tif").c_str(), GA_Update));
        d->GetRasterBand(1)->SetUnitType("ft");
        GDALClose(d);
    }
    const Imported w = import_files({t / "a.tif"}, plain_options());
    ASSERT_TRUE(w.report.ok()) << w.report.error().message;
    EXPECT_EQ(w.sink.surface_ticks(5, 6), ticks(1017.0 * 0.3048));
}

TEST(DemImport, HalvesGiveWhatTheWholeGives) {
    const TempFolder t;
    const Grid whole = hills_grid(260, 200);
    write_gdal(t / "whole.tif", "GTiff", "Float64", whole, {.cell_x = 30.0, .cell_y = -30.0});
    const auto part = [&](int x0, int y0, int w, int h) {
        return Grid{w, h, [&](int x, int y) { return whole.at(x0 + x, y0 + y); }};
    };
    const auto place = [](int x0, int y0) {
        return GridPlace{.x = 500000.0 + 30.0 * x0, .y = 4000000.0 - 30.0 * y0, .cell_x = 30.0, .cell_y = -30.0};
    };
    write_gdal(t / "west.tif", "GTiff", "Float64", part(0, 0, 131, 200), place(0, 0));
    write_gdal(t / "east.tif", "GTiff", "Float64", part(127, 0, 133, 200), place(127, 0)); // four columns overlap
    for (const double cell : {0.0, 11.0, 90.0}) {
        DemImportOptions options = plain_options();
        options.cell_m = cell;
        const Imported a = import_files({t / "whole.tif"}, options);
        const Imported b = import_files({t / "east.tif", t / "west.tif"}, options);
        ASSERT_TRUE(a.report.ok()) << a.report.error().message;
        ASSERT_TRUE(b.report.ok()) << b.report.error().message;
        EXPECT_EQ(a.report.value().width, b.report.value().width);
        EXPECT_EQ(a.report.value().georeference.origin_x, b.report.value().georeference.origin_x);
        const CellRect all{0, 0, a.report.value().width, a.report.value().height};
        EXPECT_EQ(a.sink.all(all), b.sink.all(all)) << "cell " << cell;
    }
}

TEST(DemImport, BicubicFollowsASmoothSurface) {
    // Wave lengths of 40 samples and more: Keys' cubic errs by h^3 f'''/... of the amplitude, far below a linear one.
    const TempFolder t;
    const auto f = [](double x, double y) { return 500.0 + 50.0 * std::sin(x / 200.0) * std::cos(y / 250.0); };
    const Grid grid{120, 110, [&](int x, int y) { return f((x + 0.5) * 30.0, (y + 0.5) * 30.0); }};
    write_gdal(t / "a.tif", "GTiff", "Float64", grid, {.cell_x = 30.0, .cell_y = -30.0});
    DemImportOptions options = plain_options();
    options.cell_m = 10.0;
    const Imported w = import_files({t / "a.tif"}, options);
    ASSERT_TRUE(w.report.ok()) << w.report.error().message;
    ASSERT_EQ(w.report.value().width, 360);
    ASSERT_EQ(w.report.value().height, 330);
    double worst = 0.0, worst_linear = 0.0;
    for (int y = 6; y < 324; ++y)
        for (int x = 6; x < 354; ++x) {
            const double want = f((x + 0.5) * 10.0, (y + 0.5) * 10.0);
            worst = std::max(worst, std::abs(w.sink.surface_m(x, y) - want));
            const double u = (x + 0.5) / 3.0 - 0.5, v = (y + 0.5) / 3.0 - 0.5;
            const int i = static_cast<int>(u), j = static_cast<int>(v);
            const double a = u - i, b = v - j;
            const double linear = (1 - b) * ((1 - a) * grid.at(i, j) + a * grid.at(i + 1, j)) +
                                  b * ((1 - a) * grid.at(i, j + 1) + a * grid.at(i + 1, j + 1));
            worst_linear = std::max(worst_linear, std::abs(linear - want));
        }
    EXPECT_LT(worst, 0.02);
    EXPECT_LT(worst, worst_linear / 8.0);
}

TEST(DemImport, LargerCellsAverage) {
    // A checkerboard of 0 and 100 m: skipping samples would give either, averaging gives 50.
    const TempFolder t;
    const Grid grid{400, 400, [](int x, int y) { return ((x + y) % 2) * 100.0 + 1.0; }};
    write_gdal(t / "a.tif", "GTiff", "Float32", grid);
    DemImportOptions options = plain_options();
    options.cell_m = 4.0;
    const Imported w = import_files({t / "a.tif"}, options);
    ASSERT_TRUE(w.report.ok()) << w.report.error().message;
    ASSERT_EQ(w.report.value().width, 100);
    for (int i = 4; i < 96; ++i) EXPECT_NEAR(w.sink.surface_m(i, i / 2 + 10), 51.0, 2.0);
}

TEST(DemImport, VoidsAreDrawnInFromTheirRim) {
    const TempFolder t;
    const auto hole = [](int x, int y) { return (x - 70) * (x - 70) + (y - 60) * (y - 60) < 33 * 33; };
    // A plane is its own membrane: the fill must find it again.
    const Grid grid{200, 150, [&](int x, int y) { return hole(x, y) ? k_none : 300.0 + 0.5 * x - 0.25 * y; }};
    write_gdal(t / "a.tif", "GTiff", "Float32", grid, {}, -9999.0);
    const Imported w = import_files({t / "a.tif"}, plain_options());
    ASSERT_TRUE(w.report.ok()) << w.report.error().message;
    int64_t holes = 0;
    double lo = 1e9, hi = -1e9, worst = 0.0;
    for (int y = 0; y < 150; ++y)
        for (int x = 0; x < 200; ++x) {
            const bool h = hole(x, y);
            holes += h;
            ASSERT_EQ(w.sink.mask(x, y), h ? k_mask_filled : 0) << x << ", " << y;
            const double v = w.sink.surface_m(x, y);
            if (!h) {
                ASSERT_EQ(w.sink.surface_ticks(x, y), ticks(grid.at(x, y)));
                if (hole(x - 1, y) || hole(x + 1, y) || hole(x, y - 1) || hole(x, y + 1))
                    lo = std::min(lo, v), hi = std::max(hi, v);
                continue;
            }
            worst = std::max(worst, std::abs(v - (300.0 + 0.5 * x - 0.25 * y)));
        }
    EXPECT_EQ(w.report.value().filled_cells, holes);
    for (int y = 27; y < 94; ++y)
        for (int x = 37; x < 104; ++x)
            if (hole(x, y)) {
                EXPECT_GE(w.sink.surface_m(x, y), lo - 1e-4);
                EXPECT_LE(w.sink.surface_m(x, y), hi + 1e-4);
                const double step = std::abs(w.sink.surface_m(x + 1, y) - w.sink.surface_m(x, y));
                EXPECT_LT(step, 1.5) << "a step beside " << x << ", " << y;
            }
    EXPECT_LT(worst, 0.06 * (hi - lo)) << "rim " << lo << " .. " << hi;
}

TEST(DemImport, NoOvershootBesideVoids) {
    // A cliff of 1000 m beside the void, resampled finer: cubic weights would ring below 0 and above 1000.
    const TempFolder t;
    const Grid grid{60, 60, [](int x, int) { return x >= 28 && x < 32 ? k_none : x < 28 ? 0.0 : 1000.0; }};
    write_gdal(t / "a.tif", "GTiff", "Float32", grid, {.cell_x = 10.0, .cell_y = -10.0}, -1.0);
    DemImportOptions options = plain_options();
    options.cell_m = 3.0;
    const Imported w = import_files({t / "a.tif"}, options);
    ASSERT_TRUE(w.report.ok()) << w.report.error().message;
    for (int y = 0; y < 200; ++y)
        for (int x = 0; x < 200; ++x) {
            ASSERT_GE(w.sink.surface_m(x, y), 0.0);
            ASSERT_LE(w.sink.surface_m(x, y), 1000.0);
        }
    EXPECT_EQ(w.sink.mask(100, 50), k_mask_filled);
}

TEST(DemImport, SeaReachesWhatTheEdgeConnects) {
    const TempFolder t;
    // West: sea at exactly 0. A basin below sea level lies inland. A bay connects through a channel one cell wide.
    const auto f = [](int x, int y) {
        if (x < 60) return 0.0;
        if (y == 30 && x < 100) return 0.0;                        // channel
        if (x >= 100 && x < 110 && y >= 25 && y < 36) return -0.2; // bay
        if (x >= 130 && x < 150 && y >= 80 && y < 99) return -30.0;
        return 5.0 + 0.1 * x;
    };
    write_gdal(t / "a.tif", "GTiff", "Float32", Grid{200, 140, f}, {.cell_x = 50.0, .cell_y = -50.0});
    DemImportOptions options = plain_options();
    options.sea_m = 0.0;
    options.shelf_m = 12.0;
    const Imported w = import_files({t / "a.tif"}, options);
    ASSERT_TRUE(w.report.ok()) << w.report.error().message;
    EXPECT_TRUE(w.report.value().made_up_sea_bed);
    EXPECT_EQ(w.report.value().sea_cells, 60 * 140 + 40 + 110);
    for (int y = 0; y < 140; ++y)
        for (int x = 0; x < 200; ++x) {
            const bool sea = x < 60 || (y == 30 && x < 100) || (x >= 100 && x < 110 && y >= 25 && y < 36);
            ASSERT_EQ(w.sink.mask(x, y), sea ? k_mask_sea : 0) << x << ", " << y;
            const int32_t ground = w.sink.surface_ticks(x, y), water = w.sink.ticks(Layer::water, x, y);
            if (sea) {
                ASSERT_EQ(ground + water, 0);
                ASSERT_GT(water, 0);
                ASSERT_LE(water, ticks(12.0));
            } else {
                ASSERT_EQ(water, 0);
                ASSERT_EQ(ground, ticks(static_cast<double>(static_cast<float>(f(x, y)))));
            }
        }
    // Deeper away from the shore: Dean's profile, 0.1 d^(2/3), to the shelf.
    for (int x = 1; x < 59; ++x) EXPECT_GE(w.sink.ticks(Layer::water, x, 100), w.sink.ticks(Layer::water, x + 1, 100));
    EXPECT_NEAR(w.sink.ticks(Layer::water, 40, 100) / 131072.0, 0.1 * std::pow(19.5 * 50.0, 2.0 / 3.0), 1e-3);
    EXPECT_EQ(w.sink.ticks(Layer::water, 0, 100), ticks(12.0));
    ASSERT_TRUE(w.sink.desc.sea_m);
    EXPECT_EQ(*w.sink.desc.sea_m, 0.0);
    EXPECT_LE(w.sink.desc.outside_m, -12.0);
}

TEST(DemImport, DepthsOfTheFileAreKept) {
    const TempFolder t;
    const auto f = [](int x, int) { return -80.0 + x; };
    write_gdal(t / "a.tif", "GTiff", "Float32", Grid{150, 130, f}, {.cell_x = 50.0, .cell_y = -50.0});
    DemImportOptions options = plain_options();
    options.sea_m = 3.0;
    options.datum_m = 1.0;
    const Imported w = import_files({t / "a.tif"}, options);
    ASSERT_TRUE(w.report.ok()) << w.report.error().message;
    EXPECT_FALSE(w.report.value().made_up_sea_bed);
    for (int x = 0; x < 150; ++x) {
        EXPECT_EQ(w.sink.surface_ticks(x, 9), ticks(f(x, 9) - 1.0));
        EXPECT_EQ(w.sink.ticks(Layer::water, x, 9), x <= 83 ? ticks(83.0 - x) : 0);
    }
}

TEST(DemImport, ResultDoesNotDependOnWindowsTilesOrMemory) {
    const TempFolder t;
    const Grid grid{400, 300, [](int x, int y) {
                        if ((x / 50 + y / 40) % 7 == 3 && (x * y) % 5) return k_none;
                        return x < 90 ? 0.0 : hills(x, y) - 780.0;
                    }};
    write_gdal(t / "a.tif", "GTiff", "Float64", grid,
               {.x = 1.0, .y = 42.0, .cell_x = 0.001, .cell_y = -0.001, .crs = "EPSG:4326"}, -7777.0);
    std::vector<int32_t> first;
    for (const auto& [memory_mib, tile] : {std::pair{512, 512}, std::pair{32, 128}, std::pair{64, 256}}) {
        DemImportOptions options = plain_options();
        options.cell_m = 60.0;
        options.sea_m = 0.0;
        options.edge_cells = 40;
        options.memory_bytes = static_cast<uint64_t>(memory_mib) << 20;
        options.tile_cells = tile;
        const Imported w = import_files({t / "a.tif"}, options);
        ASSERT_TRUE(w.report.ok()) << w.report.error().message;
        EXPECT_GT(w.report.value().filled_cells, 1000);
        EXPECT_GT(w.report.value().uncovered_cells, 100) << "degrees are no rectangle on the map";
        const std::vector<int32_t> all =
            w.sink.all({-40, -40, w.report.value().width + 40, w.report.value().height + 40});
        if (first.empty()) first = all;
        EXPECT_TRUE(all == first) << memory_mib << " MiB, tiles of " << tile;
    }
}

TEST(DemImport, SkirtRunsFromTheRimToThePlain) {
    const TempFolder t;
    write_gdal(t / "a.tif", "GTiff", "Float32", Grid{100, 90, [](int x, int y) { return 400.0 + x + y; }});
    DemImportOptions options = plain_options();
    options.edge_cells = 64;
    options.outside_m = 250.0;
    const Imported w = import_files({t / "a.tif"}, options);
    ASSERT_TRUE(w.report.ok()) << w.report.error().message;
    EXPECT_EQ(w.sink.desc.outside_m, 250.0);
    EXPECT_EQ(w.sink.surface_ticks(0, 0), ticks(400.0));
    EXPECT_EQ(w.sink.mask(-1, 5), k_mask_outside);
    EXPECT_NEAR(w.sink.surface_m(-1, 5), 405.0, 4.0);
    EXPECT_NEAR(w.sink.surface_m(-64, 5), 250.0, 0.5);
    EXPECT_EQ(w.sink.surface_ticks(-100, 5), ticks(250.0));
    for (int x = -64; x < 0; ++x) EXPECT_LT(std::abs(w.sink.surface_m(x, 40) - w.sink.surface_m(x + 1, 40)), 8.0);
}

TEST(DemImport, SeaGoesOnBeyondTheData) {
    const TempFolder t;
    // Mountains in the east would dam the sea in the west, if the skirt were drawn from the rim alone.
    const auto f = [](int x, int) { return x < 70 ? 0.0 : 25.0 * (x - 69); };
    write_gdal(t / "a.tif", "GTiff", "Float32", Grid{140, 140, f}, {.cell_x = 50.0, .cell_y = -50.0});
    DemImportOptions options = plain_options();
    options.sea_m = 0.0;
    options.edge_cells = 64;
    const Imported w = import_files({t / "a.tif"}, options);
    ASSERT_TRUE(w.report.ok()) << w.report.error().message;
    EXPECT_EQ(w.report.value().sea_cells, 70 * 140);
    for (int i = 0; i < 64; ++i) {
        ASSERT_EQ(w.sink.mask(-1 - i, 70), k_mask_outside | k_mask_sea) << i;
        ASSERT_EQ(w.sink.mask(20, 140 + i), k_mask_outside | k_mask_sea) << i;
        ASSERT_EQ(w.sink.surface_ticks(20, 140 + i) + w.sink.ticks(Layer::water, 20, 140 + i), 0);
    }
    EXPECT_NEAR(w.sink.surface_m(20, 140), w.sink.surface_m(20, 139), 1.0) << "the bed goes on without a step";
    EXPECT_NEAR(w.sink.surface_m(-1, 70), w.sink.surface_m(0, 70), 1.0);
    EXPECT_EQ(w.sink.mask(141, 70), k_mask_outside) << "mountains end on land";
    EXPECT_EQ(w.sink.surface_ticks(-100, 70), ticks(w.sink.desc.outside_m));
    EXPECT_EQ(w.sink.surface_ticks(-100, 70) + w.sink.ticks(Layer::water, -100, 70), 0);
}

TEST(DemImport, GroundIsRockWhereSteepAndSoilWhereFlat) {
    const TempFolder t;
    // A flat valley floor between walls of slope 2.
    const auto f = [](int x, int) { return 100.0 + 2.0 * std::max(0, std::abs(x - 100) - 40); };
    write_gdal(t / "a.tif", "GTiff", "Float32", Grid{200, 160, f});
    DemImportOptions options = plain_options();
    const Imported w = import_files({t / "a.tif"}, options);
    ASSERT_TRUE(w.report.ok()) << w.report.error().message;
    EXPECT_EQ(w.sink.ticks(Layer::soil, 20, 80), 0);
    EXPECT_EQ(w.sink.ticks(Layer::sand, 20, 80), 0);
    EXPECT_GT(w.sink.ticks(Layer::soil, 100, 80), ticks(1.0));
    EXPECT_LE(w.sink.ticks(Layer::soil, 100, 80), ticks(1.6 * 1.5));
    EXPECT_GT(w.sink.ticks(Layer::sand, 100, 80), 0);
    options.cover.soil_m = 0.0f;
    options.cover.sand_m = 0.0f;
    const Imported bare = import_files({t / "a.tif"}, options);
    EXPECT_EQ(bare.sink.ticks(Layer::bedrock, 100, 80), ticks(100.0));
}

TEST(DemImport, DegreesGoToTheUtmZoneOfTheirCentre) {
    const TempFolder t;
    const Grid grid{80, 60, [](int x, int y) { return 100.0 + x * 2 + y; }};
    write_gdal(t / "north.tif", "GTiff", "Float32", grid,
               {.x = 10.0, .y = 47.0, .cell_x = 0.001, .cell_y = -0.001, .crs = "EPSG:4326"});
    write_gdal(t / "south.tif", "GTiff", "Float32", grid,
               {.x = -71.5, .y = -28.0, .cell_x = 0.001, .cell_y = -0.001, .crs = "EPSG:4326"});
    const Imported n = import_files({t / "north.tif"}, plain_options());
    ASSERT_TRUE(n.report.ok()) << n.report.error().message;
    EXPECT_NE(n.report.value().projection_name.find("UTM zone 32N"), std::string::npos)
        << n.report.value().projection_name;
    const Imported s = import_files({t / "south.tif"}, plain_options());
    ASSERT_TRUE(s.report.ok()) << s.report.error().message;
    EXPECT_NE(s.report.value().projection_name.find("UTM zone 19S"), std::string::npos)
        << s.report.value().projection_name;
    // 0.001 degrees at 47 N: 76 x 111 m, geometric mean 92: a round 100 m (80, 100 are the neighbours).
    EXPECT_EQ(n.report.value().cell_m, 100.0);
    EXPECT_NEAR(static_cast<double>(n.report.value().width) * 100.0, 80 * 76.1, 400.0);
    EXPECT_NEAR(static_cast<double>(n.report.value().height) * 100.0, 60 * 111.2, 400.0);
}

TEST(DemImport, StopsWhenAsked) {
    const TempFolder t, scratch;
    write_gdal(t / "a.tif", "GTiff", "Float32", hills_grid(200, 200));
    MemorySink sink;
    const std::vector<fs::path> files{t / "a.tif"};
    std::vector<std::string> stages;
    const auto report =
        import_dem_tiles(sink, scratch.path(), files, plain_options(), [&](std::string_view stage, double f) {
            EXPECT_GE(f, 0.0);
            EXPECT_LE(f, 1.0);
            stages.emplace_back(stage);
            return stage != "writing";
        });
    ASSERT_FALSE(report.ok());
    EXPECT_NE(report.error().message.find("stopped"), std::string::npos);
    EXPECT_EQ(stages.front(), "reading");
    EXPECT_TRUE(sink.tiles.empty());
}

} // namespace
} // namespace sahel::dem_test
