#pragma once

#include "sim/pass.h"
#include "sim/tile_domain.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

/// The walk over a list of passes. Of each layer the plan knows how many halo cells are valid; a pass that reads
/// radius r may compute as far as (valid - r) cells around the owned ones. While that is at least 0 no exchange is
/// needed: the halo is used up, cell by cell, and recomputed with the neighbours' own arithmetic (hence the same bits).
///
///     halo 8, pass P reads a:1 writes b, pass Q reads b:2 writes a          valid a  valid b     computed
///     exchange a                                                                 8        -
///     P                                                                          8        7     owned + 7
///     Q                                                                          5        7     owned + 5
///     P                                                                          5        4     owned + 4
///     Q                                                                          2        4     owned + 2     ...
///
/// Two walks: forward with the widest margins, to find where exchanges must stand (as late as possible; each takes all
/// layers with it that will be needed before they are made anew); then backward, to compute no further than later
/// passes read. At the end of the list nothing is owed to the halo.
///
/// After AMReX (Zhang et al.: AMReX, JOSS 2019) for owned and ghost cells and GridTools (Afanasyev et al., SoftwareX
/// 2021) for extents added up along a chain.
namespace sahel {

struct PlanOp {
    enum class Kind : uint8_t { exchange, pass } kind = Kind::pass;
    SimLayerSet layers; ///< of an exchange
    int32_t pass = 0;   ///< index into the list
    int32_t margin = 0; ///< halo cells to compute
};

class StepPlan {
  public:
    /// Errors (usage): a radius above the halo, named with its pass; a read of what no pass and no load has written.
    static Result<StepPlan> make(std::span<const PassDecl> passes, int32_t halo, const HaloState& valid);

    [[nodiscard]] std::span<const PlanOp> ops() const { return ops_; }
    [[nodiscard]] int32_t exchanges() const;
    /// Cells computed beyond the owned ones of an n x n tile, over all passes, as a share of the owned ones.
    [[nodiscard]] double redundancy(int32_t n) const;
    /// One op a line, for people.
    [[nodiscard]] std::string text(std::span<const PassDecl> passes) const;

  private:
    std::vector<PlanOp> ops_;
};

/// Plans and runs the list on the domain, and leaves the domain's halo state as the passes left it.
Status run_passes(TileDomain& domain, std::span<const Pass> passes);

} // namespace sahel
