#pragma once

#include "world/terrain_rows.h"
#include "world/tile_key.h"

#include <cstdint>
#include <vector>

/// Lakes of the base terrain: at most one for each square of a 4096 m lattice, decided from the land at its site and
/// four points around it, so a lake is flat, bounded, the same for every tile, and needs no flood fill.
namespace sahel {

/// The lakes whose shape may reach the rectangle [x0, x1) x [y0, y1) of world half metres, in lattice order (rows of
/// y).
void find_lakes(const TerrainTables& tables, const TerrainKernels& kernels, int64_t x0, int64_t y0, int64_t x1,
                int64_t y1, std::vector<LakeSite>& lakes);

/// Those that a rectangle of cells of a level needs; none where they are smaller than a cell.
void find_lakes_near(const TerrainTables& tables, const TerrainKernels& kernels, int32_t level, const CellRect& rect,
                     std::vector<LakeSite>& lakes);

} // namespace sahel
