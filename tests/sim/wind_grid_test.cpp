#include "sim/wind_grid.h"

#include "pass_check.h"
#include "sim/step_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

namespace sahel::test {
namespace {

const SimLayerSet k_layers{SimLayer::bedrock, SimLayer::soil,   SimLayer::sand,
                           SimLayer::water,   SimLayer::wind_x, SimLayer::wind_y};

int32_t ticks(double m) {
    return static_cast<int32_t>(std::lround(m * 131072.0));
}

// Hills that repeat after `side` cells.
double hills(int64_t x, int64_t y, double side) {
    const double a = 2.0 * M_PI / side;
    return 30.0 * std::sin(a * static_cast<double>(x) + 1.0) * std::cos(2.0 * a * static_cast<double>(y)) +
           8.0 * std::sin(a * static_cast<double>(5 * x + 3 * y)) + 900.0;
}

Status fill_hills(TileDomain& d, double side) {
    SAHEL_TRY(d.fill(SimLayer::bedrock, [&](int64_t x, int64_t y) { return ticks(hills(x, y, side)); }));
    SAHEL_TRY(
        d.fill(SimLayer::soil, [](int64_t x, int64_t y) { return static_cast<int32_t>((x * 31 + y * 17) & 4095); }));
    SAHEL_TRY(d.fill(SimLayer::sand, [](int64_t x, int64_t) { return static_cast<int32_t>((x & 255) * 700); }));
    return d.fill(SimLayer::water, [](int64_t, int64_t y) { return static_cast<int32_t>((y & 127) * 300); });
}

TileDomain flat_domain(const TileLayout& layout, double height_m) {
    TileDomain d = TileDomain::create(layout, k_layers).value();
    for (const SimLayer l : {SimLayer::soil, SimLayer::sand, SimLayer::water})
        EXPECT_TRUE(d.fill(l, [](int64_t, int64_t) { return 0; }).ok());
    EXPECT_TRUE(d.fill(SimLayer::bedrock, [&](int64_t, int64_t) { return ticks(height_m); }).ok());
    return d;
}

struct Cells {
    std::vector<float> x, y;
};
// The wind of all owned cells of a slot.
Cells wind_of(const TileDomain& d, int32_t slot) {
    const auto n = static_cast<size_t>(d.tile_cells());
    Cells c{std::vector<float>(n * n), std::vector<float>(n * n)};
    EXPECT_TRUE(d.store(slot, SimLayer::wind_x, c.x.data()).ok());
    EXPECT_TRUE(d.store(slot, SimLayer::wind_y, c.y.data()).ok());
    return c;
}

TEST(WindGrid, SpacingFollowsTheSmallestScaleInUse) {
    const TileDomain d = flat_domain(TileLayout::rectangle(128, 8, 1, 1, Border::periodic), 0.0);
    WindParams p;
    const auto spacing = [&](double cell_m) { return WindGrid::create(d, p, cell_m)->spacing_cells(); };
    EXPECT_EQ(spacing(1.0), 8); // 25 m / 3 = 8.3
    EXPECT_EQ(spacing(0.5), 8);
    EXPECT_EQ(spacing(2.0), 4);
    EXPECT_EQ(spacing(30.0), 1);
    p.warp_radius_2_m = 47.0f;
    EXPECT_EQ(spacing(1.0), 4);
    p.warp_weight_2 = 0.0f; // not in use
    EXPECT_EQ(spacing(1.0), 8);
    p.venturi_radius_m = 10.0f;
    EXPECT_EQ(spacing(1.0), 1);
    p.venturi_per_m = 0.0f;
    EXPECT_EQ(spacing(1.0), 8);
    p.warp_radius_1_m = 10.0f;
    EXPECT_EQ(spacing(1.0), 1);
    p.warp = false;
    EXPECT_EQ(spacing(1.0), 8);
}

TEST(WindGrid, FlatGroundLeavesTheWindAsItIs) {
    for (const Border border : {Border::periodic, Border::open, Border::wall})
        for (const float angle : {0.0f, 33.0f}) {
            TileDomain d = flat_domain(TileLayout::rectangle(128, 16, 2, 1, border, -1, 3), 777.25);
            WindParams p;
            auto grid = WindGrid::create(d, p, 1.0);
            ASSERT_TRUE(grid.ok()) << grid.error().message;
            const WindNow now{5.3f, angle};
            ASSERT_TRUE(grid->solve(d, now).ok());
            ASSERT_TRUE(run_passes(d, std::vector<Pass>{grid->pass()}).ok());
            const WindVector v = vector_of(now);
            for (int32_t slot = 0; slot < 2; ++slot) {
                const Cells c = wind_of(d, slot);
                EXPECT_EQ(std::count(c.x.begin(), c.x.end(), v.x_m_per_s), 128 * 128);
                EXPECT_EQ(std::count(c.y.begin(), c.y.end(), v.y_m_per_s), 128 * 128);
            }
            EXPECT_GE(grid->max_speed(), std::hypot(v.x_m_per_s, v.y_m_per_s));
            EXPECT_NEAR(grid->max_speed(), 5.3f, 1e-5f);
        }
}

TEST(WindGrid, VenturiAboveTheDatumAndAboveTheMean) {
    for (const auto& [height, factor] : {std::pair{100.0, 1.5f}, {-200.0, 0.5f}, {-50.0, 0.75f}, {3000.0, 16.0f}}) {
        TileDomain d = flat_domain(TileLayout::rectangle(128, 8, 1, 1, Border::periodic), height);
        WindParams p;
        p.venturi_radius_m = 0.0f;
        auto grid = WindGrid::create(d, p, 1.0).value();
        ASSERT_TRUE(grid.solve(d, {6.0f, 0.0f}).ok());
        EXPECT_FLOAT_EQ(grid.coarse_x()[5], 6.0f * factor) << height;
        p.venturi_radius_m = 500.0f; // a plateau is no storm
        auto local = WindGrid::create(d, p, 1.0).value();
        ASSERT_TRUE(local.solve(d, {6.0f, 0.0f}).ok());
        EXPECT_EQ(local.coarse_x()[5], 6.0f) << height;
    }
}

TEST(WindGrid, OnASlopeTheWindKeepsItsSpeedAndTurnsTowardsTheContour) {
    // A ridge along y, seen by winds at several angles; gain 1 and 20.
    const TileLayout layout = TileLayout::rectangle(512, 8, 1, 1, Border::periodic);
    TileDomain d = flat_domain(layout, 0.0);
    ASSERT_TRUE(d.fill(SimLayer::bedrock, [](int64_t x, int64_t) {
                     return ticks(40.0 * std::exp(-0.5 * std::pow((static_cast<double>(x) - 256.0) / 60.0, 2)));
                 }).ok());
    WindParams p;
    p.venturi_per_m = 0.0f;
    p.project = false;
    double turned_before = 0.0;
    for (const float gain : {0.5f, 1.0f, 2.0f, 1.0e3f}) {
        p.warp_gain = gain;
        auto grid = WindGrid::create(d, p, 1.0).value();
        ASSERT_TRUE(grid.solve(d, {5.0f, 40.0f}).ok());
        double least = 90.0;
        double most = 0.0;
        for (size_t i = 0; i < grid.coarse_x().size(); ++i) {
            const double x = grid.coarse_x()[i];
            const double y = grid.coarse_y()[i];
            EXPECT_NEAR(std::hypot(x, y), 5.0, 1e-5);
            most = std::max(most, std::atan2(y, x) * 180.0 / M_PI);
            least = std::min(least, std::atan2(y, x) * 180.0 / M_PI);
        }
        EXPECT_GT(least, 40.0 - 1e-3);        // never away from the crest line (90 degrees)
        EXPECT_GT(most, turned_before + 0.5); // more for a larger gain
        EXPECT_LT(most, 90.0 + 1e-3);
        if (gain == 1.0e3f) {
            EXPECT_GT(most, 89.9);
        } // along the contour lines
        turned_before = most;
    }
}

TEST(WindGrid, StraightUpASlopeNeighboursDoNotTurnOppositeWays) {
    TileDomain d = flat_domain(TileLayout::rectangle(512, 8, 1, 1, Border::periodic), 0.0);
    // The crest is straight but for a millimetre of roughness.
    ASSERT_TRUE(d.fill(SimLayer::bedrock, [](int64_t x, int64_t y) {
                     return ticks(40.0 * std::sin(2.0 * M_PI * static_cast<double>(x) / 512.0)) +
                            static_cast<int32_t>((x * 7919 + y * 104729) % 131);
                 }).ok());
    WindParams p;
    p.venturi_per_m = 0.0f;
    p.project = false;
    auto grid = WindGrid::create(d, p, 1.0).value();
    ASSERT_TRUE(grid.solve(d, {5.0f, 0.0f}).ok());
    for (const float y : grid.coarse_y()) ASSERT_LT(std::abs(y), 0.05f);
}

TEST(WindGrid, NoScaleIsNoWarp) {
    TileDomain d = TileDomain::create(TileLayout::rectangle(256, 8, 1, 1, Border::periodic), k_layers).value();
    ASSERT_TRUE(fill_hills(d, 256).ok());
    WindParams p;
    p.venturi_per_m = 0.0f;
    p.project = false;
    p.warp_count = 0;
    auto none = WindGrid::create(d, p, 1.0).value();
    ASSERT_TRUE(none.solve(d, {5.0f, 30.0f}).ok());
    const WindVector v = vector_of({5.0f, 30.0f});
    EXPECT_EQ(none.coarse_x()[77], v.x_m_per_s);
    EXPECT_EQ(none.coarse_y()[77], v.y_m_per_s);
}

// --- P1
// -----------------------------------------------------------------------------------------------------------------

std::string solved_hash(TileDomain& d, const WindParams& p, const WindNow& now, std::vector<uint8_t>* saved = nullptr) {
    auto grid = WindGrid::create(d, p, 1.0);
    EXPECT_TRUE(grid.ok());
    EXPECT_TRUE(grid->solve(d, now).ok());
    EXPECT_TRUE(run_passes(d, std::vector<Pass>{grid->pass()}).ok());
    if (saved) *saved = grid->save();
    return d.hash({SimLayer::wind_x, SimLayer::wind_y}).value();
}

TEST(WindGrid, TheSameBitsForEveryWayToCutAndRun) {
    const RestoreMachine restore;
    const int32_t side = 1024;
    std::string first;
    std::vector<uint8_t> first_saved;
    for (const RunWay& way : run_ways(side, !long_tests())) {
        TileDomain d = make_periodic(side, way, k_layers);
        ASSERT_TRUE(fill_hills(d, side).ok());
        std::vector<uint8_t> saved;
        const std::string hash = solved_hash(d, WindParams{}, {6.0f, 25.0f}, &saved);
        if (first.empty()) {
            first = hash;
            first_saved = saved;
        }
        EXPECT_EQ(hash, first) << text_of(way);
        EXPECT_EQ(saved, first_saved) << text_of(way);
    }
}

TEST(WindGrid, ThePassIsHonest) {
    TileDomain d = TileDomain::create(TileLayout::rectangle(12, 4, 2, 1, Border::periodic), k_layers).value();
    ASSERT_TRUE(fill_hills(d, 24).ok());
    WindParams p;
    p.warp_radius_1_m = p.warp_radius_2_m = 14.0f; // spacing 2
    auto grid = WindGrid::create(d, p, 1.0).value();
    ASSERT_TRUE(grid.solve(d, {5.0f, 20.0f}).ok());
    EXPECT_EQ(grid.spacing_cells(), 2);
    EXPECT_EQ(find_dishonest(grid.pass(), k_layers, 1), "");
    EXPECT_TRUE(grid.pass().decl.derives());
    const std::vector<PassDecl> decls{grid.pass().decl};
    const auto plan = StepPlan::make(decls, 8, d.valid_halo());
    ASSERT_TRUE(plan.ok());
    EXPECT_EQ(plan->exchanges(), 0);
}

} // namespace
} // namespace sahel::test
