#pragma once

#include "tools/experiments/plane.h"

#include <array>
#include <optional>

/// Dunes as objects: patches of sand on a periodic plane, their shape, and their way from one time to another.
namespace sahel::experiments {

/// A connected patch. Cells and centre are given without the seam: a patch that crosses it goes on beyond the plane.
struct Dune {
    std::vector<std::array<int32_t, 2>> cells; ///< x, y; not wrapped
    bool spans = false;                        ///< it closes around the plane: length and width mean nothing
    double area_m2 = 0.0;
    double volume_m3 = 0.0;
    double height_m = 0.0; ///< greatest thickness of sand
    double x_m = 0.0;      ///< centre of volume, within the plane
    double y_m = 0.0;
    double centre_x_m = 0.0; ///< the same where the cells are: may lie beyond the plane
    double centre_y_m = 0.0;
};

/// Patches of sand thicker than the threshold (neighbours by a side or a corner), largest first; none below the area.
std::vector<Dune> find_dunes(const Plane& sand_m, double threshold_m, double least_area_m2 = 0.0);

/// Extent along and across a direction, each the span of the cells.
struct DuneExtent {
    double length_m = 0.0;
    double width_m = 0.0;
};
DuneExtent extent_of(const Dune& dune, const Plane& sand_m, double angle_deg);

/// The shape of a patch under a wind:
///
///        |  left horn  ___          The downwind edge of three bands across the wind. A barchan's edge lies furthest
///     ___|___________ /             downwind in the outer bands: there its horns end. `horn_m` is how far they reach
///    |    middle     |              beyond the edge of the middle; negative: the middle leads, as in a heap or a
///     ---|------------\___          parabolic dune.
///        |  right horn
///
/// Slopes: of the mean profile of the middle band, from its windward foot to its highest point and from there to its
/// lee edge.
struct BarchanShape {
    double left_horn_m = 0.0;
    double right_horn_m = 0.0;
    double windward_slope = 0.0; ///< m/m, mean
    double lee_slope = 0.0;      ///< m/m, steepest over one cell
    /// Both horns reach downwind, and the windward slope is the gentler.
    [[nodiscard]] bool is_barchan() const {
        return left_horn_m > 0.0 && right_horn_m > 0.0 && windward_slope < lee_slope;
    }
};
BarchanShape barchan_shape(const Dune& dune, const Plane& sand_m, double wind_deg);

/// One dune at two times.
struct DuneTrack {
    size_t before = 0; ///< indices into the two lists
    size_t after = 0;
    double shift_x_m = 0.0;
    double shift_y_m = 0.0;
};
struct TrackOptions {
    double reach_m = 50.0;     ///< no dune moves further
    double volume_ratio = 1.3; ///< nor changes its volume by more than this factor
    double expect_x_m = 0.0;   ///< shift to look for first
    double expect_y_m = 0.0;
};
/// Pairs of dunes, nearest first, each used once; a dune that spans the plane is left out. Works across the seams.
std::vector<DuneTrack> track_dunes(const std::vector<Dune>& before, const std::vector<Dune>& after, const Plane& plane,
                                   const TrackOptions& options);

/// y = a x^slope through points, by least squares of the logarithms.
struct LogFit {
    double slope = 0.0;
    double intercept = 0.0;   ///< natural logarithm of a
    double slope_error = 0.0; ///< standard error
    int count = 0;
};
/// Points with a value that is not above 0 are left out; nothing below three points or without spread in x.
std::optional<LogFit> fit_log_log(const std::vector<Vec2>& points);

} // namespace sahel::experiments
