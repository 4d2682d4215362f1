#pragma once

#include "sim/avalanche_rules.h"
#include "sim/sand_params.h"
#include "sim/tile_domain.h"

#include <cstdint>

/// Avalanching of sand, soil and bedrock (Desertscape method 3.11 and 3.12) in ticks: every slope steeper than repose
/// gives to its lower neighbours, each transfer rounded once, gathered by its receiver.
namespace sahel {

struct AvalancheStats {
    int32_t sweeps = 0;
    bool quiet = false;      ///< the last sweep moved nothing (never true for a fixed count that ended before)
    int64_t cells_swept = 0; ///< cells computed; sweeps x cells without skipping
    int64_t cells_all = 0;   ///< sweeps x cells
};

struct AvalancheOptions {
    bool adaptive = true;     ///< skip blocks in which nothing can move: changes no bit
    bool stride_moves = true; ///< until quiet: long moves down long steep slopes first (fewer sweeps)
};

/// Layers that `avalanche` needs of a domain beside bedrock, soil, sand and repose.
SimLayerSet avalanche_layers();

/// Relaxes one material of the whole domain: a fixed number of sweeps (params.avalanche_sweeps, with the published
/// schedule of soft ones) or until quiet. Sand reads `repose` (tangent); soil and bedrock their own angles. Exchanges
/// halos itself. `cell_m`: side of a cell.
Status avalanche(TileDomain& domain, const SandParams& params, double cell_m, AvalancheKind kind,
                 const AvalancheOptions& options, AvalancheStats* stats);

} // namespace sahel
