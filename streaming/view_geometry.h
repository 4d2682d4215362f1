#pragma once

#include "streaming/streamer.h"

#include <algorithm>
#include <array>
#include <cmath>

/// Distances and frustum tests in world metres, in double: the only place where positions far from the origin matter.
namespace sahel {

inline constexpr double k_earth_radius_m = 6371000.0;

/// A square of ground with the range of heights over it.
struct GroundSquare {
    double x0, y0, side;
    double low, high;
};

/// Distance from the eye to the nearest point of the square; the vertical part is the eye's height above the ground.
inline double lod_distance2_m2(const ViewState& view, const GroundSquare& s) {
    const double x = s.x0 - view.eye_m[0], y = s.y0 - view.eye_m[1];
    const double dx = std::max({x, -(x + s.side), 0.0}), dy = std::max({y, -(y + s.side), 0.0});
    const double dz = view.eye_m[2] - view.ground_m;
    return dx * dx + dy * dy + dz * dz;
}
inline double lod_distance_m(const ViewState& view, const GroundSquare& square) {
    return std::sqrt(lod_distance2_m2(view, square));
}

/// The four side planes of a view, through the eye.
class Frustum {
  public:
    explicit Frustum(const ViewState& view);
    /// False only when the square (with the drop of the earth's curve) is outside for certain.
    [[nodiscard]] bool may_see(const GroundSquare& square) const;

  private:
    std::array<double, 3> eye_;
    std::array<std::array<double, 3>, 5> normals_; ///< inward; the last one is the view direction
};

} // namespace sahel
