#include "sim/wind_smooth.h"

#include "world/det_math.h"

#include <algorithm>
#include <cmath>

namespace sahel {

namespace {

constexpr double k_least_sigma = 4.0; // cells, on the level of the convolution

SmoothAxis plan_axis(int32_t cells, bool periodic, double sigma, std::vector<float>& weights) {
    SmoothAxis axis{cells, 0, 0, periodic, nullptr};
    int32_t n = cells;
    double s = sigma;
    while (n % 2 == 0 && n >= 4 && s >= 2.0 * k_least_sigma) {
        n /= 2;
        s /= 2.0;
        ++axis.levels;
    }
    const double share = std::ldexp(1.0, -2 * axis.levels); // variance on this level of one cell squared of level 0
    s = std::sqrt(s * s - 0.5 * (1.0 - share));
    s = std::min(s, 2.0 * n); // all is the mean then, to a few parts of a thousand million
    axis.radius = s > 0.0 ? static_cast<int32_t>(std::ceil(4.5 * s)) : 0;
    std::vector<double> w;
    double sum = 0.0;
    for (int32_t i = 0; i <= axis.radius; ++i) {
        w.push_back(i == 0 ? 1.0 : static_cast<double>(det::exp(static_cast<float>(-0.5 * i * i / (s * s)))));
        sum += i == 0 ? w[0] : 2.0 * w.back();
    }
    weights.clear();
    for (const double v : w) weights.push_back(static_cast<float>(v / sum));
    return axis;
}

} // namespace

GaussianSmoother::GaussianSmoother(int32_t nx, int32_t ny, bool periodic_x, bool periodic_y, double sigma_cells) {
    work_.x = plan_axis(nx, periodic_x, sigma_cells, weights_x_);
    work_.y = plan_axis(ny, periodic_y, sigma_cells, weights_y_);
    const auto cells = static_cast<size_t>(nx) * static_cast<size_t>(ny);
    a_.resize(cells);
    b_.resize(cells);
    rows_.resize(static_cast<size_t>((nx >> work_.x.levels) + 2 * work_.x.radius) *
                 static_cast<size_t>(ny >> work_.y.levels));
}

void GaussianSmoother::run(const float* in, float* out) {
    SmoothWork work = work_;
    work.x.weights = weights_x_.data();
    work.y.weights = weights_y_.data();
    work.in = in;
    work.out = out;
    work.a = a_.data();
    work.b = b_.data();
    work.rows = rows_.data();
    SAHEL_ISA_CALL(run_smooth_wind, work);
}

} // namespace sahel
