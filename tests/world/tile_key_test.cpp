#include "world/field.h"
#include "world/tile_key.h"

#include <gtest/gtest.h>

#include <set>

namespace sahel {
namespace {

TEST(TileKey, FloorDivisionRoundsDownOnBothSidesOfZero) {
    for (int64_t b : {1, 2, 3, 512})
        for (int64_t a = -2000; a <= 2000; ++a) {
            const int64_t q = floor_div(a, b);
            EXPECT_LE(q * b, a);
            EXPECT_GT((q + 1) * b, a);
            EXPECT_EQ(floor_mod(a, b), a - q * b);
        }
}

TEST(TileKey, ChildrenAndParentsAgreeAlsoAtNegativeKeys) {
    for (int64_t y = -5; y <= 5; ++y)
        for (int64_t x = -5; x <= 5; ++x)
            for (int i = 0; i < 4; ++i) {
                const TileKey key{3, x, y};
                const TileKey child = key.child(i);
                EXPECT_EQ(child.parent(), key);
                EXPECT_EQ(child.child_index(), i);
                EXPECT_EQ(child.ancestor(5), key.ancestor(5));
            }
}

TEST(TileKey, TilesOfARectangleCoverItOnce) {
    const CellRect rect{-700, -5, 900, 600};
    std::set<TileKey> keys;
    int64_t area = 0;
    for_each_tile(rect, 0, 256, [&](TileKey key) {
        EXPECT_TRUE(keys.insert(key).second);
        area += tile_rect(key, 256).intersected(rect).area();
    });
    EXPECT_EQ(area, rect.area());
    EXPECT_EQ(keys.size(), 7u * 4u);
}

TEST(LayerBlock, ColumnsDoNotOverlapAndHaloIsReachable) {
    auto block = LayerBlock::allocate(0, {0, 0, 32, 16}, 3, k_surface_layers);
    ASSERT_TRUE(block.ok());
    EXPECT_EQ(block->bytes(), LayerBlock::bytes_needed({0, 0, 32, 16}, 3, k_surface_layers));
    int32_t value = 0;
    k_surface_layers.for_each([&](Layer l) {
        auto view = block->ints(l);
        for (int y = view.y0; y < view.y1; ++y)
            for (int x = view.x0; x < view.x1; ++x) view(x, y) = value++;
    });
    int32_t expected = 0;
    k_surface_layers.for_each([&](Layer l) {
        auto view = block->ints(l);
        for (int y = view.y0; y < view.y1; ++y)
            for (int x = view.x0; x < view.x1; ++x) ASSERT_EQ(view(x, y), expected++);
    });
}

TEST(MemoryPool, RefusesWhatExceedsItsLimitAndCountsExactly) {
    MemoryPool pool("test", MemoryKind::host, 4096);
    {
        auto a = Buffer::allocate(pool, 4000);
        ASSERT_TRUE(a.ok());
        EXPECT_EQ(pool.used_bytes(), 4032u); // 63 cache lines
        auto b = Buffer::allocate(pool, 65);
        ASSERT_FALSE(b.ok());
        EXPECT_EQ(b.error().kind, ErrorKind::budget);
        auto c = Buffer::allocate(pool, 64);
        EXPECT_TRUE(c.ok());
    }
    EXPECT_EQ(pool.used_bytes(), 0u);
    EXPECT_EQ(pool.peak_bytes(), 4096u);
}

TEST(Ticks, RoundToTheNearestOnBothSidesOfZero) {
    for (int32_t t : {-2000000000, -131072, -1, 0, 1, 7, 131072})
        EXPECT_EQ(ticks_of_metres(metres_of_ticks(t)), static_cast<int32_t>(static_cast<float>(t)));
    EXPECT_EQ(ticks_of_metres(0.75f * k_m_per_tick), 1);
    EXPECT_EQ(ticks_of_metres(-0.75f * k_m_per_tick), -1);
}

} // namespace
} // namespace sahel
