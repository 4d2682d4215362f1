#include "world/dem_sea.h"

#include "world/dem_distance.h"
#include "world/det_math.h"
#include "world/field.h"
#include "world/layers.h"

#include <algorithm>
#include <vector>

namespace sahel {

namespace {

constexpr int32_t k_flat_ticks = 65536; // half a metre

/// One walk over the rows; true if a cell changed.
Result<bool> flood_once(const ScratchRaster<int32_t>& ticks, ScratchRaster<DemMask>& mask, int32_t sea_ticks,
                        bool down) {
    const int64_t width = mask.width(), height = mask.height();
    std::vector<int32_t> ground(static_cast<size_t>(width));
    std::vector<DemMask> now(static_cast<size_t>(width)), before(static_cast<size_t>(width), 0);
    bool changed_any = false;
    for (int64_t k = 0; k < height; ++k) {
        const int64_t y = down ? k : height - 1 - k;
        SAHEL_TRY(ticks.read_row(y, ground.data()));
        SAHEL_TRY(mask.read_row(y, now.data()));
        bool changed = false;
        const auto visit = [&](int64_t i, bool beside) {
            const auto x = static_cast<size_t>(i);
            if (ground[x] > sea_ticks || (now[x] & (k_mask_sea | k_mask_outside))) return;
            // The edge of the data: of the raster, or beside a cell that no file covers (the one below is seen on the
            // way up).
            const bool edge = i == 0 || i == width - 1 || y == 0 || y == height - 1 ||
                              ((now[x - 1] | now[x + 1] | before[x]) & k_mask_outside);
            if (!edge && !beside && !(before[x] & k_mask_sea)) return;
            now[x] = static_cast<DemMask>(now[x] | k_mask_sea);
            changed = true;
        };
        for (int64_t i = 0; i < width; ++i) visit(i, i > 0 && (now[static_cast<size_t>(i - 1)] & k_mask_sea));
        for (int64_t i = width - 1; i >= 0; --i)
            visit(i, i + 1 < width && (now[static_cast<size_t>(i + 1)] & k_mask_sea));
        if (changed) SAHEL_TRY(mask.write_row(y, now.data()));
        changed_any = changed_any || changed;
        std::swap(now, before);
    }
    return changed_any;
}

} // namespace

float sea_bed_depth_m(float offshore_m, double shelf_m) {
    return std::min(static_cast<float>(shelf_m), 0.1f * det::pow(offshore_m, 2.0f / 3.0f));
}

Result<DemSea> flood_sea(ScratchRaster<int32_t>& ticks, ScratchRaster<DemMask>& mask, int32_t sea_ticks, double shelf_m,
                         double cell_m, const std::filesystem::path& scratch) {
    for (bool down = true, first = true;; down = !down) {
        SAHEL_ASSIGN(const bool changed, flood_once(ticks, mask, sea_ticks, down));
        if (!changed && !first) break;
        first = false;
    }
    DemSea sea;
    const auto width = static_cast<size_t>(mask.width());
    std::vector<int32_t> ground(width);
    std::vector<DemMask> bits(width);
    int64_t flat = 0, surveyed = 0;
    for (int64_t y = 0; y < mask.height(); ++y) {
        SAHEL_TRY(ticks.read_row(y, ground.data()));
        SAHEL_TRY(mask.read_row(y, bits.data()));
        for (size_t x = 0; x < width; ++x) {
            if (!(bits[x] & k_mask_sea)) continue;
            ++sea.cells;
            if (bits[x] & k_mask_filled) continue;
            ++surveyed;
            flat += int64_t{sea_ticks} - ground[x] <= k_flat_ticks;
        }
    }
    if (2 * flat <= surveyed) return sea;
    sea.made_up_bed = true;
    SAHEL_ASSIGN(const auto shore,
                 distance_to(
                     mask, [](DemMask m) { return (m & (k_mask_sea | k_mask_outside)) == 0; }, scratch));
    std::vector<float> distance(width);
    for (int64_t y = 0; y < mask.height(); ++y) {
        SAHEL_TRY(ticks.read_row(y, ground.data()));
        SAHEL_TRY(mask.read_row(y, bits.data()));
        SAHEL_TRY(shore.read_row(y, distance.data()));
        for (size_t x = 0; x < width; ++x) {
            if (!(bits[x] & k_mask_sea)) continue;
            const float offshore_m =
                (distance[x] - 0.5f) * static_cast<float>(cell_m); // the shore runs between two cells
            ground[x] = sea_ticks - ticks_of_metres(sea_bed_depth_m(offshore_m, shelf_m));
        }
        SAHEL_TRY(ticks.write_row(y, ground.data()));
    }
    return sea;
}

} // namespace sahel
