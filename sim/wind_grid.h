#pragma once

#include "sim/tile_domain.h"
#include "sim/wind_params.h"
#include "sim/wind_pass.h"
#include "sim/wind_schedule.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

/// The wind of the whole active region on one coarse grid, solved once an epoch and read by every cell bilinearly.
///
///     cells (owned, of all tiles)  --sums of ticks-->  coarse heights  --smooth, venturi, warp, project-->  coarse
///     wind
///                  ^                                                                                            |
///                  '----------------- wind_x, wind_y of each cell, halos too <----------- bilinear -------------'
///
///     sums in 64 bits   wind_ground.h      Gaussian smoothing   wind_smooth.h     projection   wind_project.h
///     reading           wind_pass.h        venturi and warping  wind_warp.h
///
/// The coarse grid is aligned with the world. The sums are integers over owned cells and everything after them is one
/// computation on the host: the wind has the same bits for any tiles, halos, threads, instruction set and machine.
namespace sahel {

/// The rectangle of the world that shares one wind.
struct WindRegion {
    WindAxis x, y; ///< WindAxis::coarse is set by the grid
    int32_t tile_cells = 0;

    /// The rectangle around a layout's tiles. An axis is periodic where that rectangle spans a periodic world; a side
    /// is a wall where it lies on the world's wall.
    static WindRegion of(const TileLayout& layout);
};

class WindGrid {
  public:
    /// Spacing: the largest power of two of cells that divides a tile and is not above 8, nor above a third of the
    /// smallest standard deviation in use (half a radius). Working memory is the host's, the wind itself also
    /// `pool`'s where that is CUDA memory. Errors: usage, budget.
    static Result<WindGrid> create(const WindRegion& region, const WindParams& params, double cell_m,
                                   MemoryPool& pool = MemoryPool::host());
    static Result<WindGrid> create(const TileDomain& domain, const WindParams& params, double cell_m);

    /// Solves the wind over the ground and water of the domain as they are now.
    Status solve(const TileDomain& domain, const WindNow& now);
    /// The same in parts, for a region whose tiles are not all resident at once: add each domain that holds some of
    /// them, in any order. Where no tile was added the ground is carried on from its neighbours, ring by ring.
    void clear_ground();
    Status add_ground(const TileDomain& domain);
    Status solve_ground(const WindNow& now);

    /// Writes wind_x and wind_y of every cell, halos included, from the last solution at the time it runs. For any
    /// domain whose tiles lie in the region, in memory of the kind that the grid was made for. Outlives the grid.
    [[nodiscard]] Pass pass() const;
    /// No cell's wind is faster; the same for every tiling. m/s.
    [[nodiscard]] float max_speed() const;

    /// The last solution, for a run that stops within an epoch; `restore` refuses what does not fit (corrupt, usage).
    [[nodiscard]] std::vector<uint8_t> save() const;
    Status restore(const std::vector<uint8_t>& bytes);

    [[nodiscard]] bool solved() const;
    [[nodiscard]] int32_t spacing_cells() const;
    [[nodiscard]] const WindRegion& region() const;
    /// The last solution, row by row, at the centres of coarse cells; m/s.
    [[nodiscard]] std::span<const float> coarse_x() const;
    [[nodiscard]] std::span<const float> coarse_y() const;
    /// Largest divergence before and after projection (m/s for each spacing), and the iterations it took.
    struct Projected {
        float before = 0.0f, after = 0.0f;
        int32_t iterations = 0;
    };
    [[nodiscard]] const Projected& projected() const;

  private:
    struct State;
    explicit WindGrid(std::shared_ptr<State> state) : state_(std::move(state)) {}
    std::shared_ptr<State> state_; ///< shared with the passes made
};

} // namespace sahel
