#include "world/terrain_streams.h"

#include "terrain_test_util.h"
#include "world/cpu_features.h"
#include "world/terrain_lakes.h"
#include "world/tile_key.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

/// Streams run downhill into their lakes, are wet from end to end, and are the same whoever asks.
namespace sahel {
namespace {

using test::find_walls;
using test::read_rect;
using test::terrain_of;

constexpr int64_t k_reach_half_m = 2 * 40000;

using Stream = std::vector<StreamPiece>; // from the lake to the end

std::vector<LakeSite> lakes_of(const BaseTerrain& terrain) {
    std::vector<LakeSite> lakes;
    find_lakes(terrain.tables(), isa_base::terrain_kernels(), -k_reach_half_m, -k_reach_half_m, k_reach_half_m,
               k_reach_half_m, lakes);
    return lakes;
}

/// Pieces of a lake come one stream after the other; each begins where the last one ended.
std::vector<Stream> streams_of(const BaseTerrain& terrain, const LakeSite& lake) {
    std::vector<StreamPiece> pieces;
    plan_streams(terrain.tables(), isa_base::terrain_kernels(), lake, pieces);
    std::vector<Stream> streams;
    for (const StreamPiece& piece : pieces) {
        const bool follows = [&] {
            if (streams.empty()) return false;
            const StreamPiece& last = streams.back().back();
            return last.x_half_m + std::llround(2.0f * last.dx_m) == piece.x_half_m &&
                   last.y_half_m + std::llround(2.0f * last.dy_m) == piece.y_half_m;
        }();
        if (!follows) streams.emplace_back();
        streams.back().push_back(piece);
    }
    return streams;
}

double length_m(const StreamPiece& p) {
    return std::hypot(p.dx_m, p.dy_m);
}
/// Between lakes and beginnings of pieces.
template <class A, class B> double apart_m(const A& a, const B& b) {
    return 0.5 * std::hypot(static_cast<double>(a.x_half_m - b.x_half_m), static_cast<double>(a.y_half_m - b.y_half_m));
}

class TerrainStreams : public testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(Presets, TerrainStreams, testing::Values("oasis", "mountains", "canyon"),
                         [](const auto& preset) { return std::string(preset.param); });

TEST_P(TerrainStreams, ManyLakesHaveOneThatFallsToThemOrAwayFromThem) {
    const BaseTerrain terrain = terrain_of(GetParam());
    const std::vector<LakeSite> lakes = lakes_of(terrain);
    int fed = 0, drained = 0;
    double longest_m = 0.0, steepest = 0.0;
    for (const LakeSite& lake : lakes)
        for (const Stream& stream : streams_of(terrain, lake)) {
            const StreamPiece &first = stream.front(), &last = stream.back();
            EXPECT_LT(apart_m(first, lake), 0.5 * lake.radius_m);
            EXPECT_EQ(first.level_m, lake.level_m);
            EXPECT_LT(last.half_m, 2.5f); // ends gently
            const bool rises = last.level_end_m > lake.level_m;
            (rises ? fed : drained) += 1;
            double length = 0.0;
            for (const StreamPiece& p : stream) {
                length += length_m(p);
                EXPECT_LE(apart_m(p, lake), k_stream_far_m);
                EXPECT_GE((p.level_end_m - p.level_m) * (rises ? 1.0f : -1.0f), 0.0f);
                if (length_m(p) > 0.0) steepest = std::max(steepest, std::abs(p.level_end_m - p.level_m) / length_m(p));
            }
            EXPECT_GT(length, 700.0);
            longest_m = std::max(longest_m, length);
        }
    const auto count = static_cast<double>(lakes.size());
    std::printf("  %s: %zu lakes, %.0f %% with a stream that comes, %.0f %% with one that leaves; longest %.0f m, "
                "steepest %.3f\n",
                std::string(GetParam()).c_str(), lakes.size(), 100.0 * fed / count, 100.0 * drained / count, longest_m,
                steepest);
    if (lakes.size() > 20) {
        EXPECT_GT(fed, 0.85 * count);
        EXPECT_GT(drained, 0.4 * count);
    }
    EXPECT_LT(longest_m, 5500.0);
    EXPECT_GT(fed, drained);
    EXPECT_LT(steepest, 0.06); // 0.024 where the way is planned; inside bends it is shorter
}

TEST_P(TerrainStreams, NoneComesBackToItself) {
    const BaseTerrain terrain = terrain_of(GetParam());
    double nearest_m = 1e9;
    for (const LakeSite& lake : lakes_of(terrain))
        for (const Stream& stream : streams_of(terrain, lake))
            for (size_t a = 0; a < stream.size(); ++a)
                for (size_t b = a + 8; b < stream.size(); ++b) // 192 m along it
                    nearest_m = std::min(nearest_m, apart_m(stream[a], stream[b]));
    std::printf("  %s: nearest %.0f m\n", std::string(GetParam()).c_str(), nearest_m);
    EXPECT_GT(nearest_m, 50.0);
}

TEST_P(TerrainStreams, ThoseOfTwoLakesNeverMeet) {
    const BaseTerrain terrain = terrain_of(GetParam());
    std::vector<std::vector<StreamPiece>> all;
    for (const LakeSite& lake : lakes_of(terrain)) {
        all.emplace_back();
        plan_streams(terrain.tables(), isa_base::terrain_kernels(), lake, all.back());
    }
    double nearest_m = 1e9;
    for (size_t a = 0; a < all.size(); ++a)
        for (size_t b = 0; b < a; ++b)
            for (const StreamPiece& p : all[a])
                for (const StreamPiece& q : all[b]) nearest_m = std::min(nearest_m, apart_m(p, q));
    std::printf("  %s: nearest %.0f m\n", std::string(GetParam()).c_str(), nearest_m);
    EXPECT_GT(nearest_m, k_stream_reach_m); // so no valley reaches into the bed of another
}

TEST_P(TerrainStreams, WaterStandsInTheBedFromEndToEndAndNowhereAboveItsBanks) {
    const BaseTerrain terrain = terrain_of(GetParam());
    const int most = std::getenv("SAHEL_LONG_TESTS") != nullptr ? 1000 : 12; // streams looked at
    int looked_at = 0;
    int64_t places = 0, dry = 0;
    test::Walls walls;
    for (const LakeSite& lake : lakes_of(terrain))
        for (const Stream& stream : streams_of(terrain, lake)) {
            if (++looked_at > most) continue;
            for (const StreamPiece& p : stream) {
                const int64_t x = floor_div(p.x_half_m, 2), y = floor_div(p.y_half_m, 2);
                const LayerBlock block = read_rect(terrain, 0, {x - 24, y - 24, x + 24, y + 24}, 0, k_surface_layers);
                find_walls(block, walls);
                // The spline of nodes moves a middle line by a few metres: where streams are narrow, beside itself.
                if (std::min(p.half_m, p.half_end_m) < 6.0f) continue;
                ++places;
                dry += block.ints(Layer::water)(24, 24) == 0 ? 1 : 0;
            }
        }
    std::printf("  %s: %lld places on middle lines, %lld dry; water at most %.3f m above dry ground beside it\n",
                std::string(GetParam()).c_str(), static_cast<long long>(places), static_cast<long long>(dry),
                walls.highest_m);
    EXPECT_GT(places, 40); // the canyon has two lakes
    EXPECT_EQ(dry, 0);
    // The surface slopes: a dry cell beside it may lie lower by that. Found: 2.6 cm.
    EXPECT_LE(walls.highest_m, 0.035);
}

TEST_P(TerrainStreams, SameBitsForAnyRectangleAndInstructionSet) {
    const BaseTerrain terrain = terrain_of(GetParam());
    int looked_at = 0;
    for (const LakeSite& lake : lakes_of(terrain))
        for (const Stream& stream : streams_of(terrain, lake)) {
            if (++looked_at > 4) continue;
            const StreamPiece& p = stream[stream.size() / 2];
            for (const int32_t level : {0, 1, 2, 3, 4, 5, 6}) {
                const int64_t x = floor_div(p.x_half_m, 2) >> level, y = floor_div(p.y_half_m, 2) >> level;
                const CellRect rect{x - 70, y - 30, x + 61, y + 33};
                const LayerBlock whole = read_rect(terrain, level, rect);
                for (const CellRect& part : {CellRect{x - 3, y - 2, x + 9, y + 5}, CellRect{x - 70, y, x - 1, y + 33},
                                             CellRect{x - 300, y - 30, x - 2, y + 200}})
                    EXPECT_EQ(test::count_differences(whole, read_rect(terrain, level, part)), 0) << level;
                if (best_isa() == Isa::baseline) continue;
                set_isa(Isa::baseline);
                const LayerBlock base = read_rect(terrain, level, rect);
                set_isa(best_isa());
                EXPECT_EQ(test::count_differences(whole, base), 0) << level;
            }
        }
    EXPECT_GT(looked_at, 1);
}

TEST_P(TerrainStreams, AnyRectangleFindsThePiecesThatReachIt) {
    const BaseTerrain terrain = terrain_of(GetParam());
    const TerrainTables& t = terrain.tables();
    const TerrainKernels& kernels = isa_base::terrain_kernels();
    std::vector<LakeSite> lakes;
    std::vector<StreamPiece> whole, part;
    const CellRect all{-12000, -12000, 12000, 12000};
    find_lakes_near(t, kernels, 0, all, lakes);
    find_streams_near(t, kernels, 0, all, lakes, whole);
    ASSERT_GT(whole.size(), 100u);
    int found = 0;
    for (int64_t y = -8000; y < 8000; y += 1000)
        for (int64_t x = -8000; x < 8000; x += 1000) {
            const CellRect rect{x, y, x + 1000, y + 1000};
            find_lakes_near(t, kernels, 0, rect, lakes);
            find_streams_near(t, kernels, 0, rect, lakes, part);
            std::vector<StreamPiece> expected;
            for (const StreamPiece& p : whole)
                if (reaches(p, 2 * x, 2 * y, 2 * (x + 1000), 2 * (y + 1000))) expected.push_back(p);
            // `part` may hold more: nodes lie outside the rectangle. Those that reach it come in the same order.
            size_t next = 0;
            for (const StreamPiece& p : part)
                if (next < expected.size() && p.x_half_m == expected[next].x_half_m &&
                    p.y_half_m == expected[next].y_half_m)
                    ++next;
            EXPECT_EQ(next, expected.size()) << x << ' ' << y;
            found += static_cast<int>(expected.size());
        }
    EXPECT_GT(found, 100);
}

// The shape of a lake reaches three radii, and rectangles that lie farther away do not ask it.
TEST(TerrainLakes, ChangeNothingBeyondTheirReach) {
    const BaseTerrain terrain = terrain_of("oasis");
    int looked_at = 0;
    for (const LakeSite& lake : lakes_of(terrain)) {
        if (++looked_at > 40) break;
        const int64_t x = floor_div(lake.x_half_m, 2), y = floor_div(lake.y_half_m, 2);
        const auto near = static_cast<int64_t>(2.8f * lake.radius_m), far = static_cast<int64_t>(3.0f * lake.radius_m);
        for (const int64_t side : {-1, 1}) {
            const auto strip = [&](int64_t from) {
                const int64_t a = x + side * from, b = x + side * (far + 300);
                return CellRect{std::min(a, b), y - 40, std::max(a, b), y + 40};
            };
            EXPECT_EQ(
                test::count_differences(read_rect(terrain, 0, strip(near)), read_rect(terrain, 0, strip(far + 100))), 0)
                << looked_at;
        }
    }
    EXPECT_GT(looked_at, 20);
}

TEST(TerrainStreamsOff, NoneWhereThePresetHasNone) {
    for (const std::string_view preset : {"dunes", "islands", "wetland"})
        EXPECT_FALSE(has_streams(terrain_of(preset).tables(), 0)) << preset;
    EXPECT_TRUE(has_streams(terrain_of("oasis").tables(), 5));
    EXPECT_FALSE(has_streams(terrain_of("oasis").tables(), 12));
}

} // namespace
} // namespace sahel
