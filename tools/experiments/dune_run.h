#pragma once

#include "sim/aeolian.h"
#include "tools/experiments/experiment.h"
#include "tools/experiments/plane.h"

#include <functional>
#include <memory>

/// A run of wind and sand on a periodic rectangle of cells, with its fields as planes: what every experiment is made
/// of.
namespace sahel::experiments {

/// What the ground is at the start, by cell. Empty functions: 0 everywhere.
struct Ground {
    using Height = std::function<double(int32_t x, int32_t y)>;
    Height bedrock_m;
    Height sand_m;
    Height vegetation;
    Height resistance;
    std::function<bool(int32_t x, int32_t y)> object;
};

/// The defaults with at most as many sweeps of avalanches in a step as the paper makes, 50: what is still sliding then
/// slides on in the next step.
SandParams dune_sand();

struct DuneRunDesc {
    int32_t cells_x = 128; ///< multiples of 64
    int32_t cells_y = 128;
    double cell_m = 1.0;
    WindParams wind;
    SandParams sand = dune_sand();
    std::optional<WindSchedule> schedule; ///< else the wind's own
    Ground ground;
    uint64_t seed = 1;
};

/// Metres of a tick layer, or the values of a real one, of a domain that starts at cell (0, 0).
Plane plane_of(const TileDomain& domain, SimLayer layer, double cell_m);

class DuneRun {
  public:
    /// The run of a description, with what the setup changes of it. Errors: usage, budget.
    static Result<DuneRun> create(DuneRunDesc desc, const Setup& setup);

    /// Advances by so many steps.
    Status advance(int64_t steps);
    /// Also tells how far it is: from `share` on, over `part` of the work.
    Status advance(int64_t steps, const Setup& setup, double share, double part, const std::string& what);

    [[nodiscard]] int64_t step() const { return step_; }
    [[nodiscard]] double time_s() const { return static_cast<double>(step_) * static_cast<double>(desc_.sand.step_s); }
    [[nodiscard]] Plane plane(SimLayer layer) const { return plane_of(*domain_, layer, desc_.cell_m); }
    [[nodiscard]] Plane sand() const { return plane(SimLayer::sand); }
    [[nodiscard]] Plane bedrock() const { return plane(SimLayer::bedrock); }
    /// Bedrock, soil and sand.
    [[nodiscard]] Plane surface() const;
    /// Every tick of bedrock, soil, sand and sand in the air.
    [[nodiscard]] int64_t solid_ticks() const;
    [[nodiscard]] TileDomain& domain() { return *domain_; }
    [[nodiscard]] Aeolian& aeolian() { return *aeolian_; }
    [[nodiscard]] const DuneRunDesc& desc() const { return desc_; }
    /// Sweeps of the avalanches of sand, over all steps so far.
    [[nodiscard]] int64_t sweeps() const { return sweeps_; }

  private:
    DuneRunDesc desc_;
    std::unique_ptr<TileDomain> domain_;
    std::unique_ptr<Aeolian> aeolian_;
    int64_t step_ = 0;
    int64_t sweeps_ = 0;
};

/// White noise in [0, 1) by cell.
double cell_noise(uint64_t seed, int32_t x, int32_t y);
/// A periodic rectangle of tiles, each a power of two of at most 512 cells. Errors: usage.
Result<TileLayout> periodic_layout(int32_t cells_x, int32_t cells_y, int32_t halo);

} // namespace sahel::experiments
