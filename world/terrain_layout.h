#pragma once

#include "world/macros.h"
#include "world/terrain_rows.h"
#include "world/tile_key.h"

#include <algorithm>
#include <cstdint>

/// Where the lattices of the base terrain lie for a rectangle of cells.
///
///     level   nodes              middle pass        cells
///     0, 1    every 16 m         every 4 m          2^level m        cells  <- spline <- middle <- spline <- nodes
///     2, 3    every 16 m         at the cells                        cells  <- spline ------------- nodes
///     4 ..    at the cells       at the cells                        no spline
///
/// Spline nodes lie at multiples of their spacing from the world's origin; cells at their centres.
namespace sahel {

/// One axis of a lattice of samples: number i lies at `half_m * i + shift_half_m` half metres.
struct LatticeAxis {
    int64_t first = 0; ///< number of array element 0
    int32_t count = 0;
};

inline constexpr int32_t k_nodes_per_sum = 4;

struct TerrainLayout {
    int32_t level = 0;
    CellRect rect;
    int32_t cells_per_node = 1, cells_per_mid = 1; ///< along one axis; 1: no spline
    int64_t node_half_m = 2, node_shift_half_m = 0;
    int32_t node_zero_bits = 0;
    float node_m = 1.0f, mid_m = 1.0f, cell_m = 1.0f;
    LatticeAxis sum_x, sum_y, node_x, node_y, mid_x, mid_y;

    SAHEL_HD bool has_spline() const { return cells_per_node > 1; }
    SAHEL_HD bool has_mid_spline() const { return cells_per_mid > 1; }
    /// Octaves of at least this size are summed at every fourth node: some six samples each, and more where they have
    /// ridges that would lose their edge.
    SAHEL_HD float sum_limit_m() const { return (level < 6 ? 24.0f : 40.0f) * node_m; }
    SAHEL_HD float ridged_sum_limit_m() const { return (level < 6 ? 24.0f : 64.0f) * node_m; }
    SAHEL_HD float warp_limit_m() const { return 24.0f * node_m; }
    SAHEL_HD float sum_offset() const { return node_shift_half_m != 0 ? 0.5f : 0.0f; }
    [[nodiscard]] SAHEL_HD SampleRow sum_row(int32_t y, int32_t x = 0) const {
        const int64_t half_m = k_nodes_per_sum * node_half_m;
        return {(sum_x.first + x) * half_m, (sum_y.first + y) * half_m, half_m, node_zero_bits + 2};
    }
    [[nodiscard]] SAHEL_HD SampleRow node_row(int32_t y, int32_t x = 0) const {
        return {(node_x.first + x) * node_half_m + node_shift_half_m,
                (node_y.first + y) * node_half_m + node_shift_half_m, node_half_m, node_zero_bits};
    }
    [[nodiscard]] SAHEL_HD SampleRow mid_row(int32_t y, int32_t x = 0) const {
        return {(mid_x.first + x) * 8, (mid_y.first + y) * 8, 8, 3};
    }
    [[nodiscard]] SAHEL_HD SampleRow cell_row(int32_t y, int32_t x = 0) const {
        const int64_t unit = int64_t{1} << level;
        return {(2 * (rect.x0 + x) + 1) * unit, (2 * (rect.y0 + y) + 1) * unit, 2 * unit, level};
    }
};

inline constexpr int32_t k_node_spacing_m = 16;
inline constexpr int32_t k_mid_spacing_m = 4;
inline constexpr int32_t k_mids_per_node = k_node_spacing_m / k_mid_spacing_m;
inline constexpr int32_t k_spline_margin = 2; ///< nodes around those the spline reads: slopes, sharpening

inline constexpr int32_t k_mid_margin = 1; ///< the same of the middle pass: sharpening

/// World half metres in which the nodes of a rectangle of cells lie: up to five spacings outside of it.
inline CellRect node_reach_half_m(const CellRect& rect, int32_t level) {
    const int64_t unit = int64_t{2} << level;
    return CellRect{rect.x0 * unit, rect.y0 * unit, rect.x1 * unit, rect.y1 * unit}.grown(
        5 * std::max(unit, int64_t{2 * k_node_spacing_m}));
}

/// The sums that nodes need: four taps and one more on each side for sharpening.
inline LatticeAxis sum_axis(const LatticeAxis& node) {
    const int64_t first = floor_div(node.first, k_nodes_per_sum) - 2;
    const int64_t last = floor_div(node.first + node.count - 1, k_nodes_per_sum) + 3;
    return {first, static_cast<int32_t>(last - first + 1)};
}

inline TerrainLayout make_terrain_layout(const CellRect& rect, int32_t level) {
    TerrainLayout l;
    l.level = level;
    l.rect = rect;
    l.cell_m = static_cast<float>(int64_t{1} << level);
    l.mid_m = l.cell_m;
    if (level >= 4) {
        l.node_half_m = int64_t{2} << level;
        l.node_shift_half_m = int64_t{1} << level;
        l.node_zero_bits = level;
        l.node_m = l.cell_m;
        l.node_x = {rect.x0 - 1, static_cast<int32_t>(rect.width()) + 2};
        l.node_y = {rect.y0 - 1, static_cast<int32_t>(rect.height()) + 2};
        l.sum_x = sum_axis(l.node_x);
        l.sum_y = sum_axis(l.node_y);
        return l;
    }
    l.cells_per_node = k_node_spacing_m >> level;
    l.node_half_m = 2 * k_node_spacing_m;
    l.node_zero_bits = 5;
    l.node_m = static_cast<float>(k_node_spacing_m);
    const auto axes = [&](int64_t c0, int64_t c1, LatticeAxis& node, LatticeAxis& mid) {
        int64_t first = floor_div(c0, l.cells_per_node), last = floor_div(c1 - 1, l.cells_per_node);
        if (level < 2) {
            l.cells_per_mid = k_mid_spacing_m >> level;
            const int64_t mid_first = floor_div(c0, l.cells_per_mid) - 1 - k_mid_margin;
            const int64_t mid_last = floor_div(c1 - 1, l.cells_per_mid) + 2 + k_mid_margin;
            mid = {mid_first, static_cast<int32_t>(mid_last - mid_first + 1)};
            first = floor_div(mid_first, k_mids_per_node);
            last = floor_div(mid_last, k_mids_per_node);
        }
        node.first = first - 1 - k_spline_margin;
        node.count = static_cast<int32_t>(last - first + 1 + 3 + 2 * k_spline_margin);
    };
    axes(rect.x0, rect.x1, l.node_x, l.mid_x);
    axes(rect.y0, rect.y1, l.node_y, l.mid_y);
    l.sum_x = sum_axis(l.node_x);
    l.sum_y = sum_axis(l.node_y);
    if (l.has_mid_spline()) l.mid_m = static_cast<float>(k_mid_spacing_m);
    return l;
}

inline SumRange coarse_range(const TerrainLayout& l) {
    SumRange range;
    range.smooth.min_m = l.sum_limit_m();
    range.ridged.min_m = l.ridged_sum_limit_m();
    range.warp.min_m = l.warp_limit_m();
    return range;
}
/// What is left for the nodes.
inline SumRange node_range(const TerrainLayout& l) {
    SumRange range;
    range.smooth.max_m = l.sum_limit_m();
    range.ridged.max_m = l.ridged_sum_limit_m();
    range.warp.max_m = l.warp_limit_m();
    range.start = false;
    return range;
}

/// One axis of a spline: sample `i` between lattice elements `at` .. `at + 3` (of an array that starts at `first`).
struct SplinePlace {
    int32_t at;
    float f;
};
SAHEL_HD SplinePlace spline_place(int64_t sample, int32_t per_interval, float offset, int64_t first) {
    const int64_t interval = floor_div(sample, per_interval);
    const auto e = static_cast<float>(sample - interval * per_interval);
    return {static_cast<int32_t>(interval - 1 - first), (e + offset) * (1.0f / static_cast<float>(per_interval))};
}

} // namespace sahel
