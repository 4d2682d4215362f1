#include "sim/supply.h"

#include "pass_check.h"
#include "sand_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace sahel::test {
namespace {

TEST(Supply, CoverageIsCountedExactly) {
    SandWorld w(64, 8);
    const SandParams p; // threshold 0.1 m
    const int32_t threshold = ticks_of_metres(0.1f);
    w.ticks(SimLayer::sand, [=](int64_t x, int64_t y) { return threshold + (x < 10 && y < 3 ? 1 : 0); });
    w.run(covered_pass(p));
    EXPECT_EQ(w.sum(SimLayer::surface), 30);
}

TEST(Supply, EverywhereByTheMeanAmount) {
    SandWorld w(128, 8);
    SandParams p;
    p.supply_uniform = true;
    p.supply_add_m = 0.5f;
    w.run(supply_pass(p, 1, 0, false));
    EXPECT_NEAR(static_cast<double>(w.sum(SimLayer::sand)) / 131072.0 / 16384.0, 0.5, 0.015);
    for (int32_t x = 0; x < 128; ++x) {
        EXPECT_GE(w.ticks_at(SimLayer::sand, x, 5), 0);
        EXPECT_LE(w.ticks_at(SimLayer::sand, x, 5), 131072);
    }
    // Removal stops at nothing; the same event draws the same numbers.
    p.supply_remove_m = 0.5f;
    w.run(supply_pass(p, 1, 0, true));
    EXPECT_EQ(w.sum(SimLayer::sand), 0);
    w.run(supply_pass(p, 1, 7, false));
    const int32_t first = w.ticks_at(SimLayer::sand, 3, 3);
    w.ticks(SimLayer::sand, 0);
    w.run(supply_pass(p, 1, 8, false));
    EXPECT_NE(w.ticks_at(SimLayer::sand, 3, 3), first); // no cell is always favoured
}

TEST(Supply, ADiscThatWrapsAtAPlaceOfItsOwnEachTime) {
    SandParams p;
    p.supply_radius_cells = 20;
    p.supply_add_m = 1.0f;
    int64_t sum_x = 0;
    int wrapped = 0;
    for (int64_t step = 0; step < 40; ++step) {
        SandWorld w(64, 8, 2); // 128 x 128 cells
        w.run(supply_pass(p, 5, step, false));
        int64_t cells = 0;
        bool at_west = false;
        bool at_east = false;
        for (int32_t slot = 0; slot < 4; ++slot) {
            const auto sand = std::as_const(w.domain).ints(SimLayer::sand);
            const TileKey key = w.domain.layout().tiles[static_cast<size_t>(slot)];
            for (int32_t y = 0; y < 64; ++y)
                for (int32_t x = 0; x < 64; ++x) {
                    if (sand(slot, x, y) == 0) continue;
                    ++cells;
                    sum_x += key.x * 64 + x;
                    at_west = at_west || key.x * 64 + x == 0;
                    at_east = at_east || key.x * 64 + x == 127;
                }
        }
        EXPECT_NEAR(static_cast<double>(cells), M_PI * 20.0 * 20.0, 30.0);
        wrapped += at_west && at_east;
    }
    EXPECT_GT(wrapped, 3); // 40 of 128 places wrap
    EXPECT_LT(wrapped, 25);
    EXPECT_NEAR(static_cast<double>(sum_x) / (40.0 * M_PI * 400.0), 63.5, 20.0);
}

TEST(Supply, LooksNoFurtherThanItDeclares) {
    SandParams p;
    EXPECT_EQ(find_dishonest(covered_pass(p), k_sand_layers, 4), "");
    p.supply_uniform = true;
    EXPECT_EQ(find_dishonest(supply_pass(p, 1, 0, false), k_sand_layers, 4), "");
    EXPECT_EQ(find_dishonest(supply_pass(p, 1, 0, true), k_sand_layers, 4), "");
    p.supply_uniform = false;
    p.supply_radius_cells = 5;
    EXPECT_EQ(find_dishonest(supply_pass(p, 1, 0, false), k_sand_layers, 4), "");
}

} // namespace
} // namespace sahel::test
