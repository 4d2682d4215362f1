#pragma once

#include "sim/aeolian.h"
#include "sim/ledger.h"
#include "sim/tile_domain.h"
#include "streaming/scene_ground.h"

#include <cstdint>
#include <optional>
#include <vector>

/// A scene that runs: a periodic domain of tiles filled from its ground, advanced by wind and sand, measured.
///
///     +--------+--------+--------+--------+     tiles of 512 cells, or the largest power of two that divides
///     | tile 0 |   1    |   2    |   3    |     both sides; opposite sides of the scene are neighbours
///     +--------+--------+--------+--------+     (wind_tunnel: 2048 x 512)
namespace sahel {

struct SceneRunOptions {
    SceneGroundOptions ground;
    bool until_quiet = false; ///< avalanches run until nothing slides, instead of the file's count of sweeps
    int wind_every = 1;       ///< steps between two solutions of the wind; the published program solves it every step
    uint64_t seed = 1;
    int32_t most_tile_cells = 512;
    bool ledger = false; ///< account for every tick, tile by tile
};

/// What method 5.1 asks for, and the books.
struct SceneReport {
    int64_t steps = 0;
    double coverage = 0.0; ///< share of cells with more than 0.1 m of sand
    double sand_mean_m = 0.0;
    double sand_std_m = 0.0;
    double sand_max_m = 0.0;
    double airborne_mean_m = 0.0;
    double excess_max = 0.0; ///< slope beyond repose, of cells with sand: the steepest of eight directions
    double excess_p99 = 0.0;
    double max_wind_m_per_s = 0.0;
    double sweeps_per_step = 0.0; ///< of the avalanches of sand
    double swept_share = 0.0;     ///< cells that these worked out, of those that every sweep over all would have
    int64_t solids_ticks = 0;     ///< bedrock, soil, sand and airborne sand of all cells
    int64_t supplied_ticks = 0;   ///< added by supply control since the start, less what it removed
    int64_t drift_ticks = 0;      ///< solids less the start less supply: 0
};

class SceneRun {
  public:
    /// Errors: those of make_scene_ground; usage (parameters that do not fit the grid), budget.
    static Result<SceneRun> create(const Scene& scene, const SceneRunOptions& options = {});

    /// One step. Errors: those of the aeolian step.
    Status step();
    [[nodiscard]] int64_t steps() const { return steps_; }

    [[nodiscard]] int32_t width() const { return ground_.width; }
    [[nodiscard]] int32_t height() const { return ground_.height; }
    [[nodiscard]] const SceneGround& ground() const { return ground_; }
    [[nodiscard]] const TileDomain& domain() const { return domain_; }
    [[nodiscard]] const Aeolian& aeolian() const { return aeolian_; }

    /// A layer of the whole grid, row after row; ticks become metres. Before the first step working layers hold what
    /// fresh memory holds.
    [[nodiscard]] Result<std::vector<float>> field(SimLayer layer) const;
    [[nodiscard]] Result<SceneReport> report() const;
    /// The ledger up to now. Errors: usage (it was not asked for), those of the device.
    [[nodiscard]] Result<LedgerCheck> ledger_check();

  private:
    SceneRun(SceneGround ground, TileDomain domain, Aeolian aeolian)
        : ground_(std::move(ground)), domain_(std::move(domain)), aeolian_(std::move(aeolian)) {}
    [[nodiscard]] Result<int64_t> solids() const;

    SceneGround ground_;
    TileDomain domain_;
    Aeolian aeolian_;
    std::optional<Ledger> ledger_;
    double cell_m_ = 1.0;
    int64_t steps_ = 0;
    int64_t sweeps_ = 0, cells_swept_ = 0, cells_all_ = 0;
    int64_t start_ticks_ = 0;
};

/// The tiling of a grid whose sides are multiples of k_scene_side_step. Errors: usage (a halo wider than a tile).
Result<TileLayout> scene_layout(int32_t width, int32_t height, int32_t least_halo, int32_t most_tile_cells = 512);

} // namespace sahel
