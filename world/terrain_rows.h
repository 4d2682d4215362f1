#pragma once

#include "world/cpu_features.h"
#include "world/terrain_tables.h"

#include <cstdint>

/// Row kernels of the base terrain. Nodes carry the large scale, cells what is sharp or fine:
///
///     sums      every 4th node: large octaves; spline; nodes: the other octaves
///     base      nodes   climate -> weights -> height of the land
///     lakes     nodes
///     streams   nodes   nearest place of a stream, its valley
///     detail    nodes   gullies (read the rows above and below) -> dune phases, lines, strata
///     sharpen   nodes   makes the spline pass near the nodes' heights
///     spline            uniform cubic B-spline (part of the function, hence independent of tiles)
///     middle    every 4 m, or at cells where those are wider: wadi, rills, coarse rock, hummocks, amplitudes of dunes
///     spline
///     cells             fine rock, strata, beds of streams, dune profiles, layers
///
/// The same source runs on CUDA, where a row is one sample long. All arrays are rows of floats; none may overlap but
/// where a comment says so.
namespace sahel {

inline constexpr int k_row_scratch = 7;

/// Which octaves a call of `sums` adds, by their size.
struct OctaveRange {
    float min_m = 0.0f, max_m = 1e9f;
    [[nodiscard]] SAHEL_HD bool has(float size_m) const { return size_m >= min_m && size_m < max_m; }
};
struct SumRange {
    OctaveRange smooth;
    OctaveRange ridged; ///< those with edges: massifs, the line of wadis and canyons
    OctaveRange warp;   ///< places are warped by all octaves, whichever are added
    bool start = true;  ///< from the biases; else on top of what is there, and then the sums are whole
};

/// A row of nodes.
struct BaseRow {
    float* sum[k_sum_fields];
    float* height; ///< m, before gullies
    float* field[k_node_fields];
    float* scratch[k_row_scratch];
};

inline constexpr int k_base_rows = k_sum_fields + 1 + k_node_fields + k_row_scratch;
/// A row of nodes in `memory`: k_base_rows rows of `stride` floats.
inline BaseRow base_row_in(float* memory, int stride) {
    const auto take = [&] {
        float* row = memory;
        memory += stride;
        return row;
    };
    BaseRow row{};
    for (float*& sum : row.sum) sum = take();
    row.height = take();
    for (float*& field : row.field) field = take();
    for (float*& scratch : row.scratch) scratch = take();
    return row;
}

/// Node fields at the samples of the middle pass; height is not read.
struct MidRow {
    const float* node[k_node_fields];
    float* out[k_mid_fields];
    float* scratch[k_row_scratch];
    bool has_dune, has_canyon, has_lake; ///< the weight is not zero everywhere in the block
};

/// A row of cells. Fields that no term of the block needs are null.
struct CellRow {
    const float* node[k_node_fields];
    const float* mid[k_mid_fields];
    float *rock, *soil, *sand, *water; ///< out, m
    float* scratch[k_row_scratch];
    bool has_dune, has_canyon, has_lake, has_stream;
};

SAHEL_HD bool sum_needed(const TerrainTables& t, SumField f) {
    const bool canyons = t.p.canyon_m > 0.0f && t.p.sea == 0;
    switch (f) {
    case SumField::continent:
        return t.p.sea != 0;
    case SumField::canyon:
        return canyons;
    case SumField::line:
        return canyons || t.p.wadi_m > 0.0f;
    case SumField::massif:
    case SumField::massif_x:
    case SumField::massif_y:
        return t.p.mountain_m > 0.0f;
    default:
        return true;
    }
}

struct TerrainKernels {
    /// Sums of out.sum that the landscape needs, see sum_needed.
    void (*sums)(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const SumRange& range,
                 const BaseRow& out);
    /// From the sums.
    void (*base)(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const BaseRow& out);
    void (*lakes)(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const LakeSite* sites,
                  int site_count, const BaseRow& out);
    /// After lakes: around streams nothing else carves, as at lakes.
    void (*streams)(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const StreamPiece* pieces,
                    int piece_count, const BaseRow& out);
    /// `above` and `below` are heights of the neighbouring rows; reads heights at -1 and n. `blended`: the nodes are
    /// no cells, so that what they carry also counts where their own weight is zero.
    void (*detail)(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const float* above,
                   const float* below, bool dunes, bool canyons, bool blended, const BaseRow& out);
    /// Reads `here` at -1 and n.
    void (*sharpen)(const float* above, const float* here, const float* below, int n, float* out);
    /// `weights` are the basis values of the row, `mixed` holds count + 3 floats. Writes count * per_interval samples:
    /// number e of interval i lies (e + offset) / per_interval behind node i + 1.
    void (*spline)(const float* const rows[4], const float weights[4], int count, int per_interval, float offset,
                   float* mixed, float* out);
    void (*middle)(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const MidRow& rows);
    void (*cells)(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const CellRow& rows);
    void (*ticks)(const float* metres, float stretch, int n, int32_t* ticks);
};

SAHEL_ISA_DECLARE(const TerrainKernels& terrain_kernels())

} // namespace sahel

/// Marks functions of the row headers. Those are included once per instruction set, inside its namespace, and once by
/// the CUDA launcher.
#if defined(__CUDACC__)
#define SAHEL_ROW __device__ inline
#else
#define SAHEL_ROW inline
#endif
