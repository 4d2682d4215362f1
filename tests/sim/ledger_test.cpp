#include "sim/ledger.h"

#include "sim/step_plan.h"
#include "toy_passes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace sahel::test {
namespace {

constexpr int32_t k_n = 16;
constexpr SimLayer k_air = SimLayer::airborne_sand;

SimLayerSet ledger_layers() {
    SimLayerSet layers = k_drift_layers;
    layers.insert({SimLayer::sand, SimLayer::water, SimLayer::moisture});
    return layers;
}

TileDomain make(const TileLayout& layout) {
    TileDomain d = TileDomain::create(layout, ledger_layers()).value();
    for (const SimLayer l : {k_air, SimLayer::sand, SimLayer::water, SimLayer::moisture})
        EXPECT_TRUE(d.fill(l, [&](int64_t x, int64_t y) {
                         return static_cast<int32_t>((17 * x + 31 * y + 1000003 * static_cast<int64_t>(l)) & 1023);
                     }).ok());
    EXPECT_TRUE(d.fill(SimLayer::wind_x, [](int64_t x, int64_t) { return static_cast<float>((x & 3) - 1); }).ok());
    EXPECT_TRUE(d.fill(SimLayer::wind_y, [](int64_t, int64_t y) { return static_cast<float>((y & 3) - 2); }).ok());
    for (int32_t slot = 0; slot < d.slots(); ++slot)
        for (int k = 0; k < k_direction_count; ++k) {
            if (d.plan().border(slot, k) != Border::frozen) continue;
            const std::vector<uint32_t> nothing(static_cast<size_t>(d.plan().segment(k).area()), 0);
            for (const SimLayer l : {SimLayer::wind_x, SimLayer::wind_y})
                EXPECT_TRUE(d.load_frozen(slot, k, l, nothing.data()).ok());
        }
    return d;
}

TileLayout pair_of_tiles() {
    TileLayout layout;
    layout.tile_cells = k_n;
    layout.halo = 4;
    layout.tiles = {{0, 0, 0}, {0, 1, 0}};
    return layout;
}

void advance(TileDomain& d, int steps) {
    for (int s = 0; s < steps; ++s) ASSERT_TRUE(run_passes(d, drift_passes()).ok());
}

TEST(Ledger, ClosesOverEveryKindOfBorder) {
    for (const Border border : {Border::periodic, Border::wall, Border::open}) {
        TileDomain d = make(TileLayout::rectangle(k_n, 6, 3, 2, border));
        Ledger ledger = Ledger::open(d).value();
        advance(d, 4);
        ASSERT_TRUE(ledger.close(d).ok());
        const LedgerCheck check = ledger.check();
        EXPECT_TRUE(check.closed()) << check.text;
        EXPECT_EQ(check.total[0], 0);
        EXPECT_EQ(check.tiles_open, 0);
        int64_t gone = 0;
        for (const TileAccount& tile : ledger.tiles()) {
            const LayerAccount& air = tile.of(k_air);
            for (const int64_t ticks : air.to_open) gone += ticks;
            EXPECT_EQ(air.converted(), 0);
            EXPECT_NE(air.exchanged, LayerAccount::Borders{});
        }
        EXPECT_EQ(gone > 0, border == Border::open);
    }
}

TEST(Ledger, ConversionsAddUpWithinASubstanceOnly) {
    TileDomain d = make(pair_of_tiles());
    Ledger ledger = Ledger::open(d).value();
    advance(d, 1);
    d.ints(SimLayer::sand)(1, 3, 4) -= 50; // lifted
    d.ints(k_air)(1, 5, 5) += 50;
    d.ints(SimLayer::water)(0, 1, 1) -= 9; // seeps away
    d.ints(SimLayer::moisture)(0, 9, 1) += 9;
    d.ints(SimLayer::sand)(0, 0, 0) += 1000; // supplied
    d.add_source(LedgerSource::supply_added, SimLayer::sand, 0, 1000);
    ASSERT_TRUE(ledger.close(d).ok());
    EXPECT_TRUE(ledger.check().closed()) << ledger.check().text;
    EXPECT_EQ(ledger.tiles()[1].of(k_air).converted(), 50);
    EXPECT_EQ(ledger.tiles()[1].of(SimLayer::sand).converted(), -50);
    EXPECT_EQ(ledger.tiles()[0].of(SimLayer::sand).converted(), 0);

    d.ints(SimLayer::sand)(1, 0, 0) += 3; // water into sand: nobody can
    d.ints(SimLayer::water)(1, 0, 0) -= 3;
    ASSERT_TRUE(ledger.close(d).ok());
    const LedgerCheck check = ledger.check();
    EXPECT_EQ(check.total[0], 3);
    EXPECT_EQ(check.total[1], -3);
    EXPECT_EQ(check.tiles_open, 1);
    for (const char* part : {"tile 1,0", "3 ticks", "sand -47", "solids"})
        EXPECT_NE(check.text.find(part), std::string::npos) << part << " in: " << check.text;
}

TEST(Ledger, OneTickThatNobodyMovedIsFoundAndNamed) {
    TileDomain d = make(pair_of_tiles());
    Ledger ledger = Ledger::open(d).value();
    advance(d, 2);
    d.ints(k_air)(0, 7, 7) -= 1;
    ASSERT_TRUE(ledger.close(d).ok());
    EXPECT_EQ(ledger.check().total[0], -1);
    EXPECT_NE(ledger.check().text.find("airborne_sand -1"), std::string::npos) << ledger.check().text;
    d.ints(k_air)(0, 7, 7) += 1;

    d.border_flows(k_air).flows[0] += 1; // slot 0, east: the neighbour knows better; and so does the own sum
    ASSERT_TRUE(ledger.close(d).ok());
    LedgerCheck check = ledger.check();
    ASSERT_EQ(check.borders.size(), 1u);
    EXPECT_EQ(check.borders[0].direction, 0);
    EXPECT_EQ(check.borders[0].ticks, 1);
    EXPECT_FALSE(check.closed());
    d.border_flows(k_air).flows[0] -= 1;

    d.border_flows(k_air).inbox[d.frame().of(-1, 3)] += 2;
    ASSERT_TRUE(ledger.close(d).ok());
    check = ledger.check();
    ASSERT_EQ(check.borders.size(), 1u);
    EXPECT_TRUE(check.borders[0].inbox);
    EXPECT_EQ(check.borders[0].ticks, -2);
    EXPECT_NE(check.text.find("west"), std::string::npos) << check.text;
}

TEST(Ledger, RunsAppendToTheAccountOfAWorld) {
    TileDomain d = make(pair_of_tiles());
    LedgerBook book;
    std::array<int64_t, k_conserved_count> waiting{};
    const auto run = [&](TileDomain& domain, int steps, int64_t arrives) {
        Ledger ledger = Ledger::open(domain).value();
        if (arrives != 0) ledger.arrived(0, k_air, arrives);
        advance(domain, steps);
        EXPECT_TRUE(ledger.close(domain).ok());
        EXPECT_TRUE(ledger.check().closed()) << ledger.check().text;
        for (const TileAccount& tile : ledger.tiles())
            for (const int64_t ticks : tile.of(k_air).to_frozen) waiting[ledger_index(k_air)] += ticks;
        return std::vector<TileAccount>(ledger.tiles().begin(), ledger.tiles().end());
    };
    ASSERT_TRUE(book.append(run(d, 2, 0)).ok());
    ASSERT_TRUE(book.append(run(d, 3, 0)).ok());
    EXPECT_TRUE(book.check(waiting).closed()) << book.check(waiting).text;
    EXPECT_EQ(book.check(waiting).total[0], 0);
    EXPECT_GT(waiting[ledger_index(k_air)], 0);

    // The tile to the west wakes: some of what waits is there now.
    TileLayout west = pair_of_tiles();
    west.tiles = {{0, -1, 0}};
    TileDomain w = make(west);
    w.ints(k_air)(0, k_n - 1, 5) += 100;
    waiting[ledger_index(k_air)] -= 100;
    ASSERT_TRUE(book.append(run(w, 1, 100)).ok());
    EXPECT_TRUE(book.check(waiting).closed()) << book.check(waiting).text;
    EXPECT_EQ(book.total(k_air).sources[static_cast<size_t>(LedgerSource::inbox)], 100);
    waiting[ledger_index(k_air)] -= 1;
    EXPECT_NE(book.check(waiting).text.find("1 ticks"), std::string::npos) << book.check(waiting).text;
    EXPECT_EQ(book.check(waiting).total[0], -1);
    waiting[ledger_index(k_air)] += 1;

    // Somebody changed a tile between two runs.
    d.ints(k_air)(1, 2, 2) += 5;
    const Status changed = book.append(run(d, 1, 0));
    ASSERT_FALSE(changed.ok());
    EXPECT_EQ(changed.error().kind, ErrorKind::corrupt);
    EXPECT_NE(changed.error().message.find("tile 1,0"), std::string::npos) << changed.error().message;
}

TEST(Ledger, BytesHoldEveryNumberAndNoDamagePasses) {
    TileAccount account{{0, -3, 7}, {}};
    const auto numbers = {int64_t{1},
                          int64_t{-1},
                          int64_t{64},
                          int64_t{-65},
                          int64_t{1} << 40,
                          std::numeric_limits<int64_t>::min(),
                          std::numeric_limits<int64_t>::max()};
    auto next = numbers.begin();
    for (size_t i = 0; i < account.layers.size(); i += 2) {
        LayerAccount& a = account.layers[i];
        a.opening = *next;
        a.to_frozen[3] = -7;
        a.sources[2] = i == 0 ? 0 : *next;
        if (++next == numbers.end()) next = numbers.begin();
        a.to_open[7] = *next;
        if (++next == numbers.end()) next = numbers.begin();
    }
    const std::vector<uint8_t> bytes = ledger_bytes(account);
    auto read = parse_ledger_bytes(account.key, bytes, "ledger");
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_EQ(*read, account);
    EXPECT_LT(ledger_bytes(TileAccount{{0, 1, 1}, {}}).size(), 8u);
    for (size_t n = 0; n < bytes.size(); ++n)
        EXPECT_FALSE(parse_ledger_bytes(account.key, std::span(bytes).first(n), "ledger").ok()) << n;
    std::vector<uint8_t> longer = bytes;
    longer.push_back(0);
    EXPECT_FALSE(parse_ledger_bytes(account.key, longer, "ledger").ok());
    longer = bytes;
    longer[0] = 9;
    EXPECT_EQ(parse_ledger_bytes(account.key, longer, "ledger").error().kind, ErrorKind::unsupported);
}

} // namespace
} // namespace sahel::test
