#include "streaming/selection.h"

#include <cmath>

namespace sahel {

bool goes_before(const Want& a, const Want& b) {
    if (a.group != b.group) return a.group < b.group;
    if (a.cost != b.cost) return a.cost < b.cost;
    if (a.key.level != b.key.level) return a.key.level > b.key.level;
    return a.key < b.key;
}

GroundSquare Selector::square(TileKey key, HeightRange heights) const {
    const double side = std::ldexp(static_cast<double>(settings_.view_cells) * cell_m_, key.level);
    return {static_cast<double>(key.x) * side, static_cast<double>(key.y) * side, side,
            static_cast<double>(heights.low), static_cast<double>(heights.high)};
}

TileKey Selector::root_of(const ViewState& view) const {
    const double side = std::ldexp(static_cast<double>(settings_.view_cells) * cell_m_, settings_.root_level);
    return {settings_.root_level, static_cast<int64_t>(std::floor(view.eye_m[0] / side)),
            static_cast<int64_t>(std::floor(view.eye_m[1] / side))};
}

bool Selector::wants_child(const ViewState& view, TileKey key, int quadrant) const {
    if (key.level == 0) return false;
    const GroundSquare q = square(key.child(quadrant), {0.0f, 0.0f});
    return lod_distance_m(view, q) < static_cast<double>(settings_.lod_factor) * q.side;
}

struct Selector::Walk {
    const Selector& selector;
    const ViewState& view;
    const NodePool& pool;
    const Frustum frustum;
    bool prefetch;
    std::vector<Want>& wants;

    void visit(TileKey key, HeightRange heights, bool visible, bool root) {
        if (const uint32_t slot = pool.find(key); slot != k_no_slot && pool.state[slot] == NodeState::resident)
            heights = {pool.low_m[slot], pool.high_m[slot]};
        const GroundSquare tile = selector.square(key, heights);
        const auto cost = static_cast<float>(lod_distance_m(view, tile) / tile.side);
        const WantGroup group = prefetch  ? WantGroup::prefetch
                                : root    ? WantGroup::urgent
                                : visible ? WantGroup::visible
                                          : WantGroup::around;
        wants.push_back({group, cost, key});
        if (key.level == 0) return;
        // A child may rise a little above what its parent's coarser lattice shows.
        const float margin = 1.0f + 0.01f * static_cast<float>(tile.side);
        const HeightRange wider{heights.low - margin, heights.high + margin};
        for (int q = 0; q < 4; ++q) {
            if (!selector.wants_child(view, key, q)) continue;
            const TileKey child = key.child(q);
            visit(child, wider, visible && frustum.may_see(selector.square(child, wider)), false);
        }
    }
};

void Selector::collect(const ViewState& view, const NodePool& pool, bool prefetch, std::vector<Want>& wants) const {
    Walk walk{*this, view, pool, Frustum(view), prefetch, wants};
    const TileKey centre = root_of(view);
    const HeightRange unknown{-500.0f, 9000.0f};
    for (int64_t dy = -settings_.root_radius; dy <= settings_.root_radius; ++dy)
        for (int64_t dx = -settings_.root_radius; dx <= settings_.root_radius; ++dx) {
            const TileKey root{centre.level, centre.x + dx, centre.y + dy};
            walk.visit(root, unknown, walk.frustum.may_see(square(root, unknown)), true);
        }
}

} // namespace sahel
