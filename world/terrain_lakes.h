#pragma once

#include "world/terrain_tables.h"

#include <cstdint>
#include <vector>

/// Lakes of the base terrain: at most one for each square of a 4096 m lattice, decided from the land at its site and
/// four points around it, so a lake is flat, bounded, the same for every tile, and needs no flood fill.
namespace sahel {

/// The lakes whose shape may reach the rectangle [x0, x1) x [y0, y1) of world half metres, in lattice order (rows of
/// y).
void find_lakes(const TerrainTables& tables, int64_t x0, int64_t y0, int64_t x1, int64_t y1,
                std::vector<LakeSite>& lakes);

} // namespace sahel
