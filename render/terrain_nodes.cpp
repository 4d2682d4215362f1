#include "render/terrain_nodes.h"

#include <algorithm>
#include <cmath>

namespace sahel {

namespace {

constexpr float k_sqrt2 = 1.41421356f;

struct Builder {
    const NodeSettings& settings;
    int64_t eye_x, eye_y; // level 0 cell
    double eye_x_m, eye_y_m;
    std::vector<NodeInstance>& nodes;

    /// Distance from the eye to a square given in level 0 cells, with the height above ground as vertical part.
    [[nodiscard]] double distance_m(int64_t x, int64_t y, int64_t side) const {
        const double x0 = static_cast<double>(x) * settings.cell_m - eye_x_m,
                     x1 = x0 + static_cast<double>(side) * settings.cell_m;
        const double y0 = static_cast<double>(y) * settings.cell_m - eye_y_m,
                     y1 = y0 + static_cast<double>(side) * settings.cell_m;
        const double dx = std::max({x0, -x1, 0.0}), dy = std::max({y0, -y1, 0.0});
        const double dz = settings.eye_above_ground_m;
        return std::sqrt(dx * dx + dy * dy + dz * dz);
    }

    /// A new tile eases in from its parent's shape. At level 0 it does so lattice by lattice, each from the one before.
    static float ease(const VisibleTile& tile) { return tile.fade * (tile.key.level == 0 ? 3.0f : 1.0f); }
    static int finest_lattice(const VisibleTile& tile) { return std::max(0, 2 - static_cast<int>(ease(tile))); }
    static float forced_morph(const VisibleTile& tile, int lattice) {
        if (tile.fade >= 1.0f || lattice > finest_lattice(tile)) return 0.0f;
        return 1.0f - (ease(tile) - std::floor(ease(tile)));
    }

    /// Whether any of a square that starts at a cell of the tile may be seen.
    [[nodiscard]] bool seen(const VisibleTile& tile, int cell_x, int cell_y, double side_m) const {
        if (!settings.frustum) return true;
        const double cell_m = std::ldexp(settings.cell_m, tile.key.level);
        const auto at = [&](int64_t key, int cell) {
            return (static_cast<double>(key * k_view_cells) + cell) * cell_m;
        };
        const double slack = 0.05 * side_m; // the parent's shape while this one morphs, and skirts
        return settings.frustum->may_see({at(tile.key.x, cell_x), at(tile.key.y, cell_y), side_m,
                                          static_cast<double>(tile.min_height_m) - slack,
                                          static_cast<double>(tile.max_height_m) + slack});
    }

    void add(const VisibleTile& tile, int lattice, int corner_x, int corner_y) {
        const int level = tile.key.level;
        const int64_t tile_x = tile.key.x * k_view_cells << level, tile_y = tile.key.y * k_view_cells << level;
        const int spacing = k_lattice_spacing[static_cast<size_t>(lattice)]; // cells of the level
        const int64_t step = static_cast<int64_t>(spacing) << level;
        const double side_m = static_cast<double>(step) * k_node_quads * settings.cell_m;
        const auto f = static_cast<double>(settings.lod_factor);
        if (!seen(tile, corner_x * spacing, corner_y * spacing, side_m)) return;
        NodeInstance n{};
        n.node = {static_cast<int32_t>(tile_x + corner_x * step - eye_x),
                  static_cast<int32_t>(tile_y + corner_y * step - eye_y), static_cast<int32_t>(step),
                  static_cast<int32_t>(tile.node.slot)};
        const auto base = static_cast<int32_t>(tile.node.slot) * k_slot_values;
        const auto i = static_cast<size_t>(lattice);
        n.own = {base + k_lattice_offset[i], k_lattice_side[i], corner_x, corner_y};
        if (lattice < 2) { // the next lattice of the same tile
            n.coarse = {base + k_lattice_offset[i + 1], k_lattice_side[i + 1], corner_x / 2, corner_y / 2};
        } else if (tile.parent) {
            const int child = tile.key.child_index();
            n.coarse = {static_cast<int32_t>(tile.parent.slot) * k_slot_values + k_lattice_offset[2], k_lattice_side[2],
                        corner_x / 2 + (child & 1) * k_node_quads, corner_y / 2 + (child >> 1) * k_node_quads};
        } else {
            n.coarse = {-1, 0, 0, 0};
        }
        n.params = {static_cast<float>(side_m * (f + k_sqrt2)), static_cast<float>(2.0 * f * side_m),
                    settings.skirts ? static_cast<float>(side_m * 0.04) : 0.0f, forced_morph(tile, lattice)};
        n.place = {static_cast<float>(corner_x * spacing), static_cast<float>(corner_y * spacing),
                   static_cast<float>(spacing), static_cast<float>(level)};
        nodes.push_back(n);
    }

    /// Splits a node of a level 0 tile while the eye is near.
    void split(const VisibleTile& tile, int lattice, int corner_x, int corner_y) {
        const int64_t side = static_cast<int64_t>(k_lattice_spacing[static_cast<size_t>(lattice)]) * k_node_quads;
        const int spacing = k_lattice_spacing[static_cast<size_t>(lattice)];
        const double d = distance_m(tile.key.x * k_view_cells + corner_x * spacing,
                                    tile.key.y * k_view_cells + corner_y * spacing, side);
        if (lattice == 0 || lattice <= finest_lattice(tile) ||
            d >= static_cast<double>(settings.lod_factor) * static_cast<double>(side) * settings.cell_m) {
            add(tile, lattice, corner_x, corner_y);
            return;
        }
        for (int c = 0; c < 4; ++c)
            split(tile, lattice - 1, 2 * corner_x + (c & 1) * k_node_quads, 2 * corner_y + (c >> 1) * k_node_quads);
    }
};

} // namespace

int select_nodes(std::span<const VisibleTile> tiles, const std::array<double, 2>& eye_m, const NodeSettings& settings,
                 std::vector<NodeInstance>& nodes) {
    const size_t before = nodes.size();
    Builder b{settings,
              static_cast<int64_t>(std::floor(eye_m[0] / settings.cell_m)),
              static_cast<int64_t>(std::floor(eye_m[1] / settings.cell_m)),
              eye_m[0],
              eye_m[1],
              nodes};
    for (const VisibleTile& tile : tiles)
        for (int q = 0; q < 4; ++q) {
            if (!((tile.quadrant_mask >> q) & 1)) continue;
            const int x = (q & 1) * k_node_quads, y = (q >> 1) * k_node_quads;
            if (tile.key.level == 0)
                b.split(tile, 2, x, y);
            else
                b.add(tile, 2, x, y);
        }
    return static_cast<int>(nodes.size() - before);
}

} // namespace sahel
