#include "tools/experiments/taylor.h"

#include "sim/directions.h"

#include <array>

namespace sahel::experiments {

TaylorSlide::TaylorSlide(Plane height_m, double repose_tangent, double strength)
    : h_(std::move(height_m)), repose_(static_cast<float>(repose_tangent)), strength_(static_cast<float>(strength)) {
    next_ = h_;
}

void TaylorSlide::sweep() {
    next_ = h_;
    const auto cell = static_cast<float>(h_.cell_m);
    const std::array<float, 2> run = {cell, k_sqrt2 * cell};
    for (int32_t y = 0; y < h_.height; ++y)
        for (int32_t x = 0; x < h_.width; ++x) {
            const bool inside = x > 0 && y > 0 && x + 1 < h_.width && y + 1 < h_.height;
            const size_t at = static_cast<size_t>(y) * static_cast<size_t>(h_.width) + static_cast<size_t>(x);
            const float top = h_.values[at];
            std::array<size_t, k_direction_count> place{};
            std::array<float, k_direction_count> slope{};
            float steepest = repose_, sum = 0.0f, excess = 0.0f;
            for (int k = 0; k < k_direction_count; ++k) {
                place[static_cast<size_t>(k)] =
                    inside ? at + static_cast<size_t>(direction_x(k) + direction_y(k) * h_.width)
                           : h_.index(x + direction_x(k), y + direction_y(k));
                const float t = (top - h_.values[place[static_cast<size_t>(k)]]) / run[static_cast<size_t>(k & 1)];
                if (t <= repose_) continue;
                slope[static_cast<size_t>(k)] = t;
                sum += t;
                if (t > steepest) {
                    steepest = t;
                    excess = (t - repose_) * run[static_cast<size_t>(k & 1)];
                }
            }
            if (sum == 0.0f) continue;
            const float given = strength_ * excess;
            next_.values[at] -= given;
            for (size_t k = 0; k < slope.size(); ++k)
                if (slope[k] > 0.0f) next_.values[place[k]] += given * slope[k] / sum;
        }
    std::swap(h_, next_);
}

} // namespace sahel::experiments
