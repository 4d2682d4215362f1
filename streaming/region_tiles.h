#pragma once

#include "sim/tile_domain.h"
#include "world/world.h"

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

/// Between a world and a domain: tiles in and out, rims of sleeping neighbours, what goes into their inboxes.
namespace sahel {

/// One tile of the world as a run takes it: what is stored or generated, and what waited, added.
struct LoadedTile {
    std::vector<Inbox> taken;              ///< what waited
    std::map<SimLayer, int64_t> arrived;   ///< its ticks, of the domain's layers
    std::map<SimLayer, int64_t> untouched; ///< sums of conserved layers that the domain lacks
};

/// Loads a slot of the domain: conserved layers and the mask from the world, plants, resistance and objects as none.
/// Errors: corrupt (what waits does not fit on the tile), budget, io.
Result<LoadedTile> load_tile(const World& world, TileDomain& domain, int32_t slot, MemoryPool& pool);

/// Loads the frozen segments around a slot. What waits there is left out.
Status load_rims(const World& world, TileDomain& domain, int32_t slot);

/// Fills a block of every stored layer with the slot's cells, and the layers that the domain lacks from the world
/// and from `taken`. Errors: corrupt (an amount below zero, named).
Status store_tile(const World& world, const TileDomain& domain, int32_t slot, const std::vector<Inbox>& taken,
                  LayerBlock& block);

/// Ticks that wait, by tile, layer and cell.
using WaitingTicks = std::map<std::pair<TileKey, Layer>, std::map<int32_t, int64_t>>;
/// Adds what the domain's frozen neighbours were given since keep_flows.
Status collect_inboxes(const TileDomain& domain, WaitingTicks& waiting);
std::vector<Inbox> inboxes_of(const WaitingTicks& waiting);

} // namespace sahel
