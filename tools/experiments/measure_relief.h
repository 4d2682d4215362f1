#pragma once

#include "tools/experiments/plane.h"

#include <optional>

/// Numbers of a relief: slopes against the angle of repose, spread, cover, symmetry, roughness.
namespace sahel::experiments {

double mean_of(const Plane& plane);
double deviation_of(const Plane& plane); ///< standard deviation
float largest_of(const Plane& plane);
float least_of(const Plane& plane);
/// Pearson's correlation of two planes over the cells of the mask; 0 where one of them does not vary.
double correlation_of(const Plane& a, const Plane& b, const CellMask* mask = nullptr);
/// Share of cells with more than the threshold.
double coverage_of(const Plane& sand_m, double threshold_m);

/// Downward slopes to the eight neighbours, the steepest of each cell with sand, minus a tangent of repose.
struct SlopeExcess {
    double largest = 0.0;
    double p99 = 0.0; ///< 99 of 100 cells with sand are not above it
    double median = 0.0;
    double steepest_deg = 0.0; ///< the steepest slope of all
    int64_t cells = 0;         ///< cells with sand
    int64_t above_tenth = 0;   ///< of them steeper than repose by more than 0.1
};
SlopeExcess slope_excess(const Plane& height_m, const Plane& sand_m, double repose_tangent);
/// The same with a tangent for each cell.
SlopeExcess slope_excess(const Plane& height_m, const Plane& sand_m, const Plane& repose_tangent);

/// Greatest difference between a square plane and its seven images under the symmetries of the square about a point.
/// The point is given twice: 2 x centre, so that it may lie between cells.
double asymmetry8(const Plane& plane, int64_t twice_x, int64_t twice_y);

/// Heaps of one volume at repose. Eight directions hold up every shape between two octagonal pyramids: the lower one
/// (Desertscape method 5.3; H^3 = 3 V tan^2 / 3.3137) has faces towards the eight directions, the higher one
/// (2.8284) has edges there. Between them lies the cone of revolution (pi), which prefers no direction.
struct HeapHeights {
    double lower_octagon_m = 0.0;
    double cone_m = 0.0;
    double higher_octagon_m = 0.0;
};
HeapHeights heap_heights(double volume_m3, double repose_tangent);

/// Slopes along a direction where the ground rises and where it falls, each by its 95th percentile over the cells of
/// the mask: dunes under one wind rise gently and fall steeply.
struct SidesAlong {
    double rising = 0.0;  ///< m/m
    double falling = 0.0; ///< m/m
};
SidesAlong sides_along(const Plane& height_m, double angle_deg, const CellMask* mask = nullptr);

/// Ridges that run out from a peak: maxima of the height on a circle about it that stand above both valleys beside them
/// by more than the given share of the circle's relief.
int count_arms(const Plane& height_m, double x_m, double y_m, double radius_m, double share = 0.2);

/// Mean over a square of (2 r + 1) cells a side: what is left of the relief at scales above it.
Plane box_mean(const Plane& plane, int32_t radius_cells);

/// Roughness from cell to cell: mean absolute second difference across and along a wind that blows along x or y.
struct Roughness {
    double across_m = 0.0;
    double along_m = 0.0;
    int64_t cells = 0;
};
Roughness roughness_of(const Plane& sand_m, const CellMask& mask, bool wind_along_x = true);
/// The field of second differences across the wind, whose correlation from step to step shows oscillating ripples.
Plane second_difference_across(const Plane& sand_m, bool wind_along_x = true);

} // namespace sahel::experiments
