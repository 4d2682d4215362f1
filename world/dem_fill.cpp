#include "world/dem_fill.h"

#include "world/layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace sahel {

namespace {

enum Role : uint8_t { k_apart = 0, k_unknown = 1, k_rim = 2 };

struct Level {
    ScratchRaster<float> value; ///< ticks; level 0 lives in the caller's raster
    ScratchRaster<uint8_t> role;
    std::vector<uint32_t> unknown; ///< per row
    [[nodiscard]] int64_t width() const { return role.width(); }
    [[nodiscard]] int64_t height() const { return role.height(); }
    [[nodiscard]] bool any() const {
        return std::any_of(unknown.begin(), unknown.end(), [](uint32_t n) { return n > 0; });
    }
};

bool is_unknown(DemMask m) {
    return (m & (k_mask_filled | k_mask_outside)) != 0;
}

/// Rows around y of a raster, the missing ones (beyond the first and last) left alone; walks both ways.
template <class T> struct ThreeRows {
    std::array<std::vector<T>, 3> row; ///< y - 1, y, y + 1
    int64_t at = -2;

    Status move(const ScratchRaster<T>& raster, int64_t y) {
        for (auto& r : row) r.resize(static_cast<size_t>(raster.width()));
        if (y == at + 1) {
            std::rotate(row.begin(), row.begin() + 1, row.end());
            if (y + 1 < raster.height()) SAHEL_TRY(raster.read_row(y + 1, row[2].data()));
        } else if (y == at - 1) {
            std::rotate(row.begin(), row.begin() + 2, row.end());
            if (y > 0) SAHEL_TRY(raster.read_row(y - 1, row[0].data()));
        } else {
            for (int64_t k = -1; k <= 1; ++k)
                if (y + k >= 0 && y + k < raster.height())
                    SAHEL_TRY(raster.read_row(y + k, row[static_cast<size_t>(k + 1)].data()));
        }
        at = y;
        return {};
    }
};

/// Roles of the finest level, from the mask.
Status find_rims(const ScratchRaster<DemMask>& mask, Level& level) {
    const int64_t width = mask.width(), height = mask.height();
    level.unknown.assign(static_cast<size_t>(height), 0);
    ThreeRows<DemMask> rows;
    std::vector<uint8_t> role(static_cast<size_t>(width));
    for (int64_t y = 0; y < height; ++y) {
        SAHEL_TRY(rows.move(mask, y));
        uint32_t unknown = 0;
        for (int64_t i = 0; i < width; ++i) {
            const auto x = static_cast<size_t>(i);
            if (is_unknown(rows.row[1][x])) {
                role[x] = k_unknown;
                ++unknown;
                continue;
            }
            const bool rim = (i > 0 && is_unknown(rows.row[1][x - 1])) ||
                             (i + 1 < width && is_unknown(rows.row[1][x + 1])) ||
                             (y > 0 && is_unknown(rows.row[0][x])) || (y + 1 < height && is_unknown(rows.row[2][x]));
            role[x] = rim ? k_rim : k_apart;
        }
        level.unknown[static_cast<size_t>(y)] = unknown;
        SAHEL_TRY(level.role.write_row(y, role.data()));
    }
    return {};
}

template <class T> Status coarsen(const ScratchRaster<T>& value, const Level& fine, Level& coarse) {
    const auto fine_width = static_cast<size_t>(fine.width()), width = static_cast<size_t>(coarse.width());
    std::array<std::vector<T>, 2> v{std::vector<T>(fine_width), std::vector<T>(fine_width)};
    std::array<std::vector<uint8_t>, 2> r{std::vector<uint8_t>(fine_width), std::vector<uint8_t>(fine_width)};
    std::vector<float> out(width);
    std::vector<uint8_t> role(width);
    coarse.unknown.assign(static_cast<size_t>(coarse.height()), 0);
    for (int64_t y = 0; y < coarse.height(); ++y) {
        const auto rows = static_cast<size_t>(std::min<int64_t>(2, fine.height() - 2 * y));
        for (size_t j = 0; j < rows; ++j) {
            SAHEL_TRY(value.read_row(2 * y + static_cast<int64_t>(j), v[j].data()));
            SAHEL_TRY(fine.role.read_row(2 * y + static_cast<int64_t>(j), r[j].data()));
        }
        for (size_t x = 0; x < width; ++x) {
            double sum = 0.0;
            int rim = 0, unknown = 0;
            for (size_t j = 0; j < rows; ++j)
                for (size_t i = 2 * x; i < std::min(2 * x + 2, fine_width); ++i) {
                    if (r[j][i] == k_rim) {
                        sum += static_cast<double>(v[j][i]);
                        ++rim;
                    }
                    unknown += r[j][i] == k_unknown;
                }
            out[x] = rim ? static_cast<float>(sum / rim) : 0.0f;
            role[x] = rim ? k_rim : unknown ? k_unknown : k_apart;
            coarse.unknown[static_cast<size_t>(y)] += role[x] == k_unknown;
        }
        SAHEL_TRY(coarse.value.write_row(y, out.data()));
        SAHEL_TRY(coarse.role.write_row(y, role.data()));
    }
    return {};
}

template <class T> T to_value(double v) {
    if constexpr (std::is_integral_v<T>)
        return static_cast<T>(std::llround(v));
    else
        return static_cast<T>(v);
}

/// Start values of unknown cells: bilinear in the coarser level, over the cells that take part.
template <class T> Status start_from(const Level& coarse, ScratchRaster<T>& value, const Level& fine) {
    ThreeRows<float> cv;
    ThreeRows<uint8_t> cr;
    const auto width = static_cast<size_t>(fine.width());
    std::vector<T> v(width);
    std::vector<uint8_t> role(width);
    for (int64_t y = 0; y < fine.height(); ++y) {
        if (fine.unknown[static_cast<size_t>(y)] == 0) continue;
        const int64_t cy = y / 2;
        if (cv.at != cy) {
            SAHEL_TRY(cv.move(coarse.value, cy));
            SAHEL_TRY(cr.move(coarse.role, cy));
        }
        SAHEL_TRY(value.read_row(y, v.data()));
        SAHEL_TRY(fine.role.read_row(y, role.data()));
        const int64_t side_y = y % 2 ? 1 : -1;
        for (size_t x = 0; x < width; ++x) {
            if (role[x] != k_unknown) continue;
            const auto cx = static_cast<int64_t>(x / 2);
            const int64_t side_x = x % 2 ? 1 : -1;
            double sum = 0.0, weight = 0.0;
            const auto take = [&](int64_t dx, int64_t dy, double w) {
                if (cx + dx < 0 || cx + dx >= coarse.width() || cy + dy < 0 || cy + dy >= coarse.height()) return;
                const auto row = static_cast<size_t>(1 + dy), column = static_cast<size_t>(cx + dx);
                if (cr.row[row][column] == k_apart) return;
                sum += w * static_cast<double>(cv.row[row][column]);
                weight += w;
            };
            take(0, 0, 9.0);
            take(side_x, 0, 3.0);
            take(0, side_y, 3.0);
            take(side_x, side_y, 1.0);
            v[x] = to_value<T>(sum / weight);
        }
        SAHEL_TRY(value.write_row(y, v.data()));
    }
    return {};
}

/// One Gauss-Seidel sweep: each unknown cell becomes the mean of its neighbours.
template <class T> Status sweep(ScratchRaster<T>& value, const Level& level, bool down) {
    ThreeRows<T> v;
    ThreeRows<uint8_t> r;
    const int64_t width = level.width(), height = level.height();
    for (int64_t k = 0; k < height; ++k) {
        const int64_t y = down ? k : height - 1 - k;
        if (level.unknown[static_cast<size_t>(y)] == 0) continue;
        SAHEL_TRY(v.move(value, y));
        SAHEL_TRY(r.move(level.role, y));
        const auto relax = [&](int64_t i) {
            const auto x = static_cast<size_t>(i);
            if (r.row[1][x] != k_unknown) return;
            double sum = 0.0;
            int count = 0;
            const auto take = [&](size_t row, size_t column) {
                if (r.row[row][column] == k_apart) return;
                sum += static_cast<double>(v.row[row][column]);
                ++count;
            };
            if (y > 0) take(0, x);
            if (i > 0) take(1, x - 1);
            if (i + 1 < width) take(1, x + 1);
            if (y + 1 < height) take(2, x);
            if (count > 0) v.row[1][x] = to_value<T>(sum / count);
        };
        if (down)
            for (int64_t i = 0; i < width; ++i) relax(i);
        else
            for (int64_t i = width - 1; i >= 0; --i) relax(i);
        SAHEL_TRY(value.write_row(y, v.row[1].data()));
    }
    return {};
}

} // namespace

Status fill_dem(ScratchRaster<int32_t>& ticks, const ScratchRaster<DemMask>& mask,
                const std::filesystem::path& scratch) {
    std::vector<Level> levels(1);
    SAHEL_ASSIGN(levels[0].role, ScratchRaster<uint8_t>::create(scratch, ticks.width(), ticks.height()));
    SAHEL_TRY(find_rims(mask, levels[0]));
    while (levels.back().any()) {
        const Level& fine = levels.back();
        const int64_t width = (fine.width() + 1) / 2, height = (fine.height() + 1) / 2;
        SAHEL_CHECK(fine.width() > 1 || fine.height() > 1); // some cell has data, so a single cell is a rim
        Level coarse;
        SAHEL_ASSIGN(coarse.value, ScratchRaster<float>::create(scratch, width, height));
        SAHEL_ASSIGN(coarse.role, ScratchRaster<uint8_t>::create(scratch, width, height));
        if (levels.size() == 1)
            SAHEL_TRY(coarsen(ticks, fine, coarse));
        else
            SAHEL_TRY(coarsen(fine.value, fine, coarse));
        levels.push_back(std::move(coarse));
    }
    for (size_t k = levels.size() - 1; k-- > 0;) {
        const int sweeps = k == 0 ? 12 : std::min<int>(24 << (k - 1), 192);
        if (k == 0)
            SAHEL_TRY(start_from(levels[1], ticks, levels[0]));
        else
            SAHEL_TRY(start_from(levels[k + 1], levels[k].value, levels[k]));
        for (int s = 0; s < sweeps; ++s) {
            if (k == 0)
                SAHEL_TRY(sweep(ticks, levels[0], s % 2 == 0));
            else
                SAHEL_TRY(sweep(levels[k].value, levels[k], s % 2 == 0));
        }
    }
    return {};
}

} // namespace sahel
