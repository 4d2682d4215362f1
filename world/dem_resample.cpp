#include "world/dem_resample.h"

#include "world/layers.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace sahel {

namespace {

double cubic(double x) {
    x = std::abs(x);
    if (x < 1.0) return (1.5 * x - 2.5) * x * x + 1.0;
    if (x < 2.0) return ((-0.5 * x + 2.5) * x - 4.0) * x + 2.0;
    return 0.0;
}
double triangle(double x) {
    return std::max(0.0, 1.0 - std::abs(x));
}

/// Weights of consecutive samples first, first + 1, ... around a position.
struct Taps {
    int64_t first = 0;
    std::vector<double> weight;

    template <class Kernel> void around(double at, double filter, double radius, Kernel kernel) {
        weight.clear();
        const double nearest = std::round(at);
        if (filter == 1.0 && std::abs(at - nearest) < 1e-6) { // a sample's centre: that sample and nothing else
            first = static_cast<int64_t>(nearest);
            weight.push_back(1.0);
            return;
        }
        first = static_cast<int64_t>(std::ceil(at - radius * filter));
        const auto last = static_cast<int64_t>(std::floor(at + radius * filter));
        double sum = 0.0;
        for (int64_t k = first; k <= last; ++k) {
            weight.push_back(kernel((static_cast<double>(k) - at) / filter));
            sum += weight.back();
        }
        for (double& w : weight) w /= sum;
    }
};

struct Window {
    CellRect rect;
    std::vector<double> samples;

    [[nodiscard]] double at(int64_t x, int64_t y) const {
        if (!rect.contains(Cell{x, y})) return std::numeric_limits<double>::quiet_NaN();
        return samples[static_cast<size_t>((y - rect.y0) * rect.width() + (x - rect.x0))];
    }
};

double weighted(const Window& window, const Taps& tx, const Taps& ty) {
    const CellRect need{tx.first, ty.first, tx.first + static_cast<int64_t>(tx.weight.size()),
                        ty.first + static_cast<int64_t>(ty.weight.size())};
    if (!window.rect.contains(need)) return std::numeric_limits<double>::quiet_NaN();
    double sum = 0.0;
    for (size_t j = 0; j < ty.weight.size(); ++j) {
        const double* row = &window.samples[static_cast<size_t>(
            (need.y0 + static_cast<int64_t>(j) - window.rect.y0) * window.rect.width() + (need.x0 - window.rect.x0))];
        double line = 0.0;
        for (size_t i = 0; i < tx.weight.size(); ++i) line += tx.weight[i] * row[i];
        sum += ty.weight[j] * line;
    }
    return sum;
}

/// Mean of the samples that exist; NaN if they hold less than half of the weight.
double mean_of_present(const Window& window, const Taps& tx, const Taps& ty) {
    double sum = 0.0, present = 0.0;
    for (size_t j = 0; j < ty.weight.size(); ++j)
        for (size_t i = 0; i < tx.weight.size(); ++i) {
            const double h = window.at(tx.first + static_cast<int64_t>(i), ty.first + static_cast<int64_t>(j));
            if (std::isnan(h)) continue;
            const double w = tx.weight[i] * ty.weight[j];
            sum += w * h;
            present += w;
        }
    return present >= 0.5 - 1e-9 ? sum / present : std::numeric_limits<double>::quiet_NaN();
}

int32_t to_ticks(double metres) {
    constexpr double limit = 2147483647.0;
    return static_cast<int32_t>(std::llround(std::clamp(metres * static_cast<double>(k_ticks_per_m), -limit, limit)));
}

struct Resampler {
    DemMosaic& mosaic;
    double datum_m;
    uint64_t window_bytes;
    CellRect all;
    int32_t* ticks;
    DemMask* mask;

    Status run(size_t sheet, const CellRect& cells);
};

Status Resampler::run(size_t sheet, const CellRect& cells) {
    const auto count = static_cast<size_t>(cells.area());
    std::vector<double> u(count), v(count);
    mosaic.map(sheet, cells, u.data(), v.data());
    double u0 = 1e300, u1 = -1e300, v0 = 1e300, v1 = -1e300;
    for (size_t i = 0; i < count; ++i) {
        if (std::isnan(u[i]) || std::isnan(v[i])) continue;
        u0 = std::min(u0, u[i]);
        u1 = std::max(u1, u[i]);
        v0 = std::min(v0, v[i]);
        v1 = std::max(v1, v[i]);
    }
    if (u0 > u1) return {};
    const double fx = mosaic.filter_x(sheet), fy = mosaic.filter_y(sheet);
    const auto w = static_cast<double>(mosaic.sheet_width(sheet)), h = static_cast<double>(mosaic.sheet_height(sheet));
    if (u1 < 0 || v1 < 0 || u0 >= w || v0 >= h) return {};
    Window window;
    window.rect = {static_cast<int64_t>(std::floor(std::clamp(u0 - 0.5 - 2 * fx, 0.0, w - 1))),
                   static_cast<int64_t>(std::floor(std::clamp(v0 - 0.5 - 2 * fy, 0.0, h - 1))),
                   static_cast<int64_t>(std::floor(std::clamp(u1 - 0.5 + 2 * fx + 1, 0.0, w - 1))) + 1,
                   static_cast<int64_t>(std::floor(std::clamp(v1 - 0.5 + 2 * fy + 1, 0.0, h - 1))) + 1};
    if (static_cast<double>(window.rect.area()) * 8.0 > static_cast<double>(window_bytes) && cells.area() > 256) {
        CellRect a = cells, b = cells;
        if (cells.width() >= cells.height())
            a.x1 = b.x0 = (cells.x0 + cells.x1) / 2;
        else
            a.y1 = b.y0 = (cells.y0 + cells.y1) / 2;
        u = {};
        v = {};
        SAHEL_TRY(run(sheet, a));
        return run(sheet, b);
    }
    const std::vector<CellRect> covered = mosaic.covered(sheet, window.rect);
    if (covered.empty()) return {};
    window.samples.resize(static_cast<size_t>(window.rect.area()));
    SAHEL_TRY(mosaic.read(sheet, window.rect, window.samples.data()));

    const int64_t width = cells.width();
    tbb::parallel_for(int64_t{0}, cells.height(), [&](int64_t j) {
        Taps tx, ty;
        const int64_t line = (cells.y0 + j - all.y0) * all.width() + (cells.x0 - all.x0);
        for (int64_t i = 0; i < width; ++i) {
            DemMask& m = mask[line + i];
            if (m == 0) continue; // a better sheet has it
            const double x = u[static_cast<size_t>(j * width + i)], y = v[static_cast<size_t>(j * width + i)];
            if (!(x >= -1e-6 && y >= -1e-6 && x <= w + 1e-6 && y <= h + 1e-6)) continue;
            const Cell under{
                std::clamp(static_cast<int64_t>(std::floor(x)), int64_t{0}, mosaic.sheet_width(sheet) - 1),
                std::clamp(static_cast<int64_t>(std::floor(y)), int64_t{0}, mosaic.sheet_height(sheet) - 1)};
            if (std::none_of(covered.begin(), covered.end(), [&](const CellRect& c) { return c.contains(under); }))
                continue;
            m = static_cast<DemMask>(k_mask_filled);
            tx.around(x - 0.5, fx, 2.0, cubic);
            ty.around(y - 0.5, fy, 2.0, cubic);
            double height = weighted(window, tx, ty);
            if (std::isnan(height)) {
                tx.around(x - 0.5, fx, 1.0, triangle);
                ty.around(y - 0.5, fy, 1.0, triangle);
                height = mean_of_present(window, tx, ty);
            }
            if (std::isnan(height)) continue;
            ticks[line + i] = to_ticks(height - datum_m);
            m = 0;
        }
    });
    return {};
}

} // namespace

Status resample_dem(DemMosaic& mosaic, const CellRect& cells, double datum_m, uint64_t window_bytes, int32_t* ticks,
                    DemMask* mask) {
    std::fill(ticks, ticks + cells.area(), 0);
    std::fill(mask, mask + cells.area(), static_cast<DemMask>(k_mask_outside));
    Resampler resampler{mosaic, datum_m, window_bytes, cells, ticks, mask};
    for (size_t sheet = 0; sheet < mosaic.sheet_count(); ++sheet) SAHEL_TRY(resampler.run(sheet, cells));
    return {};
}

} // namespace sahel
