#pragma once

#include "streaming/streamer.h"

#include <array>

/// Distances and frustum tests in world metres, in double: the only place where positions far from the origin matter.
namespace sahel {

inline constexpr double k_earth_radius_m = 6371000.0;

/// A square of ground with the range of heights over it.
struct GroundSquare {
    double x0, y0, side;
    double low, high;
};

/// Distance from the eye to the nearest point of the square; the vertical part is the eye's height above the ground.
double lod_distance_m(const ViewState& view, const GroundSquare& square);

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
