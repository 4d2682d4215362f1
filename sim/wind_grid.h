#pragma once

#include "sim/tile_domain.h"
#include "sim/wind_params.h"
#include "sim/wind_schedule.h"

#include <cstdint>
#include <string>
#include <vector>

/// The wind of the whole active region on one coarse grid, solved once an epoch and read by every cell bilinearly.
namespace sahel {

class WindGrid {
  public:
    /// The region is the layout's bounds (or the rectangle around its tiles). Spacing: the largest power of two of
    /// cells that is not above a third of the smallest standard deviation in use, at most 8 cells and at most a tile.
    /// Errors: usage, budget.
    static Result<WindGrid> create(const TileDomain& domain, const WindParams& params, double cell_m);

    /// Solves the wind over the ground and water of the domain as they are now.
    Status solve(TileDomain& domain, const WindNow& now);
    /// Writes wind_x and wind_y of every cell, halos included, from the last solution.
    [[nodiscard]] Pass pass() const;
    /// No cell's wind is faster; the same for every tiling. m/s.
    [[nodiscard]] float max_speed() const;

    /// The last solution, for a run that stops within an epoch; `restore` refuses what does not fit.
    [[nodiscard]] std::vector<uint8_t> save() const;
    Status restore(const std::vector<uint8_t>& bytes);
};

} // namespace sahel
