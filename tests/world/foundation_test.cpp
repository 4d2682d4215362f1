#include "world/field.h"
#include "world/layers.h"
#include "world/memory.h"
#include "world/result.h"
#include "world/tile_key.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <unordered_set>
#include <vector>

namespace sahel {
namespace {

// --- Result
// ----------------------------------------------------------------------------------------------------------------

Result<int> half(int v) {
    if (v % 2 != 0) return Error{ErrorKind::usage, "odd"};
    return v / 2;
}
Result<int> quarter(int v) {
    SAHEL_ASSIGN(const int h, half(v));
    SAHEL_ASSIGN(const int q, half(h));
    return q;
}
Status is_quarter(int v, int q) {
    SAHEL_TRY(quarter(v));
    if (quarter(v).value() != q) return Error{ErrorKind::corrupt, "not a quarter"};
    return {};
}

TEST(Result, CarriesValuesAndErrorsUpward) {
    EXPECT_EQ(quarter(12).value(), 3);
    EXPECT_FALSE(quarter(3).ok());
    EXPECT_FALSE(quarter(6));
    EXPECT_EQ(quarter(6).error().message, "odd");
    EXPECT_TRUE(is_quarter(12, 3).ok());
    EXPECT_EQ(is_quarter(12, 4).error().kind, ErrorKind::corrupt);
    EXPECT_EQ(is_quarter(5, 4).error().kind, ErrorKind::usage);
    EXPECT_EQ(is_quarter(5, 4).error().exit_code(), 2);
    EXPECT_EQ(is_quarter(12, 4).error().exit_code(), 1);
}

TEST(Result, MovesWhatCannotBeCopied) {
    const auto make = []() -> Result<std::unique_ptr<int>> { return std::make_unique<int>(7); };
    const auto pass_on = [&]() -> Result<std::unique_ptr<int>> {
        SAHEL_ASSIGN(auto p, make());
        return p;
    };
    const std::unique_ptr<int> p = pass_on().value();
    EXPECT_EQ(*p, 7);
}

TEST(Result, TheValueOfATemporaryOutlivesIt) {
    const auto make = []() -> Result<std::vector<std::string>> {
        return std::vector<std::string>{std::string(100, 'a'), std::string(100, 'b')};
    };
    std::string seen;
    for (const std::string& s : make().value()) seen += s[0];
    for (const std::string& s : *make()) seen += s[0];
    EXPECT_EQ(seen, "abab");
}

TEST(ResultDeathTest, AskingForWhatIsNotThereSaysWhatWasThere) {
    EXPECT_DEATH(static_cast<void>(half(3).value()), "Result has a value.*odd");
    EXPECT_DEATH(static_cast<void>(half(4).error()), "check failed");
}

TEST(CheckDeathTest, PrintsTheExpressionAndBothValues) {
    const int64_t a = -5;
    const int64_t b = 7;
    EXPECT_DEATH(SAHEL_CHECK_EQ(a, b), "foundation_test.cpp:[0-9]+: check failed: a == b; values -5 against 7");
    EXPECT_DEATH(SAHEL_CHECK_LT(b, a), "b < a; values 7 against -5");
    EXPECT_DEATH(SAHEL_CHECK(a == 5 || b == 5), "check failed: a == 5 .. b == 5");
    const uint64_t large = std::numeric_limits<uint64_t>::max();
    EXPECT_DEATH(SAHEL_CHECK_EQ(large, 0u), "values 18446744073709551615 against 0");
    EXPECT_DEATH(SAHEL_CHECK_LE(0.25f, 0.125f), "values 0.25 against 0.125");
    EXPECT_DEATH(SAHEL_CHECK_EQ(std::string("left"), "right"), "values left against right");
    SAHEL_CHECK_EQ(a, -5);
}

// --- coordinates
// -----------------------------------------------------------------------------------------------------------

TEST(CellRect, CoarsenedIsTheSmallestRectangleThatCovers) {
    for (int64_t x0 = -9; x0 <= 9; ++x0)
        for (int64_t x1 = x0 + 1; x1 <= 11; ++x1) {
            const CellRect fine{x0, -x1, x1, -x0};
            const CellRect coarse = fine.coarsened();
            for (int64_t x = x0; x < x1; ++x) {
                EXPECT_TRUE(coarse.contains(Cell{floor_div(x, 2), floor_div(-x1, 2)}));
            }
            EXPECT_EQ(coarse.x0, floor_div(x0, 2));
            EXPECT_EQ(coarse.x1, floor_div(x1 - 1, 2) + 1);
            EXPECT_EQ(coarse.y0, floor_div(-x1, 2));
            EXPECT_EQ(coarse.y1, floor_div(-x0 - 1, 2) + 1);
        }
}

TEST(CellRect, IntersectionAreaAndContainment) {
    const CellRect a{-10, -10, 10, 10};
    const CellRect b{5, 5, 20, 7};
    EXPECT_EQ(a.intersected(b), (CellRect{5, 5, 10, 7}));
    EXPECT_EQ(a.intersected(b).area(), 10);
    EXPECT_TRUE(a.intersected({10, 0, 12, 5}).empty());
    EXPECT_EQ(a.intersected({30, 30, 40, 40}).area(), 0);
    EXPECT_TRUE(a.contains(Cell{-10, 9}));
    EXPECT_FALSE(a.contains(Cell{10, 9}));
    EXPECT_TRUE(a.contains(CellRect{-10, -10, 10, 10}));
    EXPECT_FALSE(a.contains(b));
    EXPECT_EQ(a.grown(3).grown(-3), a);
    EXPECT_EQ(a.grown(2).area(), 24 * 24);
}

TEST(TileKey, AncestorsAndTilesFarAway) {
    const int64_t far = -4'000'000'000'000;
    const TileKey key = tile_of({far, -far}, 0, 2048);
    const CellRect rect = tile_rect(key, 2048);
    EXPECT_TRUE(rect.contains(Cell{far, -far}));
    for (int32_t level = 0; level <= 20; ++level) {
        const TileKey up = key.ancestor(level);
        EXPECT_EQ(up.level, level);
        EXPECT_EQ(up.x, floor_div(far, int64_t{2048} << level));
        EXPECT_EQ(up.y, floor_div(-far, int64_t{2048} << level));
    }
    EXPECT_EQ(key.ancestor(0), key);
#if defined(SAHEL_DEBUG)
    EXPECT_DEATH(static_cast<void>(key.parent().ancestor(0)), "shift >= 0");
#endif
}

TEST(TileKey, OrderIsLevelThenRowThenColumn) {
    const std::set<TileKey> keys{{1, 0, 0}, {0, 5, -1}, {0, -5, 3}, {0, 2, -1}};
    const std::vector<TileKey> listed(keys.begin(), keys.end());
    const std::vector<TileKey> expected{{0, 2, -1}, {0, 5, -1}, {0, -5, 3}, {1, 0, 0}};
    EXPECT_EQ(listed, expected);
}

TEST(TileKey, HashSpreadsNeighbours) {
    std::unordered_set<size_t> low_bits;
    for (int64_t y = -32; y < 32; ++y)
        for (int64_t x = -32; x < 32; ++x) low_bits.insert(std::hash<TileKey>{}(TileKey{0, x, y}) & 0xFFFF);
    EXPECT_GT(low_bits.size(), 3900u); // 4096 keys into 65536 places: 3972 expected of a random function
}

// --- layers
// ----------------------------------------------------------------------------------------------------------------

TEST(LayerSet, IsASetInTableOrder) {
    LayerSet set{Layer::water, Layer::bedrock};
    EXPECT_EQ(set.size(), 2);
    EXPECT_TRUE(set.contains(Layer::water));
    EXPECT_FALSE(set.contains(Layer::soil));
    std::vector<Layer> seen;
    set.for_each([&](Layer l) { seen.push_back(l); });
    EXPECT_EQ(seen, (std::vector<Layer>{Layer::bedrock, Layer::water}));
    set.insert(Layer::water);
    EXPECT_EQ(set.size(), 2);
    EXPECT_TRUE(k_surface_layers.contains(set));
    EXPECT_FALSE(set.contains(k_surface_layers));
    EXPECT_EQ(k_surface_layers.intersected(set), set);
    EXPECT_EQ(set.united(k_surface_layers), k_surface_layers);
    EXPECT_TRUE(k_weight_layers.intersected(k_state_layers).empty());
    EXPECT_TRUE(LayerSet().empty());
    for (const LayerInfo& info : k_layers)
        EXPECT_EQ(k_state_layers.contains(info.layer), (info.role == LayerRole::state)) << info.name;
}

TEST(Layers, NamesAreUniqueAndConservedAmountsAreTicks) {
    std::set<std::string_view> names;
    for (const LayerInfo& info : k_layers) {
        EXPECT_TRUE(names.insert(info.name).second) << info.name;
        EXPECT_FALSE(info.help.empty()) << info.name;
        EXPECT_TRUE(info.type != LayerType::ticks || (info.role == LayerRole::state)) << info.name;
        EXPECT_EQ(info.lod_filter == LodFilter::any_bit, info.type == LayerType::flags) << info.name;
    }
}

// --- memory and fields
// -----------------------------------------------------------------------------------------------------

TEST(MemoryPool, CountsExactlyFromSeveralThreads) {
    MemoryPool pool("threads", MemoryKind::host, 64 * 100);
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&] {
            for (int i = 0; i < 2000; ++i) {
                auto buffer = Buffer::allocate(pool, 64 * 40); // two fit, more do not
                if (buffer.ok()) static_cast<char*>(buffer->data())[0] = 1;
            }
        });
    for (auto& t : threads) t.join();
    EXPECT_EQ(pool.used_bytes(), 0u);
    EXPECT_LE(pool.peak_bytes(), pool.limit_bytes());
}

TEST(Buffer, MovesAndRefusesTheImpossible) {
    MemoryPool pool("moves", MemoryKind::host, 1u << 20);
    Buffer a = Buffer::allocate(pool, 100).value();
    EXPECT_EQ(reinterpret_cast<uintptr_t>(a.data()) % 64, 0u);
    void* const data = a.data();
    Buffer b = std::move(a);
    EXPECT_EQ(b.data(), data);
    EXPECT_EQ(pool.used_bytes(), 128u);
    b = Buffer::allocate(pool, 10).value();
    EXPECT_EQ(pool.used_bytes(), 64u);
    b.reset();
    EXPECT_TRUE(b.empty());
    EXPECT_EQ(pool.used_bytes(), 0u);
    EXPECT_EQ(Buffer::allocate(pool, std::numeric_limits<uint64_t>::max()).error().kind, ErrorKind::budget);
    EXPECT_TRUE(Buffer::allocate(pool, 0).value().empty());
}

TEST(MemoryPoolDeathTest, MustOutliveItsBuffers) {
    EXPECT_DEATH(
        {
            auto pool = std::make_unique<MemoryPool>("short lived", MemoryKind::host, 1000);
            const Buffer buffer = Buffer::allocate(*pool, 10).value();
            pool.reset();
        },
        "check failed");
}

TEST(LayerBlock, FreshMemoryIsPoisonedInDebugBuildsAndClearsToZero) {
    LayerBlock block = LayerBlock::allocate(0, {0, 0, 40, 30}, 2, {Layer::sand, Layer::dune}).value();
#if defined(SAHEL_DEBUG)
    EXPECT_EQ(block.ints(Layer::sand)(-2, -2), 0x7FA00000);
    EXPECT_EQ(block.ints(Layer::sand)(41, 31), 0x7FA00000);
    const float poisoned = block.reals(Layer::dune)(5, 5);
    EXPECT_NE(poisoned, poisoned);
#endif
    block.clear();
    EXPECT_EQ(block.ints(Layer::sand)(-2, -2), 0);
    EXPECT_EQ(block.reals(Layer::dune)(41, 31), 0.0f);
}

TEST(LayerBlock, RefusesMoreThanItsBudget) {
    MemoryPool pool("small", MemoryKind::host, 100000);
    const auto block = LayerBlock::allocate(0, {0, 0, 1000, 1000}, 2, {Layer::sand}, pool);
    ASSERT_FALSE(block.ok());
    EXPECT_EQ(block.error().kind, ErrorKind::budget);
    EXPECT_NE(block.error().message.find("small"), std::string::npos);
}

TEST(LayerBlock, RefusesWhatNoMachineCanAddress) {
    MemoryPool pool("any", MemoryKind::host, std::numeric_limits<uint64_t>::max());
    const CellRect huge{0, 0, int64_t{1} << 30, int64_t{1} << 30}; // times 16 bytes: 2^64
    const auto block = LayerBlock::allocate(0, huge, 0, k_surface_layers, pool);
    ASSERT_FALSE(block.ok());
    EXPECT_EQ(block.error().kind, ErrorKind::budget);
    EXPECT_EQ(pool.used_bytes(), 0u);
}

TEST(LayerBlockDeathTest, ViewsAreOfTheRightTypeAndLayer) {
    LayerBlock block = LayerBlock::allocate(0, {0, 0, 40, 30}, 2, {Layer::sand, Layer::dune}).value();
    EXPECT_DEATH(static_cast<void>(block.reals(Layer::sand)), "check failed");
    EXPECT_DEATH(static_cast<void>(block.ints(Layer::dune)), "check failed");
    EXPECT_DEATH(static_cast<void>(block.ints(Layer::water)), "check failed");
}

TEST(FieldViewDeathTest, BoundsAreCheckedInDebugBuilds) {
#if defined(SAHEL_DEBUG)
    LayerBlock block = LayerBlock::allocate(0, {0, 0, 40, 30}, 2, {Layer::sand}).value();
    const FieldView<const int32_t> view = block.ints(Layer::sand);
    EXPECT_DEATH(static_cast<void>(view(-3, 0)), "values -2 against -3");
    EXPECT_DEATH(static_cast<void>(view(42, 0)), "x < x1; values 42 against 42");
    EXPECT_DEATH(static_cast<void>(view(0, -3)), "check failed");
    EXPECT_DEATH(static_cast<void>(view(0, 32)), "check failed");
    EXPECT_EQ(view(-2, -2), 0x7FA00000);
#else
    GTEST_SKIP() << "bounds are checked in debug builds alone";
#endif
}

TEST(Ticks, EveryTickOfTheRangeReadsBackWhereAFloatCanTellTicksApart) {
    for (int32_t t = -(1 << 24); t <= (1 << 24); t += 257) ASSERT_EQ(ticks_of_metres(metres_of_ticks(t)), t);
    EXPECT_EQ(ticks_of_metres(16383.0f), 16383 * 131072);
    EXPECT_EQ(ticks_of_metres(-16383.0f), -16383 * 131072);
    EXPECT_EQ(ticks_of_metres(-0.0f), 0);
}

} // namespace
} // namespace sahel
