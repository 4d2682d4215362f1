#include "streaming/tile_streamer_impl.h"

#include <algorithm>

namespace sahel {

/// Roots that the view needs and that are not here; `may_come`: only those whose first load is still to end.
int TileStreamer::Impl::count_missing_roots(bool may_come) const {
    int missing = 0;
    selector.for_each_root(view, false, [&](TileKey root) {
        const uint32_t slot = pool.find(root);
        if (pool.is_resident(slot) || (may_come && slot != k_no_slot && pool.attempts[slot] > 0)) return;
        ++missing;
    });
    return missing;
}

/// The eye moves on when the ground is there: after a jump the last view stays until all roots of the new one have come
/// (or failed: then the ground has a hole, and the eye is not held for it).
void TileStreamer::Impl::choose_shown() {
    stats.missing_roots = count_missing_roots(false);
    is_held = has_shown && stats.missing_roots > 0 && count_missing_roots(true) > 0;
    stats.held = is_held;
    if (is_held) return;
    shown = view;
    has_shown = has_shown || stats.missing_roots == 0;
}

void TileStreamer::Impl::visit(uint32_t slot, const Frustum& frustum) {
    const TileKey key = pool.key[slot];
    const uint32_t parent = pool.parent[slot];
    VisibleTile tile;
    tile.key = key;
    tile.node = pool.handle(slot);
    tile.min_height_m = pool.low_m[slot];
    tile.max_height_m = pool.high_m[slot];
    if (parent != k_no_slot) {
        tile.parent = pool.handle(parent);
        const auto fade_s = static_cast<double>(settings.fade_s), age_s = time_s - pool.born_s[slot];
        if (age_s < fade_s) tile.fade = static_cast<float>(age_s / fade_s);
    }
    const HeightRange own{pool.low_m[slot], pool.high_m[slot]};
    const double side = selector.side_m(key.level);
    for (int q = 0; q < 4; ++q) {
        // Only what this frame wants: what is left over from another view must not change the picture.
        const bool finer = selector.wants_child(shown, key, q);
        uint32_t child = finer ? pool.find(key.child(q)) : k_no_slot;
        if (!pool.is_resident(child) || !wanted_now(child)) child = k_no_slot;
        GroundSquare square = selector.square(key, Selector::quadrant_heights(pool, own, side, child));
        square.side *= 0.5; // at level 0 too, where the quadrant is no tile
        square.x0 += (q & 1) * square.side;
        square.y0 += (q >> 1) * square.side;
        if (!frustum.may_see(square)) continue;
        if (child != k_no_slot) {
            visit(child, frustum);
            continue;
        }
        const auto bit = static_cast<uint8_t>(1 << q);
        tile.quadrant_mask |= bit;
        if (finer) {
            tile.fallback_mask |= bit;
            ++stats.fallbacks;
        }
    }
    if (tile.quadrant_mask == 0) return;
    drawn[slot] = 1;
    visible.push_back(tile);
}

void TileStreamer::Impl::select_visible() {
    visible.clear();
    std::fill(drawn.begin(), drawn.end(), uint8_t{0});
    const Frustum frustum(shown);
    selector.for_each_root(shown, false, [&](TileKey root) {
        const uint32_t slot = pool.find(root);
        if (pool.is_resident(slot)) visit(slot, frustum);
    });
    // Front to back: what is near hides what is far.
    for (VisibleTile& t : visible)
        visible_distance_m[t.node.slot] = lod_distance_m(shown, selector.square(t.key, {0, 0}));
    std::sort(visible.begin(), visible.end(), [&](const VisibleTile& a, const VisibleTile& b) {
        const double da = visible_distance_m[a.node.slot], db = visible_distance_m[b.node.slot];
        return da != db ? da < db : a.key < b.key;
    });
    stats.visible = static_cast<int>(visible.size());
}

void TileStreamer::Impl::count() {
    stats.nodes_in_state = pool.in_state();
    stats.loads_in_flight = loads_in_flight();
    stats.in_flight_bytes = in_flight_bytes;
    stats.payload_bytes = payload_bytes;
    stats.context_bytes = contexts.bytes();
    stats.slot_bytes =
        static_cast<uint64_t>(stats.nodes_in_state[static_cast<size_t>(NodeState::resident)]) * externals.slot_bytes;
    stats.oldest_request_frames = stats.oldest_visible_frames = 0;
    is_ready = stats.missing_roots == 0 && stats.unplaced == 0 &&
               (stats.fallbacks == 0 || stats.wanted_over_budget > 0) &&
               std::all_of(visible.begin(), visible.end(), [](const VisibleTile& t) { return t.fade >= 1.0f; });
    // An unwanted load that has just been published holds a slot that the next frame takes back.
    may_progress = !in_flight.empty() || !loaded_slots.empty() || stats.unplaced > 0;
    for (const VisibleTile& t : visible) may_progress |= t.fade < 1.0f;
    for (const uint32_t slot : wanted_slots) { // parents before children
        const NodeState s = pool.state(slot);
        const uint32_t parent = pool.parent[slot];
        const bool here = s == NodeState::resident;
        pool.blocked[slot] =
            !here && (s == NodeState::failed || (parent != k_no_slot && pool.blocked[parent] != 0)) ? 1 : 0;
        if (here && !is_stale(slot)) continue;
        const bool visible_group = wants[pool.rank[slot]].group <= WantGroup::visible;
        if (visible_group) is_ready = false;
        if (pool.blocked[slot] || (here && !may_reload(slot))) continue;
        if (visible_group) may_progress |= here || s == NodeState::retry_later;
        const int64_t age = stats.frame - pool.first_wanted_frame[slot];
        stats.oldest_request_frames = std::max(stats.oldest_request_frames, age);
        if (visible_group) stats.oldest_visible_frames = std::max(stats.oldest_visible_frames, age);
    }
}

} // namespace sahel
