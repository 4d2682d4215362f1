#pragma once

#include "render/view_tile.h"
#include "streaming/streamer.h"
#include "streaming/view_geometry.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

/// From visible tiles to CDLOD nodes: squares of 32 x 32 quads. A node of level k is a quadrant of a tile (corners
/// every 8 cells); near the eye a quadrant of a level 0 tile is split twice more (corners every 4 and 2 cells).
///
/// Node of side s: morphs from A = s (F + sqrt 2) to B = 2 F s. A border between sides s and 2s lies at least 2 F s and
/// at most 2 F s + 2 sqrt 2 s from the eye: there the fine side is all coarse and the coarse side has not begun.
///
///       eye            A(s)    B(s) = 2 F s        A(2s)      B(2s)
///        |-- side s ----|~ morph ~|                  |~ morph ~|
///        |                 |------- side 2s ---------------|       split and morph use one metric: the level distance
///                        2 F s                                     to a point, and the eye's height over smooth ground
namespace sahel {

inline constexpr int k_node_quads = 32;

/// Vertex attributes of one instance; see terrain.vert.
struct NodeInstance {
    std::array<int32_t, 4> node;   ///< first corner in level 0 cells from the eye's cell, step, layer
    std::array<int32_t, 4> own;    ///< lattice: first value, stride, corner x, y
    std::array<int32_t, 4> coarse; ///< first value -1: none
    std::array<float, 4> params;   ///< morph start and end, skirt, forced morph
    std::array<float, 4> place;    ///< cell of the tile at the first corner, cells per step, level
};
static_assert(sizeof(NodeInstance) == 80);

/// Values of one slot in the height buffer: ground lattices fine to coarse, then water lattices.
inline constexpr int k_lattice_values = 257 * 257 + 129 * 129 + 65 * 65;
inline constexpr int k_slot_values = 2 * k_lattice_values;
inline constexpr std::array<int, k_lattice_count> k_lattice_offset = {0, 257 * 257, 257 * 257 + 129 * 129};

struct NodeSettings {
    double cell_m = 1.0;
    float lod_factor = 2.1f;
    double eye_above_ground_m = 0.0;
    bool skirts = false;
    const Frustum* frustum = nullptr; ///< nodes that it does not see are left out; null: all are wanted
};

/// Appends the nodes of the tiles. `eye_cell` is the level 0 cell of the eye. Returns the number of nodes.
int select_nodes(std::span<const VisibleTile> tiles, const std::array<double, 2>& eye_m, const NodeSettings& settings,
                 std::vector<NodeInstance>& nodes);

} // namespace sahel
