#include "terrain_test_util.h"
#include "world/cpu_features.h"
#include "world/terrain_driver.h"
#include "world/terrain_lakes.h"
#include "world/terrain_tables.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#if defined(SAHEL_OTHER_COMPILER)
namespace sahel::isa_other {
const TerrainKernels& terrain_kernels();
}
#endif

/// The base terrain is the same on every machine, and water lies flat in it.
namespace sahel {
namespace {

using test::count_differences;
using test::hash_of;
using test::read_rect;
using test::terrain_of;

constexpr std::array<Cell, 4> k_places = {
    Cell{0, 0}, Cell{-2048, 1024}, Cell{int64_t{4'000'000} * 2048, int64_t{-3'000'000} * 2048}, Cell{-5351, -6900}};

CellRect rect_at(Cell place, int32_t level) {
    const int64_t x = place.x >> level, y = place.y >> level;
    return {x, y, x + 203, y + 61};
}

class TerrainGolden : public testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(Presets, TerrainGolden,
                         testing::Values("oasis", "dunes", "canyon", "mountains", "islands", "wetland"),
                         [](const auto& preset) { return std::string(preset.param); });

// Whoever changes the landscape on purpose changes these: every world made before looks different then.
TEST_P(TerrainGolden, EveryLayerIsWhatItWasOnEveryMachine) {
    static const std::map<std::string_view, uint64_t> k_hashes = {
        {"oasis", 0x54d5d8bd24ee38cfull},     {"dunes", 0xec6447c97968ebfeull},   {"canyon", 0xdcc814ff5d3ea306ull},
        {"mountains", 0xde4be249c6bddc6eull}, {"islands", 0x6f41f422eb19fe56ull}, {"wetland", 0x6b03cfa0f99a7ed8ull},
    };
    const BaseTerrain terrain = terrain_of(GetParam());
    uint64_t hash = 0xcbf29ce484222325ull;
    for (const int32_t level : {0, 1, 2, 3, 4, 7, 10})
        for (const Cell place : k_places) hash = hash_of(read_rect(terrain, level, rect_at(place, level)), hash);
    char found[32];
    std::snprintf(found, sizeof found, "0x%016llxull", static_cast<unsigned long long>(hash));
    EXPECT_EQ(hash, k_hashes.at(GetParam())) << GetParam() << ": " << found;
}

TEST_P(TerrainGolden, SameBitsFromAnotherCompiler) {
#if defined(SAHEL_OTHER_COMPILER)
    if (best_isa() != Isa::v3) GTEST_SKIP() << "this machine has no x86-64-v3";
    const BaseTerrain terrain = terrain_of(GetParam());
    for (const int32_t level : {0, 1, 2, 3, 4, 7, 10})
        for (const Cell place : k_places) {
            LayerBlock other = LayerBlock::allocate(level, rect_at(place, level), 0, test::k_terrain_layers).value();
            read_terrain(terrain.tables(), isa_other::terrain_kernels(), level, 1.0f, other);
            EXPECT_EQ(count_differences(other, read_rect(terrain, level, rect_at(place, level))), 0)
                << SAHEL_OTHER_COMPILER << ", level " << level;
        }
#else
    GTEST_SKIP() << "only one of g++ and clang++ is installed";
#endif
}

/// Most height of water above the ground of a dry neighbour, m, and how many cells hold water.
struct Walls {
    double highest_m = 0.0;
    int64_t wet = 0;
};
void find_walls(const LayerBlock& block, Walls& walls) {
    const auto n = static_cast<int32_t>(block.owned().width());
    const auto water = block.ints(Layer::water);
    for (int32_t y = 1; y + 1 < n; ++y)
        for (int32_t x = 1; x + 1 < n; ++x) {
            if (water(x, y) == 0) continue;
            ++walls.wet;
            const double surface = test::ground_m(block, x, y) + static_cast<double>(water(x, y)) / k_ticks_per_m;
            for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}})
                if (water(x + dx, y + dy) == 0)
                    walls.highest_m = std::max(walls.highest_m, surface - test::ground_m(block, x + dx, y + dy));
        }
}

TEST_P(TerrainGolden, NoWaterStandsAboveDryGround) {
    const BaseTerrain terrain = terrain_of(GetParam());
    std::vector<LakeSite> lakes;
    const int64_t reach = 2 * 60000; // half metres
    find_lakes(terrain.tables(), isa_base::terrain_kernels(), -reach, -reach, reach, reach, lakes);
    Walls walls;
    int looked_at = 0;
    for (const LakeSite& lake : lakes) {
        if (++looked_at > 24) break;
        const int64_t x = lake.x_half_m / 4, y = lake.y_half_m / 4; // cells of 2 m
        const auto side = static_cast<int64_t>(1.6f * lake.radius_m / 2.0f);
        find_walls(read_rect(terrain, 1, {x - side, y - side, x + side, y + side}, 0, k_surface_layers), walls);
    }
    find_walls(read_rect(terrain, 1, {-256, -256, 256, 256}, 0, k_surface_layers), walls);
    std::printf("  %s: %d lakes, %lld wet cells, water at most %.4f m above dry ground beside it\n",
                std::string(GetParam()).c_str(), std::min(looked_at, 24), static_cast<long long>(walls.wet),
                walls.highest_m);
    EXPECT_LE(walls.highest_m, 0.01);
}

} // namespace
} // namespace sahel
