#include "tests/world/dem_support.h"

#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <random>

/// What the import refuses: one line each, naming the file, and nothing made.
namespace sahel::dem_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
constexpr double k_none = std::numeric_limits<double>::quiet_NaN();
constexpr double k_inf = std::numeric_limits<double>::infinity();

void expect_refused(const std::vector<fs::path>& files, const DemImportOptions& options, ErrorKind kind,
                    const std::string& words) {
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    const Imported w = import_files(files, options);
    const std::string spilt = testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout();
    EXPECT_EQ(spilt, "") << "a library wrote to the terminal";
    ASSERT_FALSE(w.report.ok()) << files[0];
    const Error& e = w.report.error();
    EXPECT_EQ(static_cast<int>(e.kind), static_cast<int>(kind)) << e.message;
    EXPECT_THAT(e.message, HasSubstr(words));
    EXPECT_EQ(e.message.find('\n'), std::string::npos) << e.message;
    EXPECT_TRUE(w.sink.tiles.empty());
}

Grid ramp(int w = 150, int h = 140) {
    return {w, h, [](int x, int y) { return 100.0 + x + y; }};
}

TEST(DemBroken, FilesThatAreNone) {
    const TempFolder t;
    expect_refused({t / "absent.tif"}, plain_options(), ErrorKind::not_found, "absent.tif");
    fs::create_directory(t / "folder.tif");
    expect_refused({t / "folder.tif"}, plain_options(), ErrorKind::usage, "is a folder");
    for (const char* name : {"empty.tif", "empty.exr", "empty.raw", "N10E010.hgt"}) {
        write_bytes(t / name, {});
        expect_refused({t / name}, plain_options(), ErrorKind::corrupt, "is empty");
    }
    const std::string words = "These are words and no elevation model. ";
    std::vector<uint8_t> bytes;
    for (int i = 0; i < 40; ++i) bytes.insert(bytes.end(), words.begin(), words.end());
    for (const char* name : {"words.tif", "words.exr", "words.png", "words.asc", "N10E011.hgt"}) {
        write_bytes(t / name, bytes);
        expect_refused({t / name}, plain_options(), ErrorKind::corrupt, name);
    }
    expect_refused({}, plain_options(), ErrorKind::usage, "no elevation file");
}

TEST(DemBroken, CutShort) {
    const TempFolder t;
    write_gdal(t / "a.tif", "GTiff", "Float32", ramp());
    write_gdal(t / "b.png", "PNG", "UInt16", ramp());
    write_exr(t / "c.exr", ramp(), "Y", 1.0f);
    write_gdal(t / "d.asc", "AAIGrid", "Float32", ramp());
    for (const char* name : {"a.tif", "b.png", "c.exr", "d.asc"}) {
        const std::vector<uint8_t> whole = read_bytes(t / name);
        for (const double part : {0.02, 0.3, 0.9}) {
            SCOPED_TRACE(std::string(name) + " to " + std::to_string(part));
            write_bytes(t / name,
                        std::span(whole).first(static_cast<size_t>(static_cast<double>(whole.size()) * part)));
            expect_refused({t / name}, plain_options(), ErrorKind::corrupt, name);
        }
    }
    // An HGT is known by its size alone.
    write_bytes(t / "N10E010.hgt", std::vector<uint8_t>(1201 * 1201 * 2 - 100, 1));
    expect_refused({t / "N10E010.hgt"}, plain_options(), ErrorKind::corrupt, "N10E010.hgt");
}

TEST(DemBroken, RawSizes) {
    const TempFolder t;
    write_raw16(t / "a.raw", ramp(150, 140), false);
    DemImportOptions options = plain_options();
    expect_refused({t / "a.raw"}, options, ErrorKind::usage, "--raw WIDTHxHEIGHT");
    options.source.raw = {.width = 150, .height = 141};
    expect_refused({t / "a.raw"}, options, ErrorKind::corrupt, "42000");
    options.source.raw = {.width = 1000000000, .height = 1000000000};
    expect_refused({t / "a.raw"}, options, ErrorKind::corrupt, "1000000000 x 1000000000");
    options.source.raw = {.width = 4000000000000, .height = 4000000000000};
    expect_refused({t / "a.raw"}, options, ErrorKind::corrupt, "4000000000000");
    options.source.raw = {.width = -150, .height = -140};
    expect_refused({t / "a.raw"}, options, ErrorKind::usage, "negative");
    options.source.raw = {.width = 150, .height = 140, .bits = 12};
    expect_refused({t / "a.raw"}, options, ErrorKind::usage, "12 bits");
    options.source.raw = {.width = 300, .height = 140, .bits = 8};
    expect_refused({t / "a.raw"}, options, ErrorKind::usage, "--range");
    // A square needs no size.
    write_raw16(t / "b.raw", ramp(140, 140), false);
    EXPECT_TRUE(import_files({t / "b.raw"}, plain_options()).report.ok());
}

TEST(DemBroken, HugeDimensions) {
    const TempFolder t;
    // A sparse GeoTIFF of 2 000 000 x 2 000 000 cells is a small file.
    GDALAllRegister();
    char bigtiff[] = "BIGTIFF=YES", sparse[] = "SPARSE_OK=TRUE", tiled[] = "TILED=YES", bx[] = "BLOCKXSIZE=16384",
         by[] = "BLOCKYSIZE=16384";
    char* how[] = {bigtiff, sparse, tiled, bx, by, nullptr};
    auto* d = GetGDALDriverManager()->GetDriverByName("GTiff")->Create((t / "a.tif").c_str(), 2000000, 2000000, 1,
                                                                       GDT_Int16, how);
    ASSERT_NE(d, nullptr);
    GDALClose(d);
    expect_refused({t / "a.tif"}, plain_options(), ErrorKind::budget, "GiB");

    // An EXR header that claims two thousand million rows.
    write_exr(t / "b.exr", ramp(), "Y", 1.0f);
    std::vector<uint8_t> bytes = read_bytes(t / "b.exr");
    const std::string tag("dataWindow\0box2i\0\x10\0\0\0", 21);
    const auto at = std::search(bytes.begin(), bytes.end(), tag.begin(), tag.end());
    ASSERT_NE(at, bytes.end());
    const int32_t rows = 2000000000;
    std::memcpy(&*(at + 21 + 12), &rows, 4);
    write_bytes(t / "b.exr", bytes);
    expect_refused({t / "b.exr"}, plain_options(), ErrorKind::corrupt, "b.exr");

    DemImportOptions options = plain_options();
    options.cell_m = 0.001;
    write_gdal(t / "c.tif", "GTiff", "Float32", ramp(150, 140), {.cell_x = 1000.0, .cell_y = -1000.0});
    expect_refused({t / "c.tif"}, options, ErrorKind::budget, "GiB");
}

TEST(DemBroken, NotANumberAndInfinity) {
    const TempFolder t;
    write_gdal(t / "nan.tif", "GTiff", "Float32", {150, 140, [](int, int) { return k_none; }});
    expect_refused({t / "nan.tif"}, plain_options(), ErrorKind::corrupt, "no cell holds a height");
    for (const double bad : {k_inf, -k_inf, 1e30, 16384.0, -32768.0}) {
        const Grid grid{150, 140, [&](int x, int y) { return x == 77 && y == 31 ? bad : 100.0; }};
        write_gdal(t / "a.tif", "GTiff", "Float32", grid);
        write_exr(t / "b.exr", grid, "Y", 1.0f);
        for (const char* name : {"a.tif", "b.exr"})
            expect_refused({t / name}, plain_options(), ErrorKind::corrupt, "column 77, row 31");
    }
    // Naming the value as no data helps.
    const Grid grid{150, 140, [&](int x, int y) { return x == 77 && y == 31 ? -32768.0 : 100.0; }};
    write_gdal(t / "a.tif", "GTiff", "Float32", grid);
    DemImportOptions options = plain_options();
    options.source.nodata = -32768.0;
    const Imported w = import_files({t / "a.tif"}, options);
    ASSERT_TRUE(w.report.ok()) << w.report.error().message;
    EXPECT_EQ(w.report.value().filled_cells, 1);
    EXPECT_EQ(w.sink.surface_m(77, 31), 100.0);
}

TEST(DemBroken, HeightsWithoutMetres) {
    const TempFolder t;
    write_gdal(t / "a.png", "PNG", "Byte", {130, 130, [](int x, int) { return x; }});
    expect_refused({t / "a.png"}, plain_options(), ErrorKind::usage, "--range");
    const Grid unit{130, 130, [](int x, int) { return x / 129.0; }};
    write_gdal(t / "b.tif", "GTiff", "Float32", unit);
    write_exr(t / "c.exr", unit, "Y", 1.0f);
    expect_refused({t / "b.tif"}, plain_options(), ErrorKind::usage, "--range");
    expect_refused({t / "c.exr"}, plain_options(), ErrorKind::usage, "--range");
    DemImportOptions options = plain_options();
    options.source.range = DemRange{0.0, 1.0};
    EXPECT_TRUE(import_files({t / "b.tif"}, options).report.ok());
    write_gdal(t / "d.tif", "GTiff", "Float32", ramp());
    expect_refused({t / "d.tif"}, options, ErrorKind::usage, "0..1");
    options.source.range = DemRange{500.0, 100.0};
    expect_refused({t / "b.tif"}, options, ErrorKind::usage, "lower height first");
}

TEST(DemBroken, FilesThatCannotBeJoined) {
    const TempFolder t;
    write_gdal(t / "a.tif", "GTiff", "Float32", ramp());
    write_gdal(t / "b.tif", "GTiff", "Float32", ramp(), {.crs = ""});
    write_gdal(t / "c.png", "PNG", "UInt16", ramp(), {.placed = false});
    expect_refused({t / "a.tif", t / "b.tif"}, plain_options(), ErrorKind::usage, "--crs");
    expect_refused({t / "a.tif", t / "c.png"}, plain_options(), ErrorKind::usage, "where it lies");
    DemImportOptions options = plain_options();
    options.source.crs = "EPSG:32611";
    EXPECT_TRUE(import_files({t / "a.tif", t / "b.tif"}, options).report.ok());
    options.source.crs = "nonsense";
    expect_refused({t / "b.tif"}, options, ErrorKind::usage, "nonsense");
    options = plain_options();
    options.source.band = 2;
    expect_refused({t / "a.tif"}, options, ErrorKind::usage, "no band 2");
}

/// Any bytes: a world or one line, never a crash, never a word on the terminal.
TEST(DemBroken, FlippedBytes) {
    const TempFolder t;
    const Grid grid = ramp(130, 40);
    write_gdal(t / "a.tif", "GTiff", "Float32", grid);
    write_gdal(t / "b.png", "PNG", "UInt16", grid);
    write_exr(t / "c.exr", grid, "Y", 1.0f);
    write_gdal(t / "d.asc", "AAIGrid", "Float32", grid);
    const bool deep = std::getenv("SAHEL_LONG_TESTS") != nullptr;
    int made = 0, refused = 0;
    for (const char* name : {"a.tif", "b.png", "c.exr", "d.asc"}) {
        const std::vector<uint8_t> whole = read_bytes(t / name);
        std::mt19937 random(7);
        testing::internal::CaptureStderr();
        for (int round = 0; round < (deep ? 4000 : 120); ++round) {
            std::vector<uint8_t> bytes = whole;
            // Headers matter most: half of the flips go there.
            const size_t reach = round % 2 ? bytes.size() : std::min<size_t>(bytes.size(), 600);
            for (int flips = 1 + round % 4; flips > 0; --flips)
                bytes[random() % reach] = static_cast<uint8_t>(random());
            write_bytes(t / name, bytes);
            const Imported w = import_files({t / name}, plain_options());
            (w.report.ok() ? made : refused) += 1;
            if (w.report.ok()) continue;
            ASSERT_FALSE(w.report.error().message.empty());
            ASSERT_EQ(w.report.error().message.find('\n'), std::string::npos) << w.report.error().message;
            ASSERT_TRUE(w.sink.tiles.empty());
        }
        EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << name;
    }
    EXPECT_GT(made, 0);
    EXPECT_GT(refused, 0);
}

TEST(DemBroken, OptionsOutOfRange) {
    const TempFolder t;
    write_gdal(t / "a.tif", "GTiff", "Float32", ramp());
    const auto refused = [&](ErrorKind kind, const std::string& words,
                             const std::function<void(DemImportOptions&)>& change) {
        DemImportOptions options = plain_options();
        change(options);
        expect_refused({t / "a.tif"}, options, kind, words);
    };
    refused(ErrorKind::usage, "power of two", [](auto& o) { o.tile_cells = 100; });
    refused(ErrorKind::usage, "cells of", [](auto& o) { o.cell_m = -1.0; });
    refused(ErrorKind::usage, "cells of", [](auto& o) { o.cell_m = k_none; });
    refused(ErrorKind::usage, "datum", [](auto& o) { o.datum_m = k_inf; });
    refused(ErrorKind::usage, "sea", [](auto& o) { o.sea_m = 1e9; });
    refused(ErrorKind::usage, "sea", [](auto& o) { o.sea_m = k_none; });
    refused(ErrorKind::usage, "plain", [](auto& o) { o.outside_m = k_none; });
    refused(ErrorKind::usage, "64 times", [](auto& o) { o.cell_m = 1000.0; });
    refused(ErrorKind::budget, "memory", [](auto& o) { o.memory_bytes = 1000; });
}

} // namespace
} // namespace sahel::dem_test
