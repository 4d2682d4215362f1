#pragma once

#include <array>
#include <vector>

/// A smooth curve through points at given times.
///
/// The shape is a centripetal Catmull-Rom spline (Barry and Goldman 1988), with knots at the square root of the chord,
/// so that close points make no loops (Yuksel et al. 2011). Time runs along it by a monotone cubic (Fritsch and Carlson
/// 1980). So the shape does not depend on the times, and position and velocity are continuous.
namespace sahel {

class SplineCurve {
  public:
    using Point = std::array<double, 3>;

    SplineCurve() = default;
    /// Two points or more; times rise. `ease`: at rest at both ends.
    SplineCurve(std::vector<double> times, std::vector<Point> points, bool ease);

    /// The point at a time; times outside give the ends. `velocity`, if given, becomes d(point)/d(time).
    [[nodiscard]] Point at(double time, Point* velocity = nullptr) const;

  private:
    std::vector<double> times_;
    std::vector<double> knots_;
    std::vector<double> knot_speed_; ///< d(knot)/d(time) at each point
    std::vector<Point> points_;
    std::vector<Point> tangents_; ///< d(point)/d(knot)
};

} // namespace sahel
