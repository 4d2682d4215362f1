#pragma once

#include "sim/avalanche_rules.h"
#include "sim/sand_params.h"
#include "sim/tile_domain.h"

#include <cstdint>

/// Avalanching of sand, soil and bedrock (Desertscape method 3.11 and 3.12, Oasis method A10 and A11) in ticks: every
/// slope steeper than repose gives to its lower neighbours, each transfer rounded once and gathered by its receiver.
///
///     fixed count   the published rule and schedule of soft sweeps, from one plane to the next (race free): sand where
///                   params.avalanche_sweeps > 0, soil and bedrock always
///     until quiet   sweeps with inertia (avalanche_rules.h) until one moves no tick: sand by default. Slopes end
///     within
///                   about half a degree of repose, in a fraction of the sweeps that the published rule takes.
///
/// Water and what floats in it do not count. Sand lies on objects and slides off them like anywhere else; the rock of
/// an object never falls (what falls on it stays). Soil that is soaked is loose, sand's angle is the layer `repose`.
///
///     open border     swallows what slides over it        frozen   receives in its inbox, gives nothing
///     wall            mirrors (fixed count); nothing slides through it (until quiet)
///
/// Blocks in which nothing can move are left out, which changes no bit (avalanche_blocks.h). A sweep uses up two cells
/// of the halo; when they are gone the sliding layer is exchanged again.
namespace sahel {

struct AvalancheStats {
    int32_t sweeps = 0;      ///< until quiet: up to the first in which nothing slid
    bool quiet = false;      ///< the last sweep moved nothing
    int64_t cells_swept = 0; ///< cells worked out, with halos
    int64_t cells_all = 0;   ///< sweeps x owned cells

    [[nodiscard]] double swept() const {
        return cells_all > 0 ? static_cast<double>(cells_swept) / static_cast<double>(cells_all) : 0.0;
    }
};

struct AvalancheOptions {
    bool adaptive = true; ///< leave out blocks in which nothing can move
};

/// Layers that `avalanche` needs of a domain beside bedrock, soil, sand and repose. They hold nothing between calls.
SimLayerSet avalanche_layers();
/// What a host domain keeps for avalanches beside its layers, exactly: which borders are closed, and which are walls.
uint64_t avalanche_bytes(uint64_t slots);

/// Relaxes one material of the whole domain; exchanges halos itself. `cell_m`: side of a cell. What crosses borders is
/// accounted when the domain keeps flows: on the layer that receives (rock that falls as sand: on the sand).
/// Errors: usage (a halo below 2 cells), budget (a device's account of blocks), those of the device.
Status avalanche(TileDomain& domain, const SandParams& params, double cell_m, AvalancheKind kind,
                 const AvalancheOptions& options, AvalancheStats* stats);

} // namespace sahel
