#pragma once

#include "sim/avalanche.h"
#include "sim/sand_params.h"
#include "sim/tile_domain.h"
#include "sim/wind_grid.h"
#include "sim/wind_params.h"
#include "sim/wind_schedule.h"

#include <cstdint>
#include <optional>

/// One step of wind and sand: the passes in their order.
namespace sahel {

struct AeolianStats {
    AvalancheStats sand;
    float max_wind_m_per_s = 0.0f;
    double coverage = 0.0; ///< share of cells with more sand than the threshold; measured where supply is on
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
    };
    /// Errors: usage (parameters that do not fit together, a halo that is too narrow), budget.
    static Result<Aeolian> create(const Desc& desc, const TileDomain& domain);
    /// Every layer that a domain must have for the description.
    static SimLayerSet layers(const Desc& desc);
    /// The narrowest halo it runs with.
    static int32_t least_halo(const Desc& desc);

    /// Advances the domain from step number `step` to the next. Given layers (vegetation, resistance, object) and
    /// conserved ones must be loaded. Errors: those of the device.
    Status step(TileDomain& domain, int64_t step);

    [[nodiscard]] const AeolianStats& stats() const { return stats_; }
    [[nodiscard]] WindGrid& wind() { return wind_; }
    [[nodiscard]] const Desc& desc() const { return desc_; }

  private:
    Desc desc_;
    WindGrid wind_;
    AeolianStats stats_;
};

} // namespace sahel
