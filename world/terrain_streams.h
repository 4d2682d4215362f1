#pragma once

#include "world/terrain_rows.h"
#include "world/tile_key.h"

#include <cstdint>
#include <vector>

/// Streams of the base terrain: one that feeds a lake and, for most lakes, one that leaves it and seeps away.
///
/// A stream is a pure function of the site of its lake, like the lake itself: on a lattice of 128 m around the site the
/// land is flooded from the lake upwards (priority-flood, Barnes, Lehman and Mulla 2014), each place remembering the
/// lowest way down; the longest way that rises steadily becomes the stream, then meanders; for the one that leaves, the
/// other way round. Water falls all along a stream. Streams of two lakes never meet: each keeps to the places that are
/// nearer to its own site than to any other site, by a margin.
namespace sahel {

/// From its lake's site, a stream changes nothing beyond this.
inline constexpr auto k_stream_site_half_m = static_cast<int64_t>(2.0f * (k_stream_far_m + k_stream_reach_m)) + 1;

/// Whether cells of a level show streams.
bool has_streams(const TerrainTables& tables, int32_t level);

/// Appends the streams of one lake.
void plan_streams(const TerrainTables& tables, const TerrainKernels& kernels, const LakeSite& lake,
                  std::vector<StreamPiece>& pieces);

/// Streams of `lakes` that change a rectangle of cells of a level, in the order of their lakes.
void find_streams_near(const TerrainTables& tables, const TerrainKernels& kernels, int32_t level, const CellRect& rect,
                       const std::vector<LakeSite>& lakes, std::vector<StreamPiece>& pieces);

/// Whether a piece changes anything in the rectangle [x0, x1] x [y0, y1] of world half metres.
bool reaches(const StreamPiece& piece, int64_t x0, int64_t y0, int64_t x1, int64_t y1);

} // namespace sahel
