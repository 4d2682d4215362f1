#include "streaming/view_geometry.h"

#include <algorithm>
#include <cmath>

namespace sahel {

namespace {

using Vec = std::array<double, 3>;
Vec cross(const Vec& a, const Vec& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Vec& a, const Vec& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec unit(const Vec& a) {
    const double l = std::sqrt(dot(a, a));
    return l > 0.0 ? Vec{a[0] / l, a[1] / l, a[2] / l} : Vec{0.0, 1.0, 0.0};
}

} // namespace

Frustum::Frustum(const ViewState& view) : eye_(view.eye_m) {
    const Vec forward = unit(view.forward);
    // x east, y south, z up are left-handed, so this may point left: only the pair of both signs matters.
    const Vec side = cross(forward, unit(view.up));
    const Vec right = unit(side);
    const Vec up = unit(cross(right, forward));
    // Wider by a pixel at each edge: sub-pixel jitter must not show what was culled.
    double tan_v = std::tan(0.5 * view.vertical_fov_rad) * (1.0 + 2.0 / std::max(1, view.viewport_height_px));
    double tan_h = tan_v * view.aspect;
    if (dot(side, side) < 1e-12) tan_v = tan_h = std::hypot(tan_v, tan_h); // no roll is given: cover all of them
    const auto plane = [&](const Vec& axis, double tangent, double sign) {
        return unit({forward[0] * tangent + sign * axis[0], forward[1] * tangent + sign * axis[1],
                     forward[2] * tangent + sign * axis[2]});
    };
    normals_ = {plane(right, tan_h, 1.0), plane(right, tan_h, -1.0), plane(up, tan_v, 1.0), plane(up, tan_v, -1.0),
                forward};
}

bool Frustum::may_see(const GroundSquare& s) const {
    const double x0 = s.x0 - eye_[0], x1 = x0 + s.side, y0 = s.y0 - eye_[1], y1 = y0 + s.side;
    const double near_x = std::max({x0, -x1, 0.0}), near_y = std::max({y0, -y1, 0.0});
    const double far_x = std::max(std::abs(x0), std::abs(x1)), far_y = std::max(std::abs(y0), std::abs(y1));
    const double high = s.high - eye_[2] - (near_x * near_x + near_y * near_y) / (2.0 * k_earth_radius_m);
    const double low = s.low - eye_[2] - (far_x * far_x + far_y * far_y) / (2.0 * k_earth_radius_m);
    for (const auto& n : normals_) {
        const double d =
            n[0] * (n[0] > 0.0 ? x1 : x0) + n[1] * (n[1] > 0.0 ? y1 : y0) + n[2] * (n[2] > 0.0 ? high : low);
        if (d < 0.0) return false;
    }
    return true;
}

} // namespace sahel
