#include "sim/border_flows.h"

#include "sim/step_plan.h"
#include "toy_passes.h"
#include "world/cuda_runtime.h"
#include "world/memory.h"

#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <set>
#include <vector>

namespace sahel::test {
namespace {

constexpr SimLayer k_air = SimLayer::airborne_sand;

int32_t amount_at(int64_t x, int64_t y) {
    const uint64_t h =
        (static_cast<uint64_t>(x) * 0x9E3779B97F4A7C15ull ^ static_cast<uint64_t>(y)) * 0xD6E8FEB86659FD93ull;
    return static_cast<int32_t>(h >> 52);
}
float wind_at(int64_t x, int64_t y, int salt) {
    return static_cast<float>(amount_at(x + 1000 * salt, y - 77 * salt) % 7 - 3);
}

TileDomain drift_domain(const TileLayout& layout, MemoryPool& pool = MemoryPool::host()) {
    TileDomain d = TileDomain::create(layout, k_drift_layers, pool).value();
    EXPECT_TRUE(d.fill(k_air, amount_at).ok());
    EXPECT_TRUE(d.fill(SimLayer::wind_x, [](int64_t x, int64_t y) { return wind_at(x, y, 1); }).ok());
    EXPECT_TRUE(d.fill(SimLayer::wind_y, [](int64_t x, int64_t y) { return wind_at(x, y, 2); }).ok());
    for (int32_t slot = 0; slot < d.slots(); ++slot)
        for (int k = 0; k < k_direction_count; ++k) {
            if (d.plan().border(slot, k) != Border::frozen) continue;
            const std::vector<uint32_t> nothing(static_cast<size_t>(d.plan().segment(k).area()), 0);
            for (const SimLayer l : {SimLayer::wind_x, SimLayer::wind_y})
                EXPECT_TRUE(d.load_frozen(slot, k, l, nothing.data()).ok());
        }
    return d;
}

struct Account {
    std::vector<int64_t> before, after;
    std::vector<TileDomain::SlotFlows> flows;
};

Account drift(TileDomain& d, int steps) {
    Account a;
    a.before = d.sums(k_air).value();
    EXPECT_TRUE(d.keep_flows().ok());
    for (int s = 0; s < steps; ++s) EXPECT_TRUE(run_passes(d, drift_passes()).ok());
    a.after = d.sums(k_air).value();
    a.flows = d.flows(k_air).value();
    return a;
}

void expect_exact(const TileDomain& d, const Account& a) {
    int64_t crossed = 0;
    for (size_t slot = 0; slot < a.flows.size(); ++slot) {
        const int64_t out = std::accumulate(a.flows[slot].begin(), a.flows[slot].end(), int64_t{0});
        EXPECT_EQ(a.after[slot] - a.before[slot], -out) << "slot " << slot;
        for (int k = 0; k < k_direction_count; ++k) {
            const BorderPartner p = d.plan().partner(static_cast<int32_t>(slot), k);
            const int64_t here = a.flows[slot][static_cast<size_t>(k)];
            crossed += std::abs(here);
            EXPECT_EQ(p.slot >= 0, is_live(d.plan().border(static_cast<int32_t>(slot), k)));
            if (p.slot < 0) {
                EXPECT_GE(here, 0) << "nothing comes in there";
                continue;
            }
            EXPECT_EQ(here + a.flows[static_cast<size_t>(p.slot)][static_cast<size_t>(p.direction)], 0)
                << "slot " << slot << " direction " << k;
            const BorderPartner back = d.plan().partner(p.slot, p.direction);
            EXPECT_EQ(back.slot, static_cast<int32_t>(slot));
            EXPECT_EQ(back.direction, k);
        }
    }
    if (a.flows.size() > 1) {
        EXPECT_GT(crossed, 0) << "nothing moved";
    }
}

TEST(BorderFlows, EveryHaloCellHasAPlaceOfItsOwnInTheFrame) {
    for (const auto& [n, halo] : {std::pair{1, 1}, {4, 1}, {5, 3}, {16, 16}, {128, 8}}) {
        const FrameIndex frame{n, halo};
        std::set<int64_t> seen;
        for (int32_t y = -halo; y < n + halo; ++y)
            for (int32_t x = -halo; x < n + halo; ++x)
                if (x < 0 || x >= n || y < 0 || y >= n) seen.insert(frame.of(x, y));
        EXPECT_EQ(static_cast<int64_t>(seen.size()), frame.count());
        EXPECT_EQ(*seen.begin(), 0);
        EXPECT_EQ(*seen.rbegin(), frame.count() - 1);
    }
}

TEST(BorderFlows, BothSidesOfEveryBorderAgree) {
    for (const int32_t n : {4, 8, 16})
        for (const int64_t tiles : {1, 2, 3})
            for (const Border border : {Border::periodic, Border::wall, Border::open}) {
                SCOPED_TRACE(testing::Message()
                             << "tiles of " << n << ", " << tiles << ", border " << static_cast<int>(border));
                TileDomain d = drift_domain(TileLayout::rectangle(n, 4, tiles, tiles, border, -1, 2));
                const Account a = drift(d, 5);
                expect_exact(d, a);
                const int64_t before = std::accumulate(a.before.begin(), a.before.end(), int64_t{0});
                const int64_t after = std::accumulate(a.after.begin(), a.after.end(), int64_t{0});
                EXPECT_EQ(after < before, border == Border::open);
                EXPECT_LE(after, before);
                if (border == Border::wall && tiles == 1) {
                    EXPECT_EQ(a.flows[0], TileDomain::SlotFlows{});
                }
            }
}

TEST(BorderFlows, MixedBordersAgreeToo) {
    TileLayout layout = TileLayout::rectangle(8, 6, 3, 2, Border::open);
    layout.west = Border::wall;
    layout.north = layout.south = Border::periodic;
    layout.tiles.erase(layout.tiles.begin() + 4); // one tile sleeps
    TileDomain d = drift_domain(layout);
    expect_exact(d, drift(d, 4));
}

TEST(BorderFlows, WhatCrossesALineIsTheSameForEveryCut) {
    std::map<int32_t, int64_t> east;
    for (const int32_t n : {8, 16, 32}) {
        const int64_t tiles = 64 / n;
        for (const int32_t halo : {4, 7, 8}) {
            TileDomain d = drift_domain(TileLayout::rectangle(n, halo, tiles, tiles, Border::periodic));
            const Account a = drift(d, 3);
            int64_t sum = 0; // what goes east through x = 32: all that leaves the tiles to the west of it
            for (size_t slot = 0; slot < a.flows.size(); ++slot)
                if (d.layout().tiles[slot].x == tiles / 2 - 1)
                    sum += a.flows[slot][7] + a.flows[slot][0] + a.flows[slot][1];
            const auto [at, first] = east.emplace(32, sum);
            EXPECT_EQ(at->second, sum) << "tiles of " << n << ", halo " << halo << (first ? " (first)" : "");
        }
    }
    EXPECT_NE(east[32], 0);
}

TEST(BorderFlows, FrozenNeighboursHoldExactlyWhatLanded) {
    constexpr int32_t n = 16;
    TileLayout alone;
    alone.tile_cells = n;
    alone.halo = 8;
    alone.tiles = {{0, 0, 0}, {0, 1, 0}};
    TileDomain d = drift_domain(alone);
    const Account a = drift(d, 1);
    expect_exact(d, a);
    // The same tiles among resident ones that hold nothing.
    TileDomain whole = drift_domain(TileLayout::rectangle(n, 8, 4, 3, Border::open, -1, -1));
    const auto inside = [](int64_t x, int64_t y) { return x >= 0 && x < 2 * n && y >= 0 && y < n; };
    ASSERT_TRUE(whole.fill(k_air, [&](int64_t x, int64_t y) { return inside(x, y) ? amount_at(x, y) : 0; }).ok());
    (void)drift(whole, 1);
    std::map<std::pair<int64_t, int64_t>, int64_t> landed;
    for (int32_t slot = 0; slot < 2; ++slot) {
        const std::vector<int32_t> inbox = d.inbox(slot, k_air).value();
        ASSERT_EQ(static_cast<int64_t>(inbox.size()), d.frame().count());
        TileDomain::SlotFlows by_direction{};
        for (int32_t y = -8; y < n + 8; ++y)
            for (int32_t x = -8; x < n + 8; ++x) {
                const int k = direction_of(x < 0 ? -1 : x >= n, y < 0 ? -1 : y >= n);
                if (k < 0) continue;
                const int32_t ticks = inbox[static_cast<size_t>(d.frame().of(x, y))];
                by_direction[static_cast<size_t>(k)] += ticks;
                if (ticks != 0) landed[{slot * n + x, y}] += ticks;
            }
        for (int k = 0; k < k_direction_count; ++k)
            EXPECT_EQ(by_direction[static_cast<size_t>(k)],
                      d.plan().border(slot, k) == Border::frozen
                          ? a.flows[static_cast<size_t>(slot)][static_cast<size_t>(k)]
                          : 0);
    }
    EXPECT_GT(landed.size(), 20u);
    for (int32_t slot = 0; slot < whole.slots(); ++slot) {
        const TileKey key = whole.layout().tiles[static_cast<size_t>(slot)];
        for (int32_t y = 0; y < n; ++y)
            for (int32_t x = 0; x < n; ++x) {
                const int64_t wx = key.x * n + x, wy = key.y * n + y;
                if (inside(wx, wy)) continue;
                const auto found = landed.find({wx, wy});
                ASSERT_EQ(whole.ints(k_air)(slot, x, y), found == landed.end() ? 0 : found->second) << wx << ' ' << wy;
            }
    }
}

TEST(BorderFlows, KeepingAgainStartsFromZeroInTheSameMemory) {
    TileLayout layout;
    layout.tile_cells = 8;
    layout.halo = 4;
    layout.tiles = {{0, 0, 0}};
    MemoryPool pool("flows", MemoryKind::host, uint64_t{1} << 30);
    TileDomain d = drift_domain(layout, pool);
    const uint64_t before = pool.used_bytes();
    (void)drift(d, 2);
    EXPECT_EQ(pool.used_bytes() - before, TileDomain::flow_bytes(layout, k_drift_layers));
    d.add_source(LedgerSource::supply_added, k_air, 0, 17);
    EXPECT_EQ(d.source(LedgerSource::supply_added, k_air, 0), 17);
    EXPECT_EQ(d.source(LedgerSource::supply_removed, k_air, 0), 0);
    ASSERT_TRUE(d.keep_flows().ok());
    EXPECT_EQ(pool.used_bytes() - before, TileDomain::flow_bytes(layout, k_drift_layers));
    EXPECT_EQ(pool.peak_bytes(), pool.used_bytes());
    const auto flows = d.flows(k_air).value();
    EXPECT_EQ(flows[0], TileDomain::SlotFlows{});
    for (const int32_t ticks : d.inbox(0, k_air).value()) EXPECT_EQ(ticks, 0);
    EXPECT_EQ(d.source(LedgerSource::supply_added, k_air, 0), 0);
}

TEST(BorderFlows, TheDeviceCountsTheSame) {
    if (!cuda::available()) GTEST_SKIP() << "no CUDA device: " << cuda::status().why_not;
    MemoryPool pool("device", MemoryKind::cuda, uint64_t{1} << 28);
    for (const int32_t n : {4, 8, 16}) {
        TileLayout layout = TileLayout::rectangle(n, 4, 3, 3, Border::open);
        layout.west = layout.east = Border::periodic;
        layout.tiles.pop_back();
        TileDomain host = drift_domain(layout);
        TileDomain device = drift_domain(layout, pool);
        const Account a = drift(host, 4), b = drift(device, 4);
        expect_exact(device, b);
        EXPECT_EQ(a.flows, b.flows);
        for (int32_t slot = 0; slot < host.slots(); ++slot)
            EXPECT_EQ(host.inbox(slot, k_air).value(), device.inbox(slot, k_air).value());
    }
}

} // namespace
} // namespace sahel::test
