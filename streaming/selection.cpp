#include "streaming/selection.h"

#include <algorithm>
#include <cmath>

namespace sahel {

namespace {
constexpr HeightRange k_unknown_heights{-16384.0f, 16384.0f}; // what ticks can hold
}

bool goes_before(const Want& a, const Want& b) {
    if (a.group != b.group) return a.group < b.group;
    if (a.cost != b.cost) return a.cost < b.cost;
    if (a.key.level != b.key.level) return a.key.level > b.key.level;
    return a.key < b.key;
}

Selector::Selector(const StreamSettings& settings, double cell_m)
    : settings_(settings),
      lod_factor2_(static_cast<double>(settings.lod_factor) * static_cast<double>(settings.lod_factor)) {
    for (size_t k = 0; k < side_m_.size(); ++k)
        side_m_[k] = std::ldexp(static_cast<double>(settings.view_cells) * cell_m, static_cast<int>(k));
}

GroundSquare Selector::square(TileKey key, HeightRange heights) const {
    const double side = side_m(key.level);
    return {static_cast<double>(key.x) * side, static_cast<double>(key.y) * side, side,
            static_cast<double>(heights.low), static_cast<double>(heights.high)};
}

bool Selector::wants_child(const ViewState& view, TileKey key, int quadrant) const {
    if (key.level == 0) return false;
    const GroundSquare q = square(key.child(quadrant), {0.0f, 0.0f});
    return lod_distance2_m2(view, q) < lod_factor2_ * q.side * q.side;
}

HeightRange Selector::quadrant_heights(const NodePool& pool, HeightRange tile, double tile_side_m,
                                       uint32_t child_slot) {
    const float margin = 1.0f + 0.01f * static_cast<float>(tile_side_m);
    HeightRange range{tile.low - margin, tile.high + margin};
    if (pool.is_resident(child_slot))
        range = {std::min(range.low, pool.low_m[child_slot]), std::max(range.high, pool.high_m[child_slot])};
    return range;
}

struct Selector::Walk {
    const Selector& selector;
    const ViewState& view;
    const NodePool& pool;
    const Frustum frustum;
    bool prefetch;
    std::vector<Want>& wants;

    void visit(TileKey key, uint32_t slot, HeightRange heights, bool visible, bool root) {
        if (pool.is_resident(slot)) heights = {pool.low_m[slot], pool.high_m[slot]};
        const GroundSquare tile = selector.square(key, heights);
        const auto cost = static_cast<float>(lod_distance_m(view, tile) / tile.side);
        const WantGroup group = prefetch  ? WantGroup::prefetch
                                : root    ? WantGroup::urgent
                                : visible ? WantGroup::visible
                                          : WantGroup::around;
        wants.push_back({group, cost, key, slot});
        for (int q = 0; q < 4; ++q) {
            if (!selector.wants_child(view, key, q)) continue;
            const TileKey child = key.child(q);
            const uint32_t child_slot = pool.find(child);
            const HeightRange range = quadrant_heights(pool, heights, tile.side, child_slot);
            visit(child, child_slot, range, visible && !prefetch && frustum.may_see(selector.square(child, range)),
                  false);
        }
    }
};

void Selector::collect(const ViewState& view, const NodePool& pool, bool prefetch, std::vector<Want>& wants) const {
    Walk walk{*this, view, pool, Frustum(view), prefetch, wants};
    for_each_root(view, true, [&](TileKey root) { walk.visit(root, pool.find(root), k_unknown_heights, true, true); });
}

} // namespace sahel
