#pragma once

#include "world/terrain_rows.h"
#include "world/tile_key.h"

#include <cstdint>
#include <optional>
#include <vector>

/// Lakes of the base terrain: at most one for each square of a 4096 m lattice, decided from the land at its site and
/// four points around it, so a lake is flat, bounded, the same for every tile, and needs no flood fill.
namespace sahel {

/// A place where a lake may be.
struct RawLakeSite {
    uint32_t hash;
    int64_t x_half_m, y_half_m;
};
std::optional<RawLakeSite> raw_lake_site(const TerrainTables& tables, int64_t i, int64_t j);

/// The lakes whose shape may reach the rectangle [x0, x1) x [y0, y1) of world half metres, in lattice order (rows of
/// y).
void find_lakes(const TerrainTables& tables, const TerrainKernels& kernels, int64_t x0, int64_t y0, int64_t x1,
                int64_t y1, std::vector<LakeSite>& lakes);

/// Those that a rectangle of cells of a level needs, and those whose streams may reach it; none where they are smaller
/// than a cell.
void find_lakes_near(const TerrainTables& tables, const TerrainKernels& kernels, int32_t level, const CellRect& rect,
                     std::vector<LakeSite>& lakes);

} // namespace sahel
