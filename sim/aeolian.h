#pragma once

#include "sim/avalanche.h"
#include "sim/sand_params.h"
#include "sim/tile_domain.h"
#include "sim/wind_grid.h"
#include "sim/wind_params.h"
#include "sim/wind_schedule.h"

#include <cstdint>
#include <optional>
#include <vector>

/// One step of wind and sand: the passes in their order (Desertscape method 2.2).
///
///     every supply_every steps   supply                     sand falls or is taken away: counted, for the ledger
///     every epoch, new wind      wind                       solved on the coarse grid, written to all cells
///     each part of the step      ground, shadow, (cliff,    a part is at most one hop long
///                                echo,) lift, legs of the
///                                hop, deposit, smoothing
///     once                       repose, avalanches of sand, soil, bedrock
namespace sahel {

struct AeolianStats {
    AvalancheStats sand;
    float max_wind_m_per_s = 0.0f;
    double coverage = 0.0; ///< share of cells with more sand than the threshold, when supply last looked
    int32_t parts = 0;     ///< of the step
    int32_t legs = 0;      ///< of a hop
};

/// What supply control added and removed since creation.
struct SupplyAccount {
    int64_t added_ticks = 0;
    int64_t removed_ticks = 0;
};

class Aeolian {
  public:
    struct Desc {
        WindParams wind;
        SandParams sand;
        std::optional<WindSchedule> schedule; ///< else the parameters' own
        double cell_m = 1.0;
        uint64_t seed = 1;
        AvalancheOptions avalanche;
        /// The echo layer is loaded with the domain and stays: classes of a file instead of those of the cliffs. They
        /// act where sand.echo_rate is above 0.
        bool echo_given = false;
    };
    /// Errors: usage (parameters that do not fit together, a halo that is too narrow, a missing layer), budget.
    static Result<Aeolian> create(const Desc& desc, const TileDomain& domain);
    /// Every layer that a domain must have for the description.
    static SimLayerSet layers(const Desc& desc);
    /// The narrowest halo it runs with: 8, or what shelter and echo dunes look at.
    static int32_t least_halo(const Desc& desc);

    /// Advances the domain from step number `step` to the next; the step's time begins at step * step_s. Given layers
    /// (vegetation, resistance, object) and conserved ones must be loaded. Errors: those of the device; usage, where
    /// the wind would carry a grain too far in one hop.
    Status step(TileDomain& domain, int64_t step);

    [[nodiscard]] const AeolianStats& stats() const { return stats_; }
    /// For each slot of the domain.
    [[nodiscard]] const std::vector<SupplyAccount>& supplied() const { return supplied_; }
    /// To save it within an epoch, and to restore it before the next step.
    [[nodiscard]] WindGrid& wind() { return wind_; }
    [[nodiscard]] const Desc& desc() const { return desc_; }

  private:
    Aeolian(Desc desc, WindGrid wind, int32_t slots);
    [[nodiscard]] WindNow wind_at(int64_t step) const;
    Status supply(TileDomain& domain, int64_t step);

    Desc desc_;
    WindSchedule schedule_;
    WindGrid wind_;
    AeolianStats stats_;
    std::vector<SupplyAccount> supplied_;
};

} // namespace sahel
