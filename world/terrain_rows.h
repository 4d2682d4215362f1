#pragma once

#include "world/cpu_features.h"
#include "world/terrain_tables.h"

#include <cstdint>

/// Row kernels of the base terrain. Nodes carry the large scale, cells the fine one:
///
///     node rows    climate -> weights -> massif -> height | lakes | gullies (needs the rows above and below) | carried
///     spline       uniform cubic B-spline from nodes to cells (part of the function, hence independent of tiles)
///     cell rows    strata, wadi, gullies, rock, hummocks | dunes | layers
///
/// All arrays are rows of floats; none may overlap.
namespace sahel {

/// One row of nodes while its height is made.
struct NodeRows {
    float *warp_x, *warp_y; ///< m
    float *relief, *wetness, *continent;
    float *mountain, *dune, *canyon, *wetland;
    float* height; ///< m, before lakes and gullies
};

struct NodeScratch {
    float* v[8];
};

struct GullyRows {
    const float *above, *here, *below; ///< heights of three node rows after lakes
    const float *canyon, *dune, *lake;
    float *height, *slope_x, *slope_y; ///< out
};

struct CarriedRows {
    float *line0, *line1, *strata, *plain4, *supply;
    float *dune_sin, *dune_cos, *mega_sin, *mega_cos;
};

/// Node fields of a row of cells, by NodeField; fields that no term of the tile needs are null.
struct CellFields {
    float* f[k_node_fields];
};
struct CellRows {
    CellFields nodes;                  ///< height and slopes are updated in place
    float *rock, *soil, *sand, *water; ///< out, m
    float* scratch[8];
    bool has_mountain, has_dune, has_canyon; ///< the weight is not zero at every node of the tile
};

SAHEL_ISA_DECLARE(void terrain_height_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m,
                                          const NodeRows& out, const NodeScratch& scratch))
SAHEL_ISA_DECLARE(void terrain_lake_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m,
                                        const LakeSite* sites, int site_count, float* height, float* water_table,
                                        float* lake, const NodeScratch& scratch))
SAHEL_ISA_DECLARE(void terrain_gully_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m,
                                         const GullyRows& rows, const NodeScratch& scratch))
SAHEL_ISA_DECLARE(void terrain_carried_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m,
                                           const float* warp_x, const float* warp_y, bool dunes, const CarriedRows& out,
                                           const NodeScratch& scratch))
/// `weights` are the four basis values of the row; `mixed` holds node_count floats. out[x] for x in [0, cells), the
/// first cell being number `skip` of node interval 0.
SAHEL_ISA_DECLARE(void terrain_spline_row(const float* const rows[4], const float weights[4], int node_count,
                                          int cells_per_node, int skip, int cells, float* mixed, float* out))
SAHEL_ISA_DECLARE(void terrain_cell_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m,
                                        const CellRows& rows))

} // namespace sahel
