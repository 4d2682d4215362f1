#include "sim/avalanche_column.h"

#include "world/field.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace sahel {

Status fill_column(TileDomain& domain, const SandColumn& column) {
    const TileLayout& l = domain.layout();
    const int64_t n = l.tile_cells;
    const int64_t x0 = (l.tx0 * n + l.tx1 * n - column.width_cells) / 2;
    const int64_t y0 = (l.ty0 * n + l.ty1 * n - column.width_cells) / 2;
    const int32_t low = ticks_of_metres(column.sheet_m);
    const int32_t high = ticks_of_metres(column.sheet_m + column.height_m);
    SAHEL_TRY(domain.fill(SimLayer::bedrock, [](int64_t, int64_t) { return 0; }));
    SAHEL_TRY(domain.fill(SimLayer::soil, [](int64_t, int64_t) { return 0; }));
    SAHEL_TRY(domain.fill(SimLayer::repose, [&](int64_t, int64_t) { return column.repose; }));
    return domain.fill(SimLayer::sand, [&](int64_t x, int64_t y) {
        const bool in = x >= x0 && x < x0 + column.width_cells && y >= y0 && y < y0 + column.width_cells;
        return in ? high : low;
    });
}

HeapBounds heap_bounds(const SandColumn& column, double cell_m) {
    const double side = column.width_cells * cell_m;
    const double cubed = 3.0 * side * side * column.height_m * column.repose * column.repose;
    return {std::cbrt(cubed / (8.0 * std::tan(std::acos(-1.0) / 8.0))), std::cbrt(cubed / (2.0 * std::sqrt(2.0)))};
}

Result<HeapShape> heap_shape(TileDomain& domain, const SandColumn& column, double cell_m) {
    SAHEL_TRY(domain.exchange({SimLayer::sand}));
    HeapShape out;
    const SlabView<const int32_t> sand = std::as_const(domain).ints(SimLayer::sand);
    const int32_t n = domain.tile_cells();
    int32_t peak = 0;
    for (int32_t slot = 0; slot < domain.slots(); ++slot)
        for (int32_t y = 0; y < n; ++y)
            for (int32_t x = 0; x < n; ++x) peak = std::max(peak, sand(slot, x, y));
    out.peak_m = metres_of_ticks(peak);
    std::vector<double> flank;
    for (int32_t slot = 0; slot < domain.slots(); ++slot)
        for (int32_t y = 0; y < n; ++y)
            for (int32_t x = 0; x < n; ++x) {
                const int32_t h = sand(slot, x, y);
                double slope = 0.0;
                for (int k = 0; k < k_direction_count; ++k) {
                    const double drop = h - sand(slot, x + direction_x(k), y + direction_y(k));
                    slope = std::max(slope, drop / ((k & 1) != 0 ? std::sqrt(2.0) : 1.0));
                }
                slope /= double{k_ticks_per_m} * cell_m;
                out.steepest = std::max(out.steepest, slope);
                out.unstable += slope > double{column.repose} + 0.1 ? 1 : 0;
                const double above = metres_of_ticks(h) - double{column.sheet_m};
                if (above > 10.0 && metres_of_ticks(h) < out.peak_m - 5.0) flank.push_back(slope);
            }
    if (flank.empty()) return out;
    std::sort(flank.begin(), flank.end());
    const auto at = [&](double share) {
        return flank[static_cast<size_t>(share * static_cast<double>(flank.size() - 1))];
    };
    out.slope_p01 = at(0.01);
    out.slope_median = at(0.5);
    out.slope_p99 = at(0.99);
    return out;
}

} // namespace sahel
