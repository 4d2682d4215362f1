#include "terrain_test_util.h"
#include "world/cpu_features.h"
#include "world/terrain_driver.h"
#include "world/terrain_lakes.h"
#include "world/terrain_tables.h"

#include <algorithm>
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
using test::find_walls;
using test::hash_of;
using test::read_rect;
using test::terrain_of;

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
        {"oasis", 0x5b710f2aa77ed350ull},     {"dunes", 0xdd392c45d9fc5a61ull},   {"canyon", 0x9531d74ec2be2333ull},
        {"mountains", 0x02c601544048aa79ull}, {"islands", 0xb4d80a40dafa2a4aull}, {"wetland", 0x42ea1713b73eb9b2ull},
    };
    const BaseTerrain terrain = terrain_of(GetParam());
    uint64_t hash = 0xcbf29ce484222325ull;
    for (const int32_t level : {0, 1, 2, 3, 4, 7, 10})
        for (const Cell place : test::k_places) hash = hash_of(read_rect(terrain, level, rect_at(place, level)), hash);
    char found[32];
    std::snprintf(found, sizeof found, "0x%016llxull", static_cast<unsigned long long>(hash));
    EXPECT_EQ(hash, k_hashes.at(GetParam())) << GetParam() << ": " << found;
}

TEST_P(TerrainGolden, SameBitsFromAnotherCompiler) {
#if defined(SAHEL_OTHER_COMPILER)
    if (best_isa() != Isa::v3) GTEST_SKIP() << "this machine has no x86-64-v3";
    const BaseTerrain terrain = terrain_of(GetParam());
    for (const int32_t level : {0, 1, 2, 3, 4, 7, 10})
        for (const Cell place : test::k_places) {
            LayerBlock other = LayerBlock::allocate(level, rect_at(place, level), 0, test::k_terrain_layers).value();
            read_terrain(terrain.tables(), isa_other::terrain_kernels(), level, 1.0f, other);
            EXPECT_EQ(count_differences(other, read_rect(terrain, level, rect_at(place, level))), 0)
                << SAHEL_OTHER_COMPILER << ", level " << level;
        }
#else
    GTEST_SKIP() << "only one of g++ and clang++ is installed";
#endif
}

TEST_P(TerrainGolden, NoWaterStandsAboveDryGround) {
    const BaseTerrain terrain = terrain_of(GetParam());
    std::vector<LakeSite> lakes;
    const int64_t reach = 2 * 60000; // half metres
    find_lakes(terrain.tables(), isa_base::terrain_kernels(), -reach, -reach, reach, reach, lakes);
    test::Walls walls;
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
