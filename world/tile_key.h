#pragma once

#include "world/check.h"
#include "world/macros.h"

#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>

/// World coordinates. A cell is a pair of int64 at a level; level 0 cells have the world's cell size (1 m by default),
/// level k cells are 2^k times as wide. Cell (x, y) of level k covers the cells [2x, 2x+2) x [2y, 2y+2) of level k-1.
/// A tile is the square of `tile_cells` x `tile_cells` cells at key (level, x, y); negative keys are fine.
/// Axes: x to the east, y to the south (down in a map), z up.
namespace sahel {

/// Floor division and the matching remainder, for positive b.
SAHEL_HD constexpr int64_t floor_div(int64_t a, int64_t b) {
    return a / b - ((a % b != 0 && (a ^ b) < 0) ? 1 : 0);
}
SAHEL_HD constexpr int64_t floor_mod(int64_t a, int64_t b) {
    return a - floor_div(a, b) * b;
}

struct Cell {
    int64_t x = 0;
    int64_t y = 0;
    friend constexpr auto operator<=>(const Cell&, const Cell&) = default;
};

/// Cells [x0, x1) x [y0, y1) of one level.
struct CellRect {
    int64_t x0 = 0;
    int64_t y0 = 0;
    int64_t x1 = 0;
    int64_t y1 = 0;

    [[nodiscard]] constexpr int64_t width() const { return x1 - x0; }
    [[nodiscard]] constexpr int64_t height() const { return y1 - y0; }
    [[nodiscard]] constexpr bool empty() const { return x1 <= x0 || y1 <= y0; }
    [[nodiscard]] constexpr int64_t area() const { return empty() ? 0 : width() * height(); }
    [[nodiscard]] constexpr bool contains(Cell c) const { return c.x >= x0 && c.x < x1 && c.y >= y0 && c.y < y1; }
    [[nodiscard]] constexpr bool contains(const CellRect& r) const {
        return r.x0 >= x0 && r.x1 <= x1 && r.y0 >= y0 && r.y1 <= y1;
    }
    [[nodiscard]] constexpr CellRect grown(int64_t cells) const {
        return {x0 - cells, y0 - cells, x1 + cells, y1 + cells};
    }
    [[nodiscard]] constexpr CellRect intersected(const CellRect& r) const {
        return {std::max(x0, r.x0), std::max(y0, r.y0), std::min(x1, r.x1), std::min(y1, r.y1)};
    }
    /// The cells of the next coarser level that touch this rectangle.
    [[nodiscard]] constexpr CellRect coarsened() const { return {x0 >> 1, y0 >> 1, (x1 + 1) >> 1, (y1 + 1) >> 1}; }
    friend constexpr auto operator<=>(const CellRect&, const CellRect&) = default;
};

/// A node of the quadtree. Ordered by (level, y, x), so that sets of keys list row by row.
struct TileKey {
    int32_t level = 0;
    int64_t x = 0;
    int64_t y = 0;

    [[nodiscard]] constexpr TileKey parent() const { return {level + 1, x >> 1, y >> 1}; }
    /// Child 0..3: bit 0 is east, bit 1 is south.
    [[nodiscard]] constexpr TileKey child(int index) const {
        return {level - 1, 2 * x + (index & 1), 2 * y + (index >> 1)};
    }
    /// Which child of its parent this is, 0..3.
    [[nodiscard]] constexpr int child_index() const { return static_cast<int>((x & 1) | ((y & 1) << 1)); }
    /// The node of a level, not below this one's, that covers it.
    [[nodiscard]] constexpr TileKey ancestor(int32_t at_level) const {
        const int shift = at_level - level;
        SAHEL_DCHECK(shift >= 0 && shift < 64);
        return {at_level, x >> shift, y >> shift};
    }

    friend constexpr bool operator==(const TileKey&, const TileKey&) = default;
    friend constexpr std::strong_ordering operator<=>(const TileKey& a, const TileKey& b) {
        if (const auto c = a.level <=> b.level; std::is_neq(c)) return c;
        if (const auto c = a.y <=> b.y; std::is_neq(c)) return c;
        return a.x <=> b.x;
    }
};

/// The cells of a tile, at the tile's own level.
constexpr CellRect tile_rect(TileKey key, int64_t tile_cells) {
    return {key.x * tile_cells, key.y * tile_cells, (key.x + 1) * tile_cells, (key.y + 1) * tile_cells};
}

/// Keys that a file may name: levels 0 to 20, and no further out than 2^46 tiles of level 0, so that cells and half
/// metres of any of them are int64.
constexpr bool is_storable(TileKey key) {
    if (key.level < 0 || key.level > 20) return false;
    const int64_t most = (int64_t{1} << 46) >> key.level;
    return key.x >= -most && key.x < most && key.y >= -most && key.y < most;
}

/// The tile that owns a cell of the given level.
constexpr TileKey tile_of(Cell cell, int32_t level, int64_t tile_cells) {
    return {level, floor_div(cell.x, tile_cells), floor_div(cell.y, tile_cells)};
}

/// Calls f(TileKey) for every tile of a level that touches the rectangle, row by row.
template <class F> void for_each_tile(const CellRect& rect, int32_t level, int64_t tile_cells, F&& f) {
    if (rect.empty()) return;
    const TileKey first = tile_of({rect.x0, rect.y0}, level, tile_cells);
    const TileKey last = tile_of({rect.x1 - 1, rect.y1 - 1}, level, tile_cells);
    for (int64_t y = first.y; y <= last.y; ++y)
        for (int64_t x = first.x; x <= last.x; ++x) f(TileKey{level, x, y});
}

} // namespace sahel

template <> struct std::hash<sahel::TileKey> {
    size_t operator()(const sahel::TileKey& k) const noexcept {
        uint64_t h = static_cast<uint64_t>(k.x) * 0x9E3779B97F4A7C15ull;
        h ^= (h >> 29) ^ (static_cast<uint64_t>(k.y) * 0xBF58476D1CE4E5B9ull);
        h ^= (h >> 32) ^ (static_cast<uint64_t>(static_cast<uint32_t>(k.level)) * 0x94D049BB133111EBull);
        return static_cast<size_t>(h ^ (h >> 31));
    }
};
