#include "streaming/tile_streamer_impl.h"

#include <algorithm>
#include <cmath>

namespace sahel {

/// What the view that is still drawn shows: right after the roots of the new one, so that it stays whole.
void TileStreamer::Impl::collect_shown(size_t from) {
    for (size_t i = 0; i < from; ++i)
        if (wants[i].slot != k_no_slot) pool.listed_frame[wants[i].slot] = stats.frame;
    selector.collect(shown, pool, true, wants);
    const auto is_needless = [&](const Want& w) {
        return !pool.is_resident(w.slot) || pool.listed_frame[w.slot] == stats.frame;
    };
    wants.erase(std::remove_if(wants.begin() + static_cast<std::ptrdiff_t>(from), wants.end(), is_needless),
                wants.end());
    constexpr float k_after_roots = 1e6f; // of both views
    for (size_t i = from; i < wants.size(); ++i) {
        wants[i].group = WantGroup::urgent;
        wants[i].cost += (wants[i].key.level == settings.root_level ? 1.0f : 2.0f) * k_after_roots;
    }
}

void TileStreamer::Impl::collect_wants() {
    wants.clear();
    selector.collect(view, pool, false, wants);
    if (has_shown && count_missing_roots(true) > 0) collect_shown(wants.size());
    const auto& v = view.velocity_m_per_s;
    const auto ahead_s = static_cast<double>(settings.prefetch_s);
    const double ahead_m = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) * ahead_s;
    if (ahead_m > 0.05 * selector.side_m(0)) {
        ViewState next = view;
        for (size_t i = 0; i < 3; ++i) next.eye_m[i] += v[i] * ahead_s;
        // A climbing eye is taken to follow rising ground; a sinking one nears the ground.
        next.ground_m = std::max(view.ground_m, std::min(view.ground_m + v[2] * ahead_s, next.eye_m[2]));
        const size_t here = wants.size();
        selector.collect(next, pool, true, wants);
        // What is wanted here already goes first: it needs no second row.
        absent_keys.clear();
        for (size_t i = 0; i < here; ++i) {
            if (wants[i].slot == k_no_slot)
                absent_keys.push_back(wants[i].key);
            else
                pool.listed_frame[wants[i].slot] = stats.frame;
        }
        std::sort(absent_keys.begin(), absent_keys.end());
        const auto is_listed = [&](const Want& w) {
            if (w.slot != k_no_slot) return pool.listed_frame[w.slot] == stats.frame;
            return std::binary_search(absent_keys.begin(), absent_keys.end(), w.key);
        };
        wants.erase(std::remove_if(wants.begin() + static_cast<std::ptrdiff_t>(here), wants.end(), is_listed),
                    wants.end());
    }
    std::sort(wants.begin(), wants.end(), goes_before);
    stats.wanted = static_cast<int>(wants.size());
    // Under pressure the tail of the order goes: what is ahead or out of view first, then the finest detail. Contexts
    // count twice: while all tiles are renewed, children still hold the old ones of their parents.
    auto most = static_cast<uint64_t>(settings.slots);
    if (externals.max_context_bytes > 0)
        most = std::min(most, (static_cast<uint64_t>(settings.context_mib) << 20) / (2 * externals.max_context_bytes));
    stats.wanted_over_budget = static_cast<int>(wants.size() - std::min<uint64_t>(wants.size(), most));
    if (wants.size() > most) wants.resize(static_cast<size_t>(most));
}

void TileStreamer::Impl::release(uint32_t slot) {
    if (pool.state(slot) == NodeState::loaded) {
        payload_bytes -= pool.payload[slot]->bytes();
        in_flight_bytes -= externals.max_payload_bytes;
        std::erase(loaded_slots, slot);
    }
    pool.erase(slot);
}

/// Gives up a load that no worker has begun: its reservations are free at once.
bool TileStreamer::Impl::abandon(uint32_t slot) {
    if (lockstep || !pool.job[slot] || !pool.job[slot]->abandon()) return false;
    pool.job[slot].reset();
    landed(pool.sequence[slot]);
    in_flight_bytes -= externals.max_payload_bytes;
    ++stats.abandoned_total;
    return true;
}

/// The release queue: what nobody wants any more and has not begun gives its slot back at once, children first.
void TileStreamer::Impl::drop_unwanted() {
    for (size_t i = unsettled.size(); i-- > 0;) {
        const uint32_t slot = unsettled[i];
        if (wanted_now(slot) || pool.children[slot] != 0) continue;
        const NodeState s = pool.state(slot);
        if (s == NodeState::queued || s == NodeState::retry_later || s == NodeState::failed ||
            (s == NodeState::loading && abandon(slot))) {
            release(slot);
            ++stats.dropped;
        }
    }
}

/// Frees the slot of the least recently wanted tile that nobody wants and nothing hangs on.
bool TileStreamer::Impl::evict(bool dirty_ones, WantGroup group) {
    for (uint32_t slot = pool.oldest(); slot != k_no_slot; slot = pool.newer(slot)) {
        if (wanted_now(slot)) return false; // and so are all that are newer
        // Against thrashing: what is not visible now waits until the old tile has been idle for a while.
        if (group > WantGroup::visible && time_s - pool.wanted_s[slot] < static_cast<double>(settings.keep_s))
            return false;
        const NodeState s = pool.state(slot);
        if (pool.children[slot] != 0 || (pool.dirty[slot] != 0) != dirty_ones) continue;
        if (s == NodeState::loaded) {
            release(slot);
            ++stats.dropped;
            return true;
        }
        if (s != NodeState::resident) continue;
        if (pool.reloading[slot]) {
            if (!abandon(slot)) continue;
            pool.reloading[slot] = 0;
        }
        const NodeHandle handle = pool.handle(slot);
        const TileKey key = pool.key[slot];
        if (dirty_ones) {
            if (!externals.commit || !externals.commit(handle, key)) continue;
            --dirty_tiles;
        }
        release(slot);
        ++stats.evicted;
        ++stats.evicted_total;
        if (externals.evicted) externals.evicted(handle, key);
        return true;
    }
    return false;
}

bool TileStreamer::Impl::make_room(WantGroup group) {
    return evict(false, group) || (dirty_tiles > 0 && evict(true, group));
}

void TileStreamer::Impl::place_wants() {
    // From the last want to the first, so that the list by age ends in the order of the wants.
    for (size_t i = wants.size(); i-- > 0;) {
        const uint32_t slot = wants[i].slot;
        if (slot == k_no_slot) continue;
        pool.touch(slot);
        if (pool.wanted_frame[slot] != stats.frame - 1) pool.first_wanted_frame[slot] = stats.frame;
        pool.wanted_frame[slot] = stats.frame;
        pool.wanted_s[slot] = time_s;
        pool.rank[slot] = static_cast<uint32_t>(i);
    }
    drop_unwanted();
    std::erase_if(unsettled, [&](uint32_t slot) {
        return pool.state(slot) == NodeState::absent || pool.state(slot) == NodeState::resident;
    });
    wanted_slots.clear();
    stats.unplaced = 0;
    bool is_full = false; // who comes later finds no room either
    for (size_t i = 0; i < wants.size(); ++i) {
        Want& want = wants[i];
        if (want.slot == k_no_slot) {
            uint32_t parent = k_no_slot;
            const bool root = want.key.level == settings.root_level;
            if (!root) parent = pool.find(want.key.parent());
            const bool has_parent = root || parent != k_no_slot; // no slot for the parent: none for the child
            if (has_parent && !is_full) is_full = pool.free_slots() == 0 && !make_room(want.group);
            if (!has_parent || is_full) {
                if (want.group <= WantGroup::visible) ++stats.unplaced;
                continue;
            }
            const uint32_t slot = want.slot = pool.insert(want.key, parent);
            pool.wanted_frame[slot] = pool.first_wanted_frame[slot] = stats.frame;
            pool.wanted_s[slot] = time_s;
            pool.rank[slot] = static_cast<uint32_t>(i);
            pool.wanted_epoch[slot] = epoch;
            unsettled.push_back(slot);
        }
        if (pool.state(want.slot) == NodeState::retry_later && time_s >= pool.retry_s[want.slot])
            pool.set_state(want.slot, NodeState::queued);
        wanted_slots.push_back(want.slot);
    }
}

} // namespace sahel
