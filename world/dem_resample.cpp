#include "world/dem_resample.h"

#include "world/executor.h"
#include "world/layers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace sahel {

namespace {

double nan_value() {
    return std::numeric_limits<double>::quiet_NaN();
}

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

    template <class Kernel> void around(double at, double filter, double radius, Kernel kernel, int64_t samples) {
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
        // Beyond the first and last sample of a sheet those count on.
        while (first < 0 && weight.size() > 1) {
            weight[1] += weight[0];
            weight.erase(weight.begin());
            ++first;
        }
        while (first + static_cast<int64_t>(weight.size()) > samples && weight.size() > 1) {
            weight[weight.size() - 2] += weight.back();
            weight.pop_back();
        }
    }
};

struct Window {
    CellRect rect;
    std::vector<double> samples;

    [[nodiscard]] double at(int64_t x, int64_t y) const {
        if (!rect.contains(Cell{x, y})) return nan_value();
        return samples[static_cast<size_t>((y - rect.y0) * rect.width() + (x - rect.x0))];
    }
};

/// Sum over the samples of a tap window; NaN if one is missing. Columns first: where all cells of a row share the rows
/// of samples (straight sheets), each column is summed once for all of them.
class WeightedSum {
  public:
    WeightedSum(const Window& window, bool straight) : window_(window) {
        if (straight) column_.assign(static_cast<size_t>(window.rect.width()), 0.0);
    }

    /// For straight sheets: the rows of all cells to come.
    void set_rows(const Taps& ty) {
        const int64_t width = window_.rect.width();
        std::fill(column_.begin(), column_.end(), 0.0);
        for (size_t j = 0; j < ty.weight.size(); ++j) {
            const int64_t y = ty.first + static_cast<int64_t>(j);
            if (y < window_.rect.y0 || y >= window_.rect.y1) {
                std::fill(column_.begin(), column_.end(), nan_value());
                return;
            }
            const double* row = &window_.samples[static_cast<size_t>((y - window_.rect.y0) * width)];
            const double w = ty.weight[j];
            for (int64_t x = 0; x < width; ++x) column_[static_cast<size_t>(x)] += w * row[x];
        }
    }

    [[nodiscard]] double operator()(const Taps& tx, const Taps& ty) const {
        const CellRect& r = window_.rect;
        const auto columns = static_cast<int64_t>(tx.weight.size()), rows = static_cast<int64_t>(ty.weight.size());
        if (!r.contains(CellRect{tx.first, ty.first, tx.first + columns, ty.first + rows})) return nan_value();
        double sum = 0.0;
        for (int64_t i = 0; i < columns; ++i) {
            double column = 0.0;
            if (!column_.empty()) {
                column = column_[static_cast<size_t>(tx.first + i - r.x0)];
            } else {
                const double* p =
                    &window_.samples[static_cast<size_t>((ty.first - r.y0) * r.width() + (tx.first + i - r.x0))];
                for (int64_t j = 0; j < rows; ++j, p += r.width()) column += ty.weight[static_cast<size_t>(j)] * *p;
            }
            sum += tx.weight[static_cast<size_t>(i)] * column;
        }
        return sum;
    }

  private:
    const Window& window_;
    std::vector<double> column_;
};

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
    return present >= 0.5 - 1e-9 ? sum / present : nan_value();
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
    const bool straight = mosaic.straight(sheet);
    const int64_t columns = mosaic.sheet_width(sheet), rows = mosaic.sheet_height(sheet);
    for_each_index("dem/resample", cells.height(), [&](int64_t j) {
        Taps tx, ty;
        WeightedSum weighted(window, straight);
        if (straight) {
            ty.around(v[static_cast<size_t>(j * width)] - 0.5, fy, 2.0, cubic, rows);
            weighted.set_rows(ty);
        }
        const int64_t line = (cells.y0 + j - all.y0) * all.width() + (cells.x0 - all.x0);
        for (int64_t i = 0; i < width; ++i) {
            DemMask& m = mask[line + i];
            if (m == 0) continue; // a better sheet has it
            const double x = u[static_cast<size_t>(j * width + i)], y = v[static_cast<size_t>(j * width + i)];
            if (!(x >= -1e-6 && y >= -1e-6 && x <= w + 1e-6 && y <= h + 1e-6)) continue;
            const Cell under{std::clamp(static_cast<int64_t>(std::floor(x)), int64_t{0}, columns - 1),
                             std::clamp(static_cast<int64_t>(std::floor(y)), int64_t{0}, rows - 1)};
            if (std::none_of(covered.begin(), covered.end(), [&](const CellRect& c) { return c.contains(under); }))
                continue;
            m = static_cast<DemMask>(k_mask_filled);
            tx.around(x - 0.5, fx, 2.0, cubic, columns);
            if (!straight) ty.around(y - 0.5, fy, 2.0, cubic, rows);
            double height = weighted(tx, ty);
            if (std::isnan(height)) {
                tx.around(x - 0.5, fx, 1.0, triangle, columns);
                ty.around(y - 0.5, fy, 1.0, triangle, rows);
                height = mean_of_present(window, tx, ty);
                if (straight) ty.around(y - 0.5, fy, 2.0, cubic, rows);
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
