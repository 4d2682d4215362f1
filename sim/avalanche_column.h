#pragma once

#include "sim/tile_domain.h"
#include "world/result.h"

#include <cstdint>

/// The column of sand of the Desertscape paper (method 5.3) that collapses into a heap, and what is known of the heap.
///
/// A heap that stands at repose everywhere is not unique: slopes are held in eight directions, so that the gradient may
/// lie anywhere on a regular octagon around the circle of radius tau. Two heaps bound what can come out:
///
///     inscribed   gradient tau in each face: level lines are octagons whose sides face the eight directions.
///                 h = H - tau max(|x|, |y|, (|x| + |y|) / sqrt 2),          H^3 = 3 V tau^2 / (8 tan 22.5 deg)
///     steepest    every way down along rows and diagonals is at repose: octagons whose corners lie in the eight
///                 directions, faces of tau / cos 22.5 deg. No heap at rest can be higher.
///                 h = H - tau (max(|x|, |y|) + (sqrt 2 - 1) min(|x|, |y|)), H^3 = 3 V tau^2 / (2 sqrt 2)
///
/// For 100 x 100 cells of 1 m, 400 m high, at 33 degrees: H = 115.2 m and 121.4 m.
namespace sahel {

struct SandColumn {
    int32_t width_cells = 100;
    float height_m = 400.0f;
    float sheet_m = 2.0f;        ///< sand everywhere, under the column too
    float repose = 0.649407593f; ///< tangent of 33 degrees
};

/// Sets bedrock, soil (0), sand and repose of the whole domain; the column stands in the middle of its bounds.
Status fill_column(TileDomain& domain, const SandColumn& column);

struct HeapBounds {
    double inscribed_m = 0.0; ///< peaks above the sheet
    double steepest_m = 0.0;
};
HeapBounds heap_bounds(const SandColumn& column, double cell_m);

/// What a heap looks like, from owned cells; slopes are those of a cell towards the lowest of its eight neighbours.
struct HeapShape {
    double peak_m = 0.0;       ///< highest sand
    double steepest = 0.0;     ///< largest slope, m/m
    double slope_p01 = 0.0;    ///< of the cells of the flank, above the foot by 10 m and below the peak by 5 m:
    double slope_median = 0.0; ///< percentiles 1, 50, 99
    double slope_p99 = 0.0;
    int64_t unstable = 0; ///< cells steeper than repose by more than 0.1
};
/// For domains on the host; exchanges halos.
Result<HeapShape> heap_shape(TileDomain& domain, const SandColumn& column, double cell_m);

} // namespace sahel
