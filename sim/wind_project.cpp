#include "sim/wind_project.h"

#include "world/det_math.h"

#include <algorithm>
#include <cmath>

namespace sahel {

WindPlane WindProjection::plane(int32_t nx, int32_t ny) {
    memory_.emplace_back(static_cast<size_t>(WindPlane::floats(nx, ny)), 0.0f);
    return WindPlane::in(memory_.back().data(), nx, ny);
}

WindProjection::WindProjection(int32_t nx, int32_t ny, bool periodic_x, bool periodic_y) {
    // Corners along an axis of n cells: n where periodic, else the n - 1 inner ones.
    const auto corners = [](int32_t n, bool periodic) { return periodic ? n : n - 1; };
    if (corners(nx, periodic_x) <= 0 || corners(ny, periodic_y) <= 0) return;
    const WindRing ring_x = periodic_x ? WindRing::wrap : WindRing::zero;
    const WindRing ring_y = periodic_y ? WindRing::wrap : WindRing::zero;
    int32_t x = nx;
    int32_t y = ny;
    for (;;) {
        const int32_t cx = corners(x, periodic_x);
        const int32_t cy = corners(y, periodic_y);
        levels_.push_back({plane(cx, cy), plane(cx, cy), plane(cx, cy), plane(cx, cy), plane(cx, cy), ring_x, ring_y});
        if (x % 2 != 0 || y % 2 != 0 || x < 4 || y < 4) break;
        x /= 2;
        y /= 2;
    }
    // The least eigenvalue that is not 0, of 4 sin^2 (k/2) summed over the axes.
    const auto least = [](int32_t n, bool periodic) {
        const float s = det::sin(det::k_pi / static_cast<float>(periodic ? n : 2 * n));
        return 4.0f * s * s;
    };
    float low = 8.0f;
    if (periodic_x && periodic_y) {
        if (x > 1) low = std::min(low, least(x, true));
        if (y > 1) low = std::min(low, least(y, true));
    } else {
        low = (periodic_x ? 0.0f : least(x, false)) + (periodic_y ? 0.0f : least(y, false));
    }
    work_.coarsest_low = std::min(low, 4.0f);
    work_.coarsest_steps = 2 + static_cast<int32_t>(3.0f / std::sqrt(work_.coarsest_low)); // error below 1 %
    const WindPlane& finest = levels_.front().b;
    work_.q = plane(finest.nx, finest.ny);
    work_.d = plane(finest.nx, finest.ny);
    work_.ad = plane(finest.nx, finest.ny);
    work_.ring_x = periodic_x ? WindRing::wrap : WindRing::edge;
    work_.ring_y = periodic_y ? WindRing::wrap : WindRing::edge;
    row_sums_.resize(static_cast<size_t>(finest.ny));
    work_.most_iterations = k_most_iterations;
    work_.tolerance = k_tolerance;
}

WindProjection::Outcome WindProjection::run(WindPlane wind_x, WindPlane wind_y) {
    if (levels_.empty()) return {};
    work_.levels = levels_.data();
    work_.level_count = static_cast<int32_t>(levels_.size());
    work_.row_sums = row_sums_.data();
    work_.wind_x = wind_x;
    work_.wind_y = wind_y;
    SAHEL_ISA_CALL(run_project_wind, work_);
    return {work_.before, work_.after, work_.iterations};
}

} // namespace sahel
