#include "tests/world/dem_support.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fcntl.h>
#include <fstream>
#include <malloc.h>
#include <unistd.h>

/// The import as the command line calls it: into a world folder; and within its memory.
namespace sahel::dem_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

Grid slope(int w, int h) {
    return {w, h, [](int x, int y) { return 40.0 + 0.31 * x + 0.17 * y + 3.0 * std::sin(x * 0.2); }};
}

TEST(DemWorld, ImportedWorldOpensVerifiesAndHoldsTheHeights) {
    const TempFolder t;
    const Grid grid = slope(300, 200);
    write_gdal(t / "a.tif", "GTiff", "Float64", grid);
    DemImportOptions options = plain_options();
    options.name.clear();
    options.edge_cells = 20;
    options.datum_m = 12.5;
    const std::vector<fs::path> files{t / "a.tif"};
    const auto report = import_dem(t / "valley", files, options);
    ASSERT_TRUE(report.ok()) << report.error().message;
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(t.path())) names.push_back(entry.path().filename().string());
    EXPECT_THAT(names, testing::UnorderedElementsAre("a.tif", "valley")) << "nothing else is left";

    auto world = World::open(t / "valley", OpenMode::read);
    ASSERT_TRUE(world.ok()) << world.error().message;
    const WorldDesc& desc = world->desc();
    EXPECT_EQ(desc.name, "valley");
    EXPECT_EQ(desc.preset, "none");
    EXPECT_EQ(desc.tile_cells, 128);
    ASSERT_TRUE(desc.georeference);
    EXPECT_EQ(desc.georeference->origin_x, 500000.0);
    EXPECT_EQ(desc.georeference->origin_y, 4000000.0);
    EXPECT_EQ(desc.georeference->datum_m, 12.5);
    EXPECT_THAT(desc.georeference->projection_wkt, HasSubstr("UTM zone 11N"));
    const auto info = world->info();
    ASSERT_TRUE(info.ok());
    EXPECT_EQ(info.value().tile_count, report.value().tiles);
    EXPECT_GT(info.value().parent_count, 0);
    const auto verified = world->verify();
    ASSERT_TRUE(verified.ok());
    EXPECT_TRUE(verified.value().issues.empty());

    // The tiles, the skirt and the plain around, read as the viewer reads them.
    auto block = LayerBlock::allocate(0, {-200, -200, 400, 300}, 0, k_surface_layers);
    ASSERT_TRUE(block.ok());
    ASSERT_TRUE(world->surface().read(block.value()).ok());
    const auto rock = block->ints(Layer::bedrock), soil = block->ints(Layer::soil), sand = block->ints(Layer::sand);
    const auto surface = [&](int x, int y) {
        return rock(x + 200, y + 200) + soil(x + 200, y + 200) + sand(x + 200, y + 200);
    };
    for (int y = 0; y < 200; ++y)
        for (int x = 0; x < 300; ++x)
            ASSERT_EQ(surface(x, y), std::llround((grid.at(x, y) - 12.5) * 131072.0)) << x << ", " << y;
    EXPECT_EQ(surface(-130, 10), surface(-100, 10)) << "the plain beyond the tiles is the plain inside them";

    const auto again = import_dem(t / "twin", files, options);
    ASSERT_TRUE(again.ok());
    const auto twin = World::open(t / "twin", OpenMode::read);
    ASSERT_TRUE(twin.ok());
    EXPECT_EQ(twin.value().hash().value(), world->hash().value());
}

TEST(DemWorld, NothingIsLeftOfAFailedImport) {
    const TempFolder t;
    write_gdal(t / "good.tif", "GTiff", "Float32", slope(300, 300));
    const std::vector<fs::path> good{t / "good.tif"}, absent{t / "absent.tif"};
    const auto only_good_is_there = [&](const char* when) {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(t.path())) names.push_back(entry.path().filename().string());
        EXPECT_THAT(names, testing::ElementsAre("good.tif")) << when;
    };
    EXPECT_EQ(import_dem(t / "w", absent, plain_options()).error().kind, ErrorKind::not_found);
    only_good_is_there("a file is missing");

    // Heights that break off in the middle: found only while reading.
    const std::vector<uint8_t> whole = read_bytes(t / "good.tif");
    write_bytes(t / "good.tif", std::span(whole).first(whole.size() / 2));
    EXPECT_FALSE(import_dem(t / "w", good, plain_options()).ok());
    only_good_is_there("a file is cut short");
    write_bytes(t / "good.tif", whole);

    int writes = 0;
    DemImportOptions options = plain_options();
    options.memory_bytes = uint64_t{32} << 20;
    const auto stopped = import_dem(t / "w", good, options,
                                    [&](std::string_view stage, double) { return stage != "writing" || ++writes < 2; });
    ASSERT_FALSE(stopped.ok());
    EXPECT_EQ(writes, 2) << "tiles had been committed";
    only_good_is_there("stopped while writing");

    const auto nowhere = import_dem(t.path() / "no" / "such" / "w", good, plain_options());
    ASSERT_FALSE(nowhere.ok());
    EXPECT_EQ(nowhere.error().kind, ErrorKind::not_found);
    only_good_is_there("no folder for the world");
}

TEST(DemWorld, AWorldThatIsThereIsNotTouched) {
    const TempFolder t;
    write_gdal(t / "a.tif", "GTiff", "Float32", slope(200, 150));
    const std::vector<fs::path> files{t / "a.tif"};
    fs::create_directory(t / "full");
    std::ofstream(t / "full" / "mine.txt") << "mine";
    const auto refused = import_dem(t / "full", files, plain_options());
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().kind, ErrorKind::usage);
    EXPECT_THAT(refused.error().message, HasSubstr("not empty"));
    EXPECT_EQ(read_bytes(t / "full" / "mine.txt").size(), 4u);
    std::ofstream(t / "file") << "a file";
    EXPECT_EQ(import_dem(t / "file", files, plain_options()).error().kind, ErrorKind::usage);

    fs::create_directory(t / "empty");
    const auto made = import_dem(fs::path((t / "empty").string() + "/"), files, plain_options());
    ASSERT_TRUE(made.ok()) << made.error().message;
    EXPECT_TRUE(World::open(t / "empty", OpenMode::read).ok());
    EXPECT_EQ(import_dem(t / "empty", files, plain_options()).error().kind, ErrorKind::usage);
}

/// Counts tiles and keeps nothing.
class CountingSink final : public DemSink {
  public:
    Status begin(const WorldDesc&) override { return {}; }
    Status commit(std::span<const TileUpdate> updates) override {
        tiles += static_cast<int64_t>(updates.size());
        return {};
    }
    int64_t tiles = 0;
};

/// Peak resident memory in KiB since the last call of reset_peak(); 0 where the system does not say.
int64_t peak_kib() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.rfind("VmHWM:", 0) == 0) return std::stoll(line.substr(6));
    return 0;
}
bool reset_peak() {
    const int fd = ::open("/proc/self/clear_refs", O_WRONLY);
    if (fd < 0) return false;
    const bool ok = ::write(fd, "5", 1) == 1;
    ::close(fd);
    return ok;
}

TEST(DemWorld, AFileLargerThanItsMemoryIsReadInWindows) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers keep freed memory";
#endif
    if (!reset_peak()) GTEST_SKIP() << "/proc/self/clear_refs cannot be written: peak memory is not known";
    // 12000 x 12000 samples of 16 bits: 275 MiB as a file without a header (sparse on disk), 1.1 GiB as doubles.
    const TempFolder t;
    const int64_t side = 12000;
    std::ofstream(t / "big.raw").put('\0');
    fs::resize_file(t / "big.raw", static_cast<uintmax_t>(2 * side * side));
    DemImportOptions options = plain_options();
    options.source.raw = {.width = side, .height = side};
    options.cell_m = 6.0;
    options.memory_bytes = uint64_t{48} << 20;
    CountingSink sink;
    const std::vector<fs::path> files{t / "big.raw"};
    { // first use of the libraries
        write_gdal(t / "a.tif", "GTiff", "Float32", slope(200, 150));
        ASSERT_TRUE(import_files({t / "a.tif"}, plain_options()).report.ok());
    }
    ::malloc_trim(0); // what other tests freed does not hide what this one takes
    ASSERT_TRUE(reset_peak());
    const int64_t before = peak_kib();
    const auto report = import_dem_tiles(sink, t.path(), files, options);
    const int64_t after = peak_kib();
    ASSERT_TRUE(report.ok()) << report.error().message;
    EXPECT_EQ(report.value().width, 2000);
    EXPECT_EQ(sink.tiles, 256);
    std::printf("  %ld MiB of samples with a budget of 48 MiB: peak memory grew by %ld MiB, %.2f s\n",
                static_cast<long>(2 * side * side >> 20), static_cast<long>((after - before) >> 10),
                report.value().seconds);
    EXPECT_LT(after - before, 64 * 1024);
}

} // namespace
} // namespace sahel::dem_test
