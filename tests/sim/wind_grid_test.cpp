#include "sim/wind_grid.h"

#include "pass_check.h"
#include "sim/step_plan.h"
#include "world/cpu_features.h"
#include "world/cuda_runtime.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
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

TEST(WindGrid, TheWindOverHillsClosesAndKeepsItsMean) {
    for (const Border border : {Border::periodic, Border::open})
        for (const auto& [tiles_x, tiles_y] : {std::pair{2, 2}, {3, 5}}) {
            TileDomain d =
                TileDomain::create(TileLayout::rectangle(128, 8, tiles_x, tiles_y, border), k_layers).value();
            ASSERT_TRUE(fill_hills(d, 128).ok());
            WindParams p;
            p.project = false;
            auto before = WindGrid::create(d, p, 1.0).value();
            ASSERT_TRUE(before.solve(d, {6.0f, 25.0f}).ok());
            p.project = true;
            auto after = WindGrid::create(d, p, 1.0).value();
            ASSERT_TRUE(after.solve(d, {6.0f, 25.0f}).ok());
            EXPECT_GT(after.projected().before, 0.1f);
            EXPECT_LT(after.projected().after, 1e-3f * after.projected().before);
            EXPECT_LE(after.projected().iterations, 10);
            const auto mean = [](std::span<const float> v) {
                double sum = 0.0;
                for (const float f : v) sum += static_cast<double>(f);
                return sum / static_cast<double>(v.size());
            };
            EXPECT_NEAR(mean(after.coarse_x()), mean(before.coarse_x()), 2e-6);
            EXPECT_NEAR(mean(after.coarse_y()), mean(before.coarse_y()), 2e-6);
        }
}

// --- P1

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

// --- reading

// Every live halo cell holds what an exchange would bring from its owner.
TEST(WindGrid, HalosHoldTheBitsOfTheirOwners) {
    TileLayout mixed = TileLayout::rectangle(128, 24, 2, 2, Border::periodic, -1, -1);
    mixed.north = mixed.south = Border::wall;
    for (const TileLayout& layout :
         {TileLayout::rectangle(128, 128, 1, 1, Border::periodic), TileLayout::rectangle(128, 24, 2, 2, Border::wall),
          TileLayout::rectangle(128, 24, 2, 1, Border::open), mixed})
        for (const float radius : {50.0f, 12.0f, 6.0f}) { // spacing 8, 2, 1
            TileDomain d = TileDomain::create(layout, k_layers).value();
            ASSERT_TRUE(fill_hills(d, 128).ok());
            WindParams p;
            p.warp_radius_2_m = radius;
            auto grid = WindGrid::create(d, p, 1.0).value();
            ASSERT_TRUE(grid.solve(d, {6.0f, 25.0f}).ok());
            const Pass pass = grid.pass();
            const int32_t h = d.halo();
            for (const bool v3 : {false, true}) {
                const RestoreMachine restore;
                set_isa(v3 ? Isa::v3 : Isa::baseline);
                ASSERT_TRUE(pass.run({d, d.launch(h, "sim/wind"), h}).ok());
                ASSERT_TRUE(pass.run({d, d.frozen_launch("sim/wind"), h}).ok());
                ASSERT_TRUE(d.fill_edges(pass.decl.writes).ok());
                const size_t words = TileDomain::slab_bytes(layout, {SimLayer::wind_x}) / 4;
                std::vector<uint32_t> made[2];
                for (const SimLayer l : {SimLayer::wind_x, SimLayer::wind_y}) {
                    const uint32_t* all = d.words(l).row(0, -h) - h;
                    made[l == SimLayer::wind_y].assign(all, all + words);
                    d.set_valid_halo(l, 0);
                }
                ASSERT_TRUE(d.exchange({SimLayer::wind_x, SimLayer::wind_y}).ok());
                for (const SimLayer l : {SimLayer::wind_x, SimLayer::wind_y}) {
                    const uint32_t* all = d.words(l).row(0, -h) - h;
                    EXPECT_TRUE(std::equal(all, all + words, made[l == SimLayer::wind_y].begin()))
                        << info_of(l).name << ", spacing " << grid.spacing_cells();
                }
            }
        }
}

TEST(WindGrid, CellsAreBilinearBetweenCentresAndNoneIsFasterThanSaid) {
    const TileLayout layout = TileLayout::rectangle(128, 8, 2, 2, Border::open, 3, -5);
    TileDomain d = TileDomain::create(layout, k_layers).value();
    ASSERT_TRUE(fill_hills(d, 256).ok());
    for (const float radius : {50.0f, 24.0f, 6.0f}) {
        WindParams p;
        p.warp_radius_2_m = radius;
        auto grid = WindGrid::create(d, p, 1.0).value();
        ASSERT_TRUE(grid.solve(d, {6.0f, 205.0f}).ok());
        ASSERT_TRUE(run_passes(d, std::vector<Pass>{grid.pass()}).ok());
        const int32_t s = grid.spacing_cells();
        const int32_t coarse = 256 / s;
        const auto at = [&](std::span<const float> plane, double x, double y) { // in coarse cells, from centre 0
            const double fx = std::clamp(x, 0.0, coarse - 1.0);
            const double fy = std::clamp(y, 0.0, coarse - 1.0);
            const auto i = static_cast<int32_t>(std::min(fx, coarse - 2.0));
            const auto j = static_cast<int32_t>(std::min(fy, coarse - 2.0));
            const auto v = [&](int32_t a, int32_t b) {
                return static_cast<double>(plane[static_cast<size_t>((j + b) * coarse + i + a)]);
            };
            return std::lerp(std::lerp(v(0, 0), v(1, 0), fx - i), std::lerp(v(0, 1), v(1, 1), fx - i), fy - j);
        };
        float fastest = 0.0f;
        for (int32_t slot = 0; slot < 4; ++slot) {
            const Cells c = wind_of(d, slot);
            for (int32_t y = 0; y < 128; ++y)
                for (int32_t x = 0; x < 128; ++x) {
                    const auto k = static_cast<size_t>(y * 128 + x);
                    const double cx = (x + 128 * (slot % 2) + 0.5) / s - 0.5;
                    const double cy = (y + 128 * (slot / 2) + 0.5) / s - 0.5;
                    ASSERT_NEAR(c.x[k], at(grid.coarse_x(), cx, cy), 2e-6) << x << ' ' << y << ' ' << s;
                    ASSERT_NEAR(c.y[k], at(grid.coarse_y(), cx, cy), 2e-6) << x << ' ' << y << ' ' << s;
                    fastest = std::max(fastest, std::sqrt(c.x[k] * c.x[k] + c.y[k] * c.y[k]));
                }
        }
        EXPECT_LE(fastest, grid.max_speed());
        EXPECT_GT(fastest, 0.95f * grid.max_speed());
    }
}

TEST(WindGrid, APatchOfAPeriodicWorldHasOpenBorders) {
    TileLayout layout = TileLayout::rectangle(128, 8, 4, 4, Border::periodic);
    layout.tiles = {{0, 1, 1}, {0, 2, 1}, {0, 1, 2}, {0, 2, 2}};
    const WindRegion patch = WindRegion::of(layout);
    EXPECT_FALSE(patch.x.periodic);
    EXPECT_EQ(patch.x.first, 128);
    EXPECT_EQ(patch.y.cells, 256);
    layout.tiles = {{0, 0, 1}, {0, 1, 1}, {0, 2, 1}, {0, 3, 1}};
    EXPECT_TRUE(WindRegion::of(layout).x.periodic);
    EXPECT_FALSE(WindRegion::of(layout).y.periodic);
    layout = TileLayout::rectangle(128, 8, 4, 4, Border::wall);
    layout.tiles = {{0, 0, 0}, {0, 1, 0}};
    const WindRegion corner = WindRegion::of(layout);
    EXPECT_TRUE(corner.x.wall_low && corner.y.wall_low);
    EXPECT_FALSE(corner.x.wall_high || corner.y.wall_high);
}

// --- regions that are not resident at once

TEST(WindGrid, ARegionInPartsIsTheRegionAtOnce) {
    const TileLayout whole = TileLayout::rectangle(128, 16, 4, 2, Border::periodic, -2, 0);
    TileDomain all = TileDomain::create(whole, k_layers).value();
    ASSERT_TRUE(fill_hills(all, 256).ok());
    const WindParams p;
    auto at_once = WindGrid::create(all, p, 1.0).value();
    ASSERT_TRUE(at_once.solve(all, {6.0f, 25.0f}).ok());
    ASSERT_TRUE(run_passes(all, std::vector<Pass>{at_once.pass()}).ok());

    auto in_parts = WindGrid::create(WindRegion::of(whole), p, 1.0).value();
    std::vector<TileDomain> parts;
    for (size_t first : {size_t{4}, size_t{0}}) {
        TileLayout part = whole;
        part.tiles.assign(whole.tiles.begin() + static_cast<ptrdiff_t>(first),
                          whole.tiles.begin() + static_cast<ptrdiff_t>(first + 4));
        parts.push_back(TileDomain::create(part, k_layers).value());
        ASSERT_TRUE(fill_hills(parts.back(), 256).ok());
    }
    in_parts.clear_ground();
    for (const TileDomain& d : parts) ASSERT_TRUE(in_parts.add_ground(d).ok());
    ASSERT_TRUE(in_parts.solve_ground({6.0f, 25.0f}).ok());
    EXPECT_EQ(in_parts.save(), at_once.save());
    for (size_t k = 0; k < 2; ++k) {
        ASSERT_TRUE(run_passes(parts[k], std::vector<Pass>{in_parts.pass()}).ok());
        for (int32_t slot = 0; slot < 4; ++slot) {
            const Cells a = wind_of(parts[k], slot);
            const Cells b = wind_of(all, slot + (k == 0 ? 4 : 0));
            EXPECT_EQ(a.x, b.x);
            EXPECT_EQ(a.y, b.y);
        }
    }
}

TEST(WindGrid, WhereThereIsNoTileTheGroundGoesOn) {
    TileLayout layout = TileLayout::rectangle(128, 16, 3, 3, Border::open);
    layout.tiles.erase(layout.tiles.begin() + 4); // the middle one
    TileDomain d = flat_domain(layout, 1234.5);
    auto grid = WindGrid::create(d, WindParams{}, 1.0).value();
    ASSERT_TRUE(grid.solve(d, {6.0f, 0.0f}).ok());
    for (const float x : grid.coarse_x()) ASSERT_EQ(x, 6.0f); // as over flat ground
    for (const float y : grid.coarse_y()) ASSERT_EQ(y, 0.0f);
    // With hills around, the gap is passed without a wind that sees a hole of a kilometre.
    ASSERT_TRUE(d.fill(SimLayer::bedrock, [](int64_t x, int64_t y) { return ticks(hills(x, y, 384)); }).ok());
    ASSERT_TRUE(grid.solve(d, {6.0f, 0.0f}).ok());
    EXPECT_LT(grid.max_speed(), 12.0f);
}

// --- symmetry

TEST(WindGrid, TurnsAndMirrorsWithTheWorld) {
    const int32_t n = 256;
    const auto solved = [&](auto&& height, float angle, bool project) {
        TileDomain d = flat_domain(TileLayout::rectangle(n, 8, 1, 1, Border::periodic), 0.0);
        EXPECT_TRUE(d.fill(SimLayer::bedrock, height).ok());
        WindParams p;
        p.project = project;
        auto grid = WindGrid::create(d, p, 1.0).value();
        EXPECT_TRUE(grid.solve(d, {6.0f, angle}).ok());
        return grid;
    };
    const auto height = [&](int64_t x, int64_t y) { return ticks(hills(x, y, n)); };
    for (const bool project : {false, true}) {
        const auto a = solved(height, 25.0f, project);
        const auto turned = solved([&](int64_t x, int64_t y) { return height(y, n - 1 - x); }, 115.0f, project);
        const auto seen = solved([&](int64_t x, int64_t y) { return height(n - 1 - x, y); }, 155.0f, project);
        const int32_t c = n / a.spacing_cells();
        float most = 0.0f;
        for (int32_t y = 0; y < c; ++y)
            for (int32_t x = 0; x < c; ++x) {
                const auto i = static_cast<size_t>(y * c + x);
                const auto t = static_cast<size_t>(x * c + c - 1 - y);
                const auto m = static_cast<size_t>(y * c + c - 1 - x);
                most = std::max({most, std::abs(turned.coarse_x()[t] + a.coarse_y()[i]),
                                 std::abs(turned.coarse_y()[t] - a.coarse_x()[i]),
                                 std::abs(seen.coarse_x()[m] + a.coarse_x()[i]),
                                 std::abs(seen.coarse_y()[m] - a.coarse_y()[i])});
            }
        EXPECT_LT(most, 2e-5f) << project; // of 6 m/s: sums along x come before those along y
    }
}

// --- saving

TEST(WindGrid, ASavedSolutionComesBackAndOnlyWhereItFits) {
    const TileLayout layout = TileLayout::rectangle(128, 16, 2, 1, Border::periodic);
    TileDomain d = TileDomain::create(layout, k_layers).value();
    ASSERT_TRUE(fill_hills(d, 128).ok());
    auto grid = WindGrid::create(d, WindParams{}, 1.0).value();
    EXPECT_FALSE(grid.solved());
    ASSERT_TRUE(grid.solve(d, {6.0f, 25.0f}).ok());
    ASSERT_TRUE(run_passes(d, std::vector<Pass>{grid.pass()}).ok());
    const std::string hash = d.hash({SimLayer::wind_x, SimLayer::wind_y}).value();
    const std::vector<uint8_t> bytes = grid.save();
    EXPECT_EQ(bytes.size(), 40u + 2u * 32 * 16 * 4);

    TileDomain later = TileDomain::create(layout, k_layers).value();
    ASSERT_TRUE(fill_hills(later, 64).ok()); // the ground has changed; the epoch has not
    auto resumed = WindGrid::create(later, WindParams{}, 1.0).value();
    ASSERT_TRUE(resumed.restore(bytes).ok());
    EXPECT_EQ(resumed.max_speed(), grid.max_speed());
    ASSERT_TRUE(run_passes(later, std::vector<Pass>{resumed.pass()}).ok());
    EXPECT_EQ(later.hash({SimLayer::wind_x, SimLayer::wind_y}).value(), hash);
    EXPECT_EQ(resumed.save(), bytes);

    const auto refused = [&](std::vector<uint8_t> b, ErrorKind kind) {
        const Status s = resumed.restore(b);
        ASSERT_FALSE(s.ok());
        EXPECT_EQ(s.error().kind, kind) << s.error().message;
        EXPECT_EQ(resumed.save(), bytes); // and nothing was taken over
    };
    refused({}, ErrorKind::corrupt);
    refused({bytes.begin(), bytes.end() - 1}, ErrorKind::corrupt);
    auto other = bytes;
    other[0] ^= 1;
    refused(other, ErrorKind::corrupt);
    other = bytes;
    other[4] = 99;
    refused(other, ErrorKind::unsupported);
    other = bytes;
    other[8] ^= 1; // origin
    refused(other, ErrorKind::usage);
    other = bytes;
    std::fill(other.end() - 4, other.end(), uint8_t{0xFF}); // a NaN
    refused(other, ErrorKind::corrupt);
    WindParams finer;
    finer.warp_radius_2_m = 20.0f;
    EXPECT_FALSE(WindGrid::create(d, finer, 1.0)->restore(bytes).ok());
    TileDomain wall = TileDomain::create(TileLayout::rectangle(128, 16, 2, 1, Border::wall), k_layers).value();
    EXPECT_FALSE(WindGrid::create(wall, WindParams{}, 1.0)->restore(bytes).ok());
}

TEST(WindGrid, RefusalsSayWhy) {
    TileDomain d = flat_domain(TileLayout::rectangle(128, 8, 1, 1, Border::open), 0.0);
    WindParams p;
    p.ratio = 0.0f;
    const auto bad = WindGrid::create(d, p, 1.0);
    ASSERT_FALSE(bad.ok());
    EXPECT_NE(bad.error().message.find("ratio"), std::string::npos) << bad.error().message;
    EXPECT_FALSE(WindGrid::create(d, WindParams{}, 0.0).ok());
    WindRegion huge = WindRegion::of(d.layout());
    huge.x.cells = huge.y.cells = 1 << 26;
    const auto large = WindGrid::create(huge, WindParams{}, 1.0);
    ASSERT_FALSE(large.ok());
    EXPECT_EQ(large.error().kind, ErrorKind::usage);
    auto elsewhere = WindGrid::create(d, WindParams{}, 1.0).value();
    EXPECT_FALSE(elsewhere.solve_ground({1.0f, 0.0f}).ok()); // no ground yet
    const TileDomain far = flat_domain(TileLayout::rectangle(128, 8, 1, 1, Border::open, 7, 7), 0.0);
    EXPECT_FALSE(elsewhere.add_ground(far).ok());
}

// --- CUDA

TEST(WindGrid, OnADeviceTheSameBits) {
    if (!cuda::available()) GTEST_SKIP() << "no CUDA device: " << cuda::status().why_not;
    TileLayout layout = TileLayout::rectangle(128, 16, 3, 2, Border::wall, -1, 0);
    TileDomain host = TileDomain::create(layout, k_layers).value();
    MemoryPool pool("test", MemoryKind::cuda, uint64_t{1} << 30);
    TileDomain device = TileDomain::create(layout, k_layers, pool).value();
    std::string hashes[2];
    std::vector<uint8_t> saved[2];
    for (TileDomain* d : {&host, &device}) {
        ASSERT_TRUE(fill_hills(*d, 128).ok());
        hashes[d == &device] = solved_hash(*d, WindParams{}, {6.0f, 25.0f}, &saved[d == &device]);
    }
    EXPECT_EQ(saved[0], saved[1]);
    EXPECT_EQ(hashes[0], hashes[1]);
}

} // namespace
} // namespace sahel::test
