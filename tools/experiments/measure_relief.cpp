#include "tools/experiments/measure_relief.h"

#include "sim/directions.h"

#include <algorithm>
#include <array>

namespace sahel::experiments {

double mean_of(const Plane& plane) {
    double sum = 0.0;
    for (const float v : plane.values) sum += v;
    return plane.values.empty() ? 0.0 : sum / static_cast<double>(plane.values.size());
}

double deviation_of(const Plane& plane) {
    const double mean = mean_of(plane);
    double sum = 0.0;
    for (const float v : plane.values) sum += (v - mean) * (v - mean);
    return plane.values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(plane.values.size()));
}

float largest_of(const Plane& plane) {
    return plane.values.empty() ? 0.0f : *std::max_element(plane.values.begin(), plane.values.end());
}

float least_of(const Plane& plane) {
    return plane.values.empty() ? 0.0f : *std::min_element(plane.values.begin(), plane.values.end());
}

double correlation_of(const Plane& a, const Plane& b, const CellMask* mask) {
    SAHEL_CHECK(a.same_shape(b) && (!mask || mask->same_shape(a)));
    double n = 0.0, sa = 0.0, sb = 0.0, saa = 0.0, sbb = 0.0, sab = 0.0;
    for (size_t i = 0; i < a.values.size(); ++i) {
        if (mask && !mask->values[i]) continue;
        const double u = a.values[i];
        const double v = b.values[i];
        n += 1.0;
        sa += u;
        sb += v;
        saa += u * u;
        sbb += v * v;
        sab += u * v;
    }
    if (n < 2.0) return 0.0;
    const double va = saa - sa * sa / n;
    const double vb = sbb - sb * sb / n;
    return va > 0.0 && vb > 0.0 ? (sab - sa * sb / n) / std::sqrt(va * vb) : 0.0;
}

double coverage_of(const Plane& sand, double threshold_m) {
    int64_t covered = 0;
    for (const float s : sand.values) covered += s > static_cast<float>(threshold_m);
    return sand.values.empty() ? 0.0 : static_cast<double>(covered) / static_cast<double>(sand.values.size());
}

namespace {

template <class Repose> SlopeExcess slope_excess_of(const Plane& h, const Plane& sand, Repose&& repose) {
    SAHEL_CHECK(h.same_shape(sand));
    SlopeExcess out;
    std::vector<float> excess;
    double steepest = 0.0;
    for (int32_t y = 0; y < h.height; ++y)
        for (int32_t x = 0; x < h.width; ++x) {
            if (!(sand.at(x, y) > 0.0f)) continue;
            double slope = -1.0e9;
            for (int k = 0; k < k_direction_count; ++k) {
                const double run = (k & 1 ? std::sqrt(2.0) : 1.0) * h.cell_m;
                const double drop = double{h.at(x, y)} - double{h.at(x + direction_x(k), y + direction_y(k))};
                slope = std::max(slope, drop / run);
            }
            steepest = std::max(steepest, slope);
            const double over = slope - repose(x, y);
            excess.push_back(static_cast<float>(over));
            out.above_tenth += over > 0.1;
        }
    out.cells = static_cast<int64_t>(excess.size());
    out.steepest_deg = std::atan(steepest) * 180.0 / k_pi;
    if (excess.empty()) return out;
    std::sort(excess.begin(), excess.end());
    const auto quantile = [&](double q) {
        return excess[static_cast<size_t>(q * static_cast<double>(excess.size() - 1))];
    };
    out.largest = excess.back();
    out.p99 = quantile(0.99);
    out.median = quantile(0.5);
    return out;
}

} // namespace

SlopeExcess slope_excess(const Plane& h, const Plane& sand, double repose_tangent) {
    return slope_excess_of(h, sand, [=](int32_t, int32_t) { return repose_tangent; });
}

SlopeExcess slope_excess(const Plane& h, const Plane& sand, const Plane& repose) {
    return slope_excess_of(h, sand, [&](int32_t x, int32_t y) { return double{repose.at(x, y)}; });
}

double asymmetry8(const Plane& plane, int64_t twice_x, int64_t twice_y) {
    SAHEL_CHECK(plane.width == plane.height && ((twice_x ^ twice_y) & 1) == 0);
    double worst = 0.0;
    for (int64_t y = 0; y < plane.height; ++y)
        for (int64_t x = 0; x < plane.width; ++x) {
            const double v = plane.at(x, y);
            const int64_t px = 2 * x - twice_x; // place about the centre, doubled
            const int64_t py = 2 * y - twice_y;
            const std::array<std::array<int64_t, 2>, 3> images = {{{-px, py}, {px, -py}, {py, px}}};
            for (const auto& [ix, iy] : images) // these three make all eight
                worst = std::max(worst, std::abs(v - plane.at((ix + twice_x) / 2, (iy + twice_y) / 2)));
        }
    return worst;
}

HeapHeights heap_heights(double volume_m3, double repose_tangent) {
    const double cube = 3.0 * volume_m3 * repose_tangent * repose_tangent;
    const double around = 8.0 * (std::sqrt(2.0) - 1.0); // area of a regular octagon around the circle of radius 1
    const double within = 2.0 * std::sqrt(2.0);         // and of the one within it
    return {std::cbrt(cube / around), std::cbrt(cube / k_pi), std::cbrt(cube / within)};
}

SidesAlong sides_along(const Plane& h, double angle_deg, const CellMask* mask) {
    const Vec2 d = unit_of(angle_deg);
    std::vector<double> up, down;
    for (int32_t y = 0; y < h.height; ++y)
        for (int32_t x = 0; x < h.width; ++x) {
            if (mask && !mask->at(x, y)) continue;
            const double gx = (h.at(x + 1, y) - h.at(x - 1, y)) / (2.0 * h.cell_m);
            const double gy = (h.at(x, y + 1) - h.at(x, y - 1)) / (2.0 * h.cell_m);
            const double slope = gx * d.x + gy * d.y;
            (slope > 0.0 ? up : down).push_back(std::abs(slope));
        }
    const auto p95 = [](std::vector<double>& v) {
        if (v.empty()) return 0.0;
        const auto at = v.begin() + static_cast<ptrdiff_t>(0.95 * static_cast<double>(v.size() - 1));
        std::nth_element(v.begin(), at, v.end());
        return *at;
    };
    return {p95(up), p95(down)};
}

int count_arms(const Plane& h, double x_m, double y_m, double radius_m, double share) {
    constexpr int k_points = 180;
    std::vector<double> ring;
    for (int i = 0; i < k_points; ++i) {
        const Vec2 d = unit_of(i * 360.0 / k_points);
        ring.push_back(h.at(static_cast<int64_t>(std::floor((x_m + radius_m * d.x) / h.cell_m)),
                            static_cast<int64_t>(std::floor((y_m + radius_m * d.y) / h.cell_m))));
    }
    const auto [least, most] = std::minmax_element(ring.begin(), ring.end());
    const double step = share * (*most - *least);
    if (step <= 0.0) return 0;
    // Start in the lowest valley and count rises by more than the step that are followed by falls by more than it.
    const auto first = static_cast<int>(least - ring.begin());
    int arms = 0;
    bool rising = true;
    double extreme = *least;
    for (int i = 1; i <= k_points; ++i) {
        const double v = ring[static_cast<size_t>((first + i) % k_points)];
        if (rising) { // looking for a top above the last valley
            if (v > extreme + step)
                rising = false, extreme = v;
            else
                extreme = std::min(extreme, v);
        } else {
            if (v < extreme - step)
                rising = true, extreme = v, ++arms;
            else
                extreme = std::max(extreme, v);
        }
    }
    return arms;
}

Plane box_mean(const Plane& plane, int32_t radius) {
    Plane out = plane;
    const double weight = 1.0 / (2.0 * radius + 1.0);
    for (const bool along_x : {true, false}) {
        const Plane in = out;
        const int32_t lines = along_x ? plane.height : plane.width;
        const int32_t cells = along_x ? plane.width : plane.height;
        const auto at = [&](int32_t line, int64_t i) { return along_x ? in.at(i, line) : in.at(line, i); };
        for (int32_t line = 0; line < lines; ++line) {
            double sum = 0.0;
            for (int32_t i = -radius; i <= radius; ++i) sum += at(line, i);
            for (int32_t i = 0; i < cells; ++i) {
                (along_x ? out.at(i, line) : out.at(line, i)) = static_cast<float>(sum * weight);
                sum += double{at(line, i + radius + 1)} - double{at(line, i - radius)};
            }
        }
    }
    return out;
}

Plane second_difference_across(const Plane& sand, bool wind_along_x) {
    const int dx = wind_along_x ? 0 : 1;
    const int dy = wind_along_x ? 1 : 0;
    return Plane::made(sand.width, sand.height, sand.cell_m, [&](int32_t x, int32_t y) {
        return sand.at(x + dx, y + dy) - 2.0f * sand.at(x, y) + sand.at(x - dx, y - dy);
    });
}

Roughness roughness_of(const Plane& sand, const CellMask& mask, bool wind_along_x) {
    SAHEL_CHECK(mask.same_shape(sand));
    const Plane across = second_difference_across(sand, wind_along_x);
    const Plane along = second_difference_across(sand, !wind_along_x);
    Roughness out;
    for (size_t i = 0; i < sand.values.size(); ++i) {
        if (!mask.values[i]) continue;
        out.across_m += std::abs(across.values[i]);
        out.along_m += std::abs(along.values[i]);
        ++out.cells;
    }
    if (out.cells > 0) {
        out.across_m /= static_cast<double>(out.cells);
        out.along_m /= static_cast<double>(out.cells);
    }
    return out;
}

} // namespace sahel::experiments
