#include "sim/tile_domain.h"

#include "sim/step_plan.h"
#include "toy_passes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

namespace sahel::test {
namespace {

constexpr int32_t k_n = 16;
constexpr int32_t k_halo = 5;

int32_t value_at(int64_t x, int64_t y) {
    return static_cast<int32_t>(100000 + 1000 * y + x);
}

TileDomain domain_of(const TileLayout& layout, SimLayerSet layers = {SimLayer::sand}) {
    TileDomain d = TileDomain::create(layout, layers).value();
    EXPECT_TRUE(d.fill(SimLayer::sand, value_at).ok());
    return d;
}

TEST(TileDomain, FreshMemoryIsPoison) {
    TileDomain d =
        TileDomain::create(TileLayout::rectangle(k_n, k_halo, 2, 2, Border::periodic), {SimLayer::sand}).value();
    const auto w = d.words(SimLayer::sand);
    for (int32_t y = -k_halo; y < k_n + k_halo; ++y)
        for (int32_t x = -k_halo; x < k_n + k_halo; ++x) ASSERT_EQ(w(3, x, y), k_poison);
    EXPECT_EQ(d.valid_halo(SimLayer::sand), k_nothing_valid);
    EXPECT_EQ(TileDomain::slab_bytes(d.layout(), d.layers()), 4u * 26 * 32 * 4);
}

TEST(TileDomain, PeriodicHalosWrap) {
    for (const int64_t tiles : {1, 2, 3}) {
        TileDomain d = domain_of(TileLayout::rectangle(k_n, k_halo, tiles, tiles, Border::periodic, -1, 7));
        ASSERT_TRUE(d.exchange({SimLayer::sand}).ok());
        EXPECT_EQ(d.valid_halo(SimLayer::sand), k_halo);
        const auto s = d.ints(SimLayer::sand);
        const int64_t side = tiles * k_n;
        for (int32_t slot = 0; slot < d.slots(); ++slot) {
            const TileKey key = d.layout().tiles[static_cast<size_t>(slot)];
            for (int32_t y = -k_halo; y < k_n + k_halo; ++y)
                for (int32_t x = -k_halo; x < k_n + k_halo; ++x) {
                    const int64_t wx = floor_mod(key.x * k_n + x + k_n, side) - k_n;
                    const int64_t wy = floor_mod(key.y * k_n + y - 7 * k_n, side) + 7 * k_n;
                    ASSERT_EQ(s(slot, x, y), value_at(wx, wy)) << slot << ' ' << x << ' ' << y;
                    ASSERT_EQ(d.places().x(slot, x), wx);
                    ASSERT_EQ(d.places().y(slot, y), wy);
                }
        }
    }
}

TEST(TileDomain, WallsMirrorCellsAndVectors) {
    TileDomain d = domain_of(TileLayout::rectangle(k_n, k_halo, 2, 1, Border::wall),
                             {SimLayer::sand, SimLayer::wind_x, SimLayer::wind_y});
    ASSERT_TRUE(d.fill(SimLayer::wind_x, [](int64_t x, int64_t) { return 1.0f + static_cast<float>(x); }).ok());
    ASSERT_TRUE(d.fill(SimLayer::wind_y, [](int64_t, int64_t y) { return 1.0f + static_cast<float>(y); }).ok());
    ASSERT_TRUE(d.exchange(d.layers()).ok());
    const auto s = d.ints(SimLayer::sand);
    for (int32_t y = -k_halo; y < k_n + k_halo; ++y)
        for (int32_t x = -k_halo; x < k_n + k_halo; ++x) {
            const int32_t mx = x < 0 ? -1 - x : x;
            const int32_t my = y < 0 ? -1 - y : y >= k_n ? 2 * k_n - 1 - y : y;
            ASSERT_EQ(s(0, x, y), value_at(mx, my)) << x << ' ' << y;
            ASSERT_EQ(d.places().x(0, x), mx);
            ASSERT_EQ(d.places().y(0, y), my);
            ASSERT_EQ(d.reals(SimLayer::wind_x)(0, x, y), x < 0 ? -(1.0f + mx) : 1.0f + mx);
            ASSERT_EQ(d.reals(SimLayer::wind_y)(0, x, y), y != my ? -(1.0f + my) : 1.0f + my);
        }
    EXPECT_EQ(d.plan().border(0, 4), Border::wall);
    EXPECT_EQ(d.plan().border(0, 0), Border::neighbour);
}

TEST(TileDomain, OpenBordersGoOnAsTheyEndAndBringNothing) {
    TileLayout layout = TileLayout::rectangle(k_n, k_halo, 1, 1, Border::open);
    layout.east = Border::level;
    layout.level_ticks = 200000;
    TileDomain d = domain_of(
        layout, {SimLayer::bedrock, SimLayer::soil, SimLayer::sand, SimLayer::water, SimLayer::airborne_sand});
    for (const SimLayer l : {SimLayer::bedrock, SimLayer::soil, SimLayer::water, SimLayer::airborne_sand})
        ASSERT_TRUE(d.fill(l, [](int64_t, int64_t) { return 7; }).ok());
    ASSERT_TRUE(d.exchange(d.layers()).ok());
    EXPECT_EQ(d.ints(SimLayer::sand)(0, -3, 4), value_at(0, 4));
    EXPECT_EQ(d.ints(SimLayer::sand)(0, -3, -4), value_at(0, 0));
    EXPECT_EQ(d.ints(SimLayer::sand)(0, 9, k_n + 2), value_at(9, k_n - 1));
    EXPECT_EQ(d.ints(SimLayer::airborne_sand)(0, -1, 4), 0);
    EXPECT_EQ(d.ints(SimLayer::airborne_sand)(0, 0, 4), 7);
    EXPECT_EQ(d.ints(SimLayer::water)(0, -1, 4), 7);
    EXPECT_EQ(d.ints(SimLayer::water)(0, k_n, 4), 200000 - 14 - value_at(k_n - 1, 4));
    EXPECT_EQ(d.plan().border(0, 1), Border::level);
    EXPECT_EQ(d.plan().border(0, 3), Border::open);
    std::vector<LocalRect> cover;
    d.plan().cover(0, 4, cover);
    ASSERT_EQ(cover.size(), 1u); // nothing out there is computed
    EXPECT_EQ(cover[0].area(), k_n * k_n);
}

// An L of three tiles in a world without end: the fourth sleeps.
TEST(TileDomain, FrozenNeighboursKeepWhatWasLoaded) {
    TileLayout layout;
    layout.tile_cells = k_n;
    layout.halo = k_halo;
    layout.tiles = {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    TileDomain d = domain_of(layout, {SimLayer::sand, SimLayer::cliff});
    EXPECT_EQ(d.plan().border(0, 1), Border::frozen);
    EXPECT_EQ(d.plan().border(0, 0), Border::neighbour);
    EXPECT_TRUE(d.plan().has_frozen());
    const std::vector<int32_t> cells(k_halo * k_halo, 4711);
    ASSERT_TRUE(d.load_frozen(0, 1, SimLayer::sand, cells.data()).ok());
    ASSERT_TRUE(d.fill(SimLayer::cliff, [](int64_t, int64_t) { return 1.0f; }).ok());
    ASSERT_TRUE(d.exchange(d.layers()).ok());
    EXPECT_EQ(d.ints(SimLayer::sand)(0, k_n + 2, k_n + 2), 4711);
    EXPECT_EQ(d.reals(SimLayer::cliff)(0, k_n + 2, k_n + 2), 0.0f);
    EXPECT_EQ(d.ints(SimLayer::sand)(0, k_n + 2, 3), value_at(k_n + 2, 3));

    // The cover of slot 0 has its live sides and nothing else, each cell once.
    std::vector<LocalRect> cover;
    d.plan().cover(0, 3, cover);
    std::set<std::pair<int32_t, int32_t>> seen;
    for (const LocalRect& r : cover)
        for (int32_t y = r.y0; y < r.y1; ++y)
            for (int32_t x = r.x0; x < r.x1; ++x) EXPECT_TRUE(seen.insert({x, y}).second);
    EXPECT_EQ(seen.size(), static_cast<size_t>(k_n * k_n + 2 * 3 * k_n));
    EXPECT_FALSE(seen.contains({k_n, k_n}));
    EXPECT_FALSE(seen.contains({-1, 0}));
}

TEST(TileDomain, MessagesCarryExactlyWhatAnExchangeCopies) {
    TileLayout layout = TileLayout::rectangle(k_n, k_halo, 2, 2, Border::periodic);
    layout.north = layout.south = Border::wall;
    TileDomain direct = domain_of(layout, {SimLayer::sand, SimLayer::wind_y});
    TileDomain packed = domain_of(layout, {SimLayer::sand, SimLayer::wind_y});
    for (TileDomain* d : {&direct, &packed})
        ASSERT_TRUE(d->fill(SimLayer::wind_y, [](int64_t x, int64_t y) { return static_cast<float>(x - 3 * y); }).ok());
    ASSERT_TRUE(direct.exchange(direct.layers()).ok());
    const ExchangePlan& plan = packed.plan();
    std::set<std::pair<int32_t, int32_t>> pairs;
    std::vector<int32_t> buffer;
    for (const HaloMessage& m : plan.messages()) {
        EXPECT_TRUE(pairs.insert({m.src_slot, m.dst_slot}).second) << "two messages between one pair";
        buffer.resize(static_cast<size_t>(ExchangePlan::message_words(m, 2)));
        for (int l = 0; l < 2; ++l) {
            const SimLayer layer = l == 0 ? SimLayer::sand : SimLayer::wind_y;
            const SlabView<uint32_t> w = packed.words(layer);
            const SlabView<int32_t> slab{reinterpret_cast<int32_t*>(w.origin), w.stride, w.slot_stride, w.first,
                                         w.last};
            plan.pack(m, layer, slab, buffer.data() + l * m.cells);
            plan.unpack(m, slab, buffer.data() + l * m.cells);
        }
    }
    for (const SimLayer layer : {SimLayer::sand, SimLayer::wind_y})
        for (int32_t slot = 0; slot < 4; ++slot)
            for (int32_t y = -k_halo; y < k_n + k_halo; ++y)
                for (int32_t x = -k_halo; x < k_n + k_halo; ++x)
                    ASSERT_EQ(packed.words(layer)(slot, x, y), direct.words(layer)(slot, x, y))
                        << slot << ' ' << x << ' ' << y;
}

TEST(TileDomain, TheHashDoesNotKnowTheTilesAndSeesEveryCell) {
    const auto one = domain_of(TileLayout::rectangle(2 * k_n, 3, 1, 1, Border::open));
    auto four = domain_of(TileLayout::rectangle(k_n, k_halo, 2, 2, Border::open));
    EXPECT_EQ(one.hash({SimLayer::sand}).value(), four.hash({SimLayer::sand}).value());
    const std::string before = four.hash({SimLayer::sand}).value();
    auto s = four.ints(SimLayer::sand);
    std::swap(s(0, 3, 4), s(3, 3, 4));
    EXPECT_NE(four.hash({SimLayer::sand}).value(), before);
    std::swap(s(0, 3, 4), s(3, 3, 4));
    s(2, 0, k_n - 1) += 1;
    EXPECT_NE(four.hash({SimLayer::sand}).value(), before);
}

TEST(TileDomain, RefusalsSayWhy) {
    const auto wide = TileDomain::create(TileLayout::rectangle(16, 17, 1, 1, Border::open), {SimLayer::sand});
    ASSERT_FALSE(wide.ok());
    EXPECT_EQ(wide.error().kind, ErrorKind::usage);
    MemoryPool small("a small pool", MemoryKind::host, 1000);
    const auto poor = TileDomain::create(TileLayout::rectangle(16, 8, 1, 1, Border::open), {SimLayer::sand}, small);
    ASSERT_FALSE(poor.ok());
    EXPECT_EQ(poor.error().kind, ErrorKind::budget);
}

} // namespace
} // namespace sahel::test
