#include "streaming/tile_streamer_impl.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sahel {

const char* name_of(NodeState state) {
    static constexpr std::array<const char*, 7> k_names = {"absent",   "queued",      "loading", "loaded",
                                                           "resident", "retry_later", "failed"};
    return k_names[static_cast<size_t>(state)];
}

TileStreamer::Impl::Impl(const StreamSettings& s, StreamExternals e)
    : settings(s), externals(std::move(e)), pool(s.slots), selector(settings, externals.cell_m),
      mailbox(std::make_shared<LoadMailbox>(externals.load)) {
    visible_distance_m.resize(static_cast<size_t>(s.slots));
    drawn.resize(static_cast<size_t>(s.slots));
}

TileStreamer::TileStreamer(const StreamSettings& settings, StreamExternals externals) {
    SAHEL_CHECK(externals.load && externals.publish && externals.submit);
    if (const Status checked = check_stream(settings, externals); !checked.ok())
        check_failed(__FILE__, __LINE__, "settings can be kept (see check_stream)", checked.error().message);
    impl_ = std::make_unique<Impl>(settings, std::move(externals));
}

TileStreamer::~TileStreamer() {
    impl_->mailbox->close();
}

FrameResult TileStreamer::update(const ViewState& view, double dt_s) {
    Impl& s = *impl_;
    for (size_t i = 0; i < 3; ++i) {
        SAHEL_CHECK(std::isfinite(view.eye_m[i]));
        SAHEL_CHECK(std::isfinite(view.velocity_m_per_s[i]));
    }
    SAHEL_CHECK(std::isfinite(view.ground_m));
    SAHEL_CHECK_LE(0.0, dt_s);
    ++s.stats.frame;
    s.stats.published = s.stats.evicted = s.stats.dropped = s.stats.fallbacks = 0;
    s.stats.published_bytes = 0;
    s.time_s += dt_s;
    s.view = view;
    s.collect_wants();
    s.place_wants();
    s.take_arrived();
    s.publish_loaded();
    s.start_loads();
    s.choose_shown();
    s.select_visible();
    s.count();
    return frame();
}

FrameResult TileStreamer::frame() const {
    return {impl_->visible, impl_->stats, impl_->shown};
}

bool TileStreamer::ready() const {
    return impl_->is_ready;
}

bool TileStreamer::settle(const ViewState& view) {
    Impl& s = *impl_;
    s.lockstep = true;
    const bool settled = s.settle(*this, view);
    s.lockstep = false;
    s.awaited = 0;
    return settled;
}

/// In lockstep: every update but the first takes the oldest load alone, however many have arrived. So what is started
/// after it depends on nothing but the requests before it.
bool TileStreamer::Impl::settle(TileStreamer& self, const ViewState& wanted) {
    double dt_s = 0.0;
    auto left_from_before = in_flight.size(); // taken first: what was started ahead must get on, too
    awaited = 0;
    for (int idle = 0; idle < 4;) { // a frame that starts what was waiting is not idle
        self.update(wanted, dt_s);
        if (is_ready && left_from_before == 0) return true;
        if (!may_progress) return false;
        left_from_before -= left_from_before > 0 ? 1 : 0;
        idle = in_flight.empty() && loaded_slots.empty() ? idle + 1 : 0;
        dt_s = static_cast<double>(settings.fade_s); // what has appeared has eased in by the next frame
        awaited = in_flight.empty() ? 0 : in_flight.front();
        if (in_flight.empty() && loaded_slots.empty()) { // only retries are left: go to the first of them
            double next_s = std::numeric_limits<double>::infinity();
            for (const uint32_t slot : wanted_slots)
                if (pool.state(slot) == NodeState::retry_later || (pool.is_resident(slot) && may_reload(slot)))
                    next_s = std::min(next_s, pool.retry_s[slot]);
            if (std::isfinite(next_s)) dt_s = std::max(dt_s, next_s - time_s);
        }
    }
    return false;
}

void TileStreamer::invalidate(TileKey key) {
    Impl& s = *impl_;
    const uint32_t slot = s.pool.find(key);
    if (slot == k_no_slot) return;
    s.pool.wanted_epoch[slot] = ++s.epoch;
    s.pool.first_wanted_frame[slot] = s.stats.frame;
    s.pool.attempts[slot] = 0;
    s.pool.retry_s[slot] = s.time_s;
    if (s.pool.state(slot) == NodeState::failed) s.pool.set_state(slot, NodeState::queued);
}

void TileStreamer::invalidate_all() {
    Impl& s = *impl_;
    ++s.epoch;
    for (uint32_t slot = 0; slot < static_cast<uint32_t>(s.pool.slots()); ++slot) {
        if (s.pool.state(slot) == NodeState::absent) continue;
        s.pool.wanted_epoch[slot] = s.epoch;
        s.pool.first_wanted_frame[slot] = s.stats.frame;
        s.pool.attempts[slot] = 0;
        s.pool.retry_s[slot] = s.time_s;
        if (s.pool.state(slot) == NodeState::failed) s.pool.set_state(slot, NodeState::queued);
    }
}

void TileStreamer::set_dirty(TileKey key, bool dirty) {
    Impl& s = *impl_;
    const uint32_t slot = s.pool.find(key);
    if (!s.pool.is_resident(slot)) return;
    s.dirty_tiles += static_cast<int>(dirty) - static_cast<int>(s.pool.dirty[slot] != 0);
    s.pool.dirty[slot] = dirty ? 1 : 0;
}

const StreamSettings& TileStreamer::settings() const {
    return impl_->settings;
}

const StreamStats& TileStreamer::stats() const {
    return impl_->stats;
}

bool TileStreamer::is_current(NodeHandle handle) const {
    return impl_->pool.is_current(handle);
}

void TileStreamer::list_nodes(std::vector<NodeInfo>& nodes) const {
    nodes.clear();
    for (uint32_t slot = 0; slot < static_cast<uint32_t>(impl_->pool.slots()); ++slot)
        if (impl_->pool.state(slot) != NodeState::absent)
            nodes.push_back({impl_->pool.key[slot], impl_->pool.state(slot), impl_->drawn[slot] != 0});
}

void TileStreamer::record_requests(bool on) {
    impl_->recording = on;
}

const std::vector<TileKey>& TileStreamer::requests() const {
    return impl_->requests;
}

} // namespace sahel
