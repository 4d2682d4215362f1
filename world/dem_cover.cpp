#include "world/dem_cover.h"

#include "world/field.h"
#include "world/layers.h"

#include <algorithm>
#include <cmath>

namespace sahel {

namespace {

/// Sums over rectangles of whole numbers: exact, so the same from every window.
class SummedArea {
  public:
    template <class Value>
    SummedArea(const CellRect& rect, Value value)
        : rect_(rect), stride_(rect.width() + 1), sum_(static_cast<size_t>(stride_ * (rect.height() + 1)), 0) {
        for (int64_t y = 0; y < rect.height(); ++y) {
            int64_t line = 0;
            for (int64_t x = 0; x < rect.width(); ++x) {
                line += value(y * rect.width() + x);
                sum_[static_cast<size_t>((y + 1) * stride_ + x + 1)] =
                    sum_[static_cast<size_t>(y * stride_ + x + 1)] + line;
            }
        }
    }
    /// Sum and number of cells of the square around c, as far as there are cells.
    [[nodiscard]] std::pair<int64_t, int64_t> around(int64_t x, int64_t y, int64_t radius) const {
        const CellRect box = CellRect{x - radius, y - radius, x + radius + 1, y + radius + 1}.intersected(rect_);
        const auto at = [&](int64_t cx, int64_t cy) {
            return sum_[static_cast<size_t>((cy - rect_.y0) * stride_ + (cx - rect_.x0))];
        };
        return {at(box.x1, box.y1) - at(box.x0, box.y1) - at(box.x1, box.y0) + at(box.x0, box.y0), box.area()};
    }

  private:
    CellRect rect_;
    int64_t stride_;
    std::vector<int64_t> sum_;
};

float unit(float x) {
    return std::clamp(x, 0.0f, 1.0f);
}

} // namespace

DemCover::DemCover(const DemCoverParams& params, double cell_m, std::optional<int32_t> sea_ticks)
    : params_(params), cell_m_(cell_m), sea_ticks_(sea_ticks) {
    const auto cells = [&](double metres, int64_t lo, int64_t hi) {
        return std::clamp(static_cast<int64_t>(std::llround(std::min(metres / cell_m, 1e6))), lo, hi);
    };
    relief_cells_ = cells(static_cast<double>(params.relief_radius_m), 2, 48);
    slope_cells_ = cells(2.5, 1, 8); // slopes over 5 m or more: finer ones are boulders and noise
    beach_cells_ = cells(40.0, 1, 48);
    reach_ = std::max({relief_cells_, slope_cells_, beach_cells_});
}

void DemCover::estimate(const CellRect& around, const int32_t* ground, const DemMask* mask, const CellRect& cells,
                        int32_t* soil, int32_t* sand) const {
    const SummedArea heights(around, [&](int64_t i) { return int64_t{ground[i]}; });
    const bool beach = sea_ticks_ && params_.beach_m > 0.0f;
    const SummedArea sea(beach ? around : CellRect{}, [&](int64_t i) { return int64_t{(mask[i] & k_mask_sea) != 0}; });
    const int64_t width = around.width();
    const auto height = [&](int64_t x, int64_t y) {
        return ground[(std::clamp(y, around.y0, around.y1 - 1) - around.y0) * width +
                      (std::clamp(x, around.x0, around.x1 - 1) - around.x0)];
    };
    // Span in metres of a difference that may be cut at the edge of the raster.
    const auto gradient = [&](int64_t x, int64_t y, bool along_x) {
        const int64_t r = slope_cells_;
        const int64_t c = along_x ? x : y, lo = along_x ? around.x0 : around.y0,
                      hi = (along_x ? around.x1 : around.y1) - 1;
        const int64_t a = std::max(c - r, lo), b = std::min(c + r, hi);
        if (a == b) return 0.0f;
        const int64_t drop = along_x ? int64_t{height(b, y)} - height(a, y) : int64_t{height(x, b)} - height(x, a);
        return static_cast<float>(drop) * k_m_per_tick / static_cast<float>(static_cast<double>(b - a) * cell_m_);
    };
    const float relief_scale_m = static_cast<float>(0.1 * static_cast<double>(relief_cells_) * cell_m_);
    for (int64_t y = cells.y0; y < cells.y1; ++y)
        for (int64_t x = cells.x0; x < cells.x1; ++x, ++soil, ++sand) {
            const int64_t i = (y - around.y0) * width + (x - around.x0);
            const float gx = gradient(x, y, true), gy = gradient(x, y, false);
            const float slope = std::sqrt(gx * gx + gy * gy);
            const auto [sum, count] = heights.around(x, y, relief_cells_);
            const float above_m = static_cast<float>(int64_t{ground[i]} - sum / count) * k_m_per_tick;
            const float position = std::clamp(above_m / relief_scale_m, -1.0f, 1.0f); // -1 hollow, 1 ridge
            const bool under_sea = (mask[i] & k_mask_sea) != 0;
            float soil_m = params_.soil_m * unit(1.0f - slope / params_.bare_slope) * (1.0f - 0.6f * position);
            float sand_m = params_.sand_m * unit(1.0f - slope / 0.06f) * unit(0.3f - position);
            if (under_sea) soil_m = sand_m = 0.0f;
            if (beach && sea.around(x, y, beach_cells_).first > 0) {
                const float above_sea_m = static_cast<float>(int64_t{ground[i]} - *sea_ticks_) * k_m_per_tick;
                const float near = above_sea_m >= 0.0f ? 1.0f - above_sea_m / 2.5f : 1.0f + above_sea_m / 8.0f;
                const float shore = unit(near) * unit(1.0f - slope / 0.2f);
                sand_m = std::max(sand_m, params_.beach_m * shore);
                soil_m *= 1.0f - shore;
            }
            *soil = ticks_of_metres(soil_m);
            *sand = ticks_of_metres(sand_m);
        }
}

} // namespace sahel
