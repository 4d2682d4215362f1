#include "world/base_terrain.h"

#include "terrain_test_util.h"
#include "world/cpu_features.h"
#include "world/cuda_runtime.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <thread>
#include <vector>

namespace sahel {
namespace {

using test::count_differences;
using test::ground_m;
using test::hash_of;
using test::k_places;
using test::k_terrain_layers;
using test::read_rect;
using test::terrain_of;

class BaseTerrainTest : public testing::Test {
  protected:
    void TearDown() override { set_isa(best_isa()); }
};

/// Every preset.
class BaseTerrainPresetTest : public testing::TestWithParam<std::string_view> {
  protected:
    void TearDown() override { set_isa(best_isa()); }
};
INSTANTIATE_TEST_SUITE_P(Presets, BaseTerrainPresetTest,
                         testing::Values("oasis", "dunes", "canyon", "mountains", "islands", "wetland"),
                         [](const auto& preset) { return std::string(preset.param); });

TEST_F(BaseTerrainTest, PresetsAreNamedAndInRange) {
    ASSERT_EQ(base_terrain_presets().size(), 6u);
    EXPECT_EQ(base_terrain_presets()[0], "oasis");
    for (const std::string_view name : base_terrain_presets()) {
        const auto params = base_terrain_preset(name);
        ASSERT_TRUE(params.ok());
        EXPECT_TRUE(check_ranges(*params, name).ok());
    }
    const auto unknown = base_terrain_preset("atlantis");
    ASSERT_FALSE(unknown.ok());
    EXPECT_EQ(unknown.error().kind, ErrorKind::usage);
    EXPECT_NE(unknown.error().message.find("wetland"), std::string::npos);
}

TEST_F(BaseTerrainTest, LevelsOutOfRangeAreRefused) {
    const BaseTerrain terrain = terrain_of("oasis");
    LayerBlock block = LayerBlock::allocate(21, {0, 0, 8, 8}, 0, k_surface_layers).value();
    const Status status = terrain.read(block);
    ASSERT_FALSE(status.ok());
    EXPECT_EQ(status.error().kind, ErrorKind::usage);
}

TEST_F(BaseTerrainTest, UnknownLayersBecomeZero) {
    const BaseTerrain terrain = terrain_of("oasis");
    const LayerBlock block =
        read_rect(terrain, 0, {0, 0, 40, 30}, 2, LayerSet{Layer::bedrock, Layer::sediment, Layer::mask});
    int64_t wrong = 0;
    for (int32_t y = -2; y < 32; ++y)
        for (int32_t x = -2; x < 42; ++x)
            wrong += block.ints(Layer::sediment)(x, y) != 0 || block.ints(Layer::mask)(x, y) != 0 ? 1 : 0;
    EXPECT_EQ(wrong, 0);
    EXPECT_NE(block.ints(Layer::bedrock)(0, 0), 0);
}

TEST_P(BaseTerrainPresetTest, SameBitsForAnyRectangle) {
    const BaseTerrain terrain = terrain_of(GetParam());
    for (const int32_t level : {0, 1, 2, 3, 4, 6, 9}) {
        for (const Cell place : k_places) {
            const Cell at{place.x >> level, place.y >> level};
            const LayerBlock whole = read_rect(terrain, level, {at.x, at.y, at.x + 150, at.y + 130}, 3);
            const std::array<CellRect, 5> parts = {CellRect{at.x, at.y, at.x + 64, at.y + 64},
                                                   CellRect{at.x + 61, at.y + 5, at.x + 62, at.y + 6},
                                                   CellRect{at.x + 7, at.y + 99, at.x + 150, at.y + 101},
                                                   CellRect{at.x - 90, at.y - 50, at.x + 30, at.y + 20},
                                                   CellRect{at.x + 128, at.y - 3, at.x + 153, at.y + 133}};
            for (const CellRect& part : parts)
                EXPECT_EQ(count_differences(whole, read_rect(terrain, level, part, part.x0 % 2 == 0 ? 0 : 5)), 0)
                    << "level " << level << " place " << place.x << ' ' << place.y;
        }
    }
}

TEST_P(BaseTerrainPresetTest, TilesWithHalosAgree) {
    const BaseTerrain terrain = terrain_of(GetParam());
    for (const int64_t n : {128, 256}) {
        const LayerBlock a = read_rect(terrain, 0, tile_rect({0, 3, -5}, n), 8);
        const LayerBlock east = read_rect(terrain, 0, tile_rect({0, 4, -5}, n), 8);
        const LayerBlock south = read_rect(terrain, 0, tile_rect({0, 3, -4}, n), 8);
        EXPECT_EQ(count_differences(a, east), 0);
        EXPECT_EQ(count_differences(a, south), 0);
        EXPECT_EQ(count_differences(east, south), 0);
    }
}

TEST_P(BaseTerrainPresetTest, BlocksWiderThanAnyTile) {
    const BaseTerrain terrain = terrain_of(GetParam());
    for (const int32_t level : {0, 5, 9}) {
        const LayerBlock wide = read_rect(terrain, level, {-2000, 10, 3100, 14});
        const LayerBlock tall = read_rect(terrain, level, {2990, -2000, 2994, 3100});
        const LayerBlock small = read_rect(terrain, level, {2980, 0, 3010, 20});
        EXPECT_EQ(count_differences(wide, small), 0) << level;
        EXPECT_EQ(count_differences(tall, small), 0) << level;
    }
}

TEST_P(BaseTerrainPresetTest, SameBitsForEveryInstructionSet) {
    if (best_isa() == Isa::baseline) GTEST_SKIP() << "this machine has no x86-64-v3";
    const BaseTerrain terrain = terrain_of(GetParam());
    for (const int32_t level : {0, 2, 5, 8})
        for (const Cell place : k_places) {
            const CellRect rect{(place.x >> level), (place.y >> level), (place.x >> level) + 203,
                                (place.y >> level) + 61};
            set_isa(Isa::baseline);
            const LayerBlock base = read_rect(terrain, level, rect, 1);
            set_isa(Isa::v3);
            EXPECT_EQ(count_differences(base, read_rect(terrain, level, rect, 1)), 0) << "level " << level;
        }
}

TEST_P(BaseTerrainPresetTest, CudaGivesTheSameBits) {
    if (!cuda::available()) GTEST_SKIP() << "no CUDA device: " << cuda::status().why_not;
    const BaseTerrain terrain = terrain_of(GetParam());
    for (const int32_t level : {0, 1, 2, 3, 4, 6, 9})
        for (const Cell place : k_places) {
            const CellRect rect{(place.x >> level), (place.y >> level), (place.x >> level) + 203,
                                (place.y >> level) + 61};
            MemoryPool pool("test device", MemoryKind::cuda, 1u << 30);
            LayerBlock device = LayerBlock::allocate(level, rect, 1, k_terrain_layers, pool).value();
            const Status made = terrain.read(device);
            ASSERT_TRUE(made.ok()) << made.error().message;
            LayerBlock copy = LayerBlock::allocate(level, rect, 1, k_terrain_layers).value();
            // The columns lie in one buffer in both memories, in the same layout.
            const void* from = device.ints(Layer::bedrock).row(-1) - 1;
            void* to = copy.ints(Layer::bedrock).row(-1) - 1;
            ASSERT_TRUE(cuda::copy_to_host(to, from, copy.bytes()).ok());
            EXPECT_EQ(count_differences(copy, read_rect(terrain, level, rect, 1)), 0) << "level " << level;
        }
}

TEST_P(BaseTerrainPresetTest, SameBitsFromManyThreads) {
    const BaseTerrain terrain = terrain_of(GetParam());
    std::vector<CellRect> rects;
    for (int64_t i = 0; i < 8; ++i) rects.push_back({i * 90 - 300, i * 40, i * 90 - 200, i * 40 + 70});
    std::vector<uint64_t> expected, found(rects.size());
    for (const CellRect& rect : rects) expected.push_back(hash_of(read_rect(terrain, 1, rect)));
    std::vector<std::thread> threads;
    for (size_t i = 0; i < rects.size(); ++i)
        threads.emplace_back([&, i] { found[i] = hash_of(read_rect(terrain, 1, rects[rects.size() - 1 - i])); });
    for (std::thread& thread : threads) thread.join();
    std::reverse(found.begin(), found.end());
    EXPECT_EQ(found, expected);
}

TEST_P(BaseTerrainPresetTest, LayersArePlausibleNumbers) {
    const BaseTerrain terrain = terrain_of(GetParam());
    for (const int32_t level : {0, 3, 5, 7, 9, 12, 20}) {
        const LayerBlock block = read_rect(terrain, level, {-120, -90, 130, 110});
        int64_t negative = 0, out_of_range = 0, bad_weight = 0;
        for (int32_t y = 0; y < 200; ++y)
            for (int32_t x = 0; x < 250; ++x) {
                for (const Layer layer : {Layer::soil, Layer::sand, Layer::water})
                    negative += block.ints(layer)(x, y) < 0 ? 1 : 0;
                const double h = ground_m(block, x, y);
                out_of_range += h > -1500.0 && h < 6000.0 ? 0 : 1;
                for (const Layer layer : {Layer::mountain, Layer::dune, Layer::canyon}) {
                    const float w = block.reals(layer)(x, y);
                    bad_weight += w >= 0.0f && w <= 1.0f ? 0 : 1;
                }
                const float q = block.reals(Layer::wetness)(x, y);
                bad_weight += q > -6.0f && q < 6.0f ? 0 : 1;
            }
        EXPECT_EQ(negative, 0) << level;
        EXPECT_EQ(out_of_range, 0) << level;
        EXPECT_EQ(bad_weight, 0) << level;
    }
}

// The surface of a level against the mean of its four children, RMS in m, relative to the step between neighbours.
TEST_P(BaseTerrainPresetTest, LevelsAreMeansOfFinerOnes) {
    const BaseTerrain terrain = terrain_of(GetParam());
    constexpr int32_t k_cells = 128;
    for (const int32_t level : {1, 2, 3, 4, 5, 6, 7, 8, 9}) {
        double error = 0.0, step = 0.0;
        for (int64_t q = 0; q < 4; ++q) {
            const int64_t x0 = ((q * 7919) % 64 - 32) * k_cells, y0 = ((q * 104729) % 64 - 32) * k_cells;
            const LayerBlock coarse =
                read_rect(terrain, level, {x0, y0, x0 + k_cells, y0 + k_cells}, 0, k_surface_layers);
            const LayerBlock fine = read_rect(
                terrain, level - 1, {2 * x0, 2 * y0, 2 * (x0 + k_cells), 2 * (y0 + k_cells)}, 0, k_surface_layers);
            for (int32_t y = 0; y < k_cells; ++y) {
                double last = 0.0;
                for (int32_t x = 0; x < k_cells; ++x) {
                    const double mean =
                        0.25 * (ground_m(fine, 2 * x, 2 * y) + ground_m(fine, 2 * x + 1, 2 * y) +
                                ground_m(fine, 2 * x, 2 * y + 1) + ground_m(fine, 2 * x + 1, 2 * y + 1));
                    const double e = ground_m(coarse, x, y) - mean;
                    error += e * e;
                    if (x > 0) step += (mean - last) * (mean - last);
                    last = mean;
                }
            }
        }
        const double cells = 4.0 * k_cells * k_cells;
        // Measured (README): at most 12 % of a step up to level 3, 30 % above.
        EXPECT_LT(std::sqrt(error / cells), (level <= 3 ? 0.18 : 0.5) * std::sqrt(step / cells) + 0.02) << level;
    }
}

TEST_F(BaseTerrainTest, CellSizesAreTheSameLandscape) {
    const BaseTerrain one = terrain_of("oasis");
    const BaseTerrain two = terrain_of("oasis", 1, 2.0);
    const BaseTerrain eight = terrain_of("oasis", 1, 8.0);
    const CellRect rect{-700, -900, -640, -850};
    const LayerBlock a = read_rect(one, 3, rect);
    const LayerBlock b = read_rect(two, 2, rect);
    const LayerBlock c = read_rect(eight, 0, rect);
    EXPECT_EQ(hash_of(a), hash_of(b)); // the same samples under other level numbers
    EXPECT_EQ(hash_of(a), hash_of(c));
    // 1.5 m: the same shape, half as large again.
    const LayerBlock d = read_rect(terrain_of("oasis", 1, 1.5), 3, rect);
    EXPECT_NEAR(ground_m(d, 5, 7), 1.5 * ground_m(a, 5, 7), 1e-3);
}

TEST_F(BaseTerrainTest, SeedsAndParametersMatter) {
    const CellRect rect{0, 0, 32, 32};
    const uint64_t one = hash_of(read_rect(terrain_of("oasis", 1), 2, rect));
    EXPECT_NE(one, hash_of(read_rect(terrain_of("oasis", 2), 2, rect)));
    EXPECT_NE(one, hash_of(read_rect(terrain_of("oasis", 1ull << 40), 2, rect)));
    BaseTerrainParams params;
    params.rise_m += 1.0f;
    EXPECT_NE(one, hash_of(read_rect(BaseTerrain(1, params), 2, rect)));
    EXPECT_EQ(one, hash_of(read_rect(BaseTerrain(1, BaseTerrainParams{}), 2, rect)));
}

} // namespace
} // namespace sahel
