#include "streaming/selection.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>

namespace sahel {

const char* name_of(NodeState state) {
    static constexpr std::array<const char*, 7> k_names = {"absent",   "queued",      "loading", "loaded",
                                                           "resident", "retry_later", "failed"};
    return k_names[static_cast<size_t>(state)];
}

namespace {

/// What a worker hands back. `sequence` tells a live result from one whose node has gone.
struct Completion {
    uint32_t slot;
    uint64_t sequence;
    Result<std::unique_ptr<TilePayload>> result;
};

/// Shared with the jobs, so that a job that runs late finds something to talk to.
struct Mailbox {
    std::function<Result<std::unique_ptr<TilePayload>>(TileKey, const std::shared_ptr<const TileContext>&)> load;
    std::mutex mutex;
    std::condition_variable changed;
    std::vector<Completion> done;
    int running = 0;
    bool closed = false;
};

} // namespace

struct TileStreamer::Impl {
    Impl(const StreamSettings& s, StreamExternals e)
        : settings(s), externals(std::move(e)), pool(s.slots), selector(settings, externals.cell_m),
          mailbox(std::make_shared<Mailbox>()) {
        mailbox->load = externals.load;
    }

    StreamSettings settings;
    StreamExternals externals;
    NodePool pool;
    Selector selector;
    std::shared_ptr<Mailbox> mailbox;

    ViewState view;
    double time_s = 0.0;
    uint64_t next_sequence = 1;
    uint64_t epoch = 1;
    uint64_t in_flight_bytes = 0;
    uint64_t context_bytes = 0;
    int loads_in_flight = 0;
    StreamStats stats;
    std::vector<Want> wants;
    std::vector<uint32_t> wanted_slots; ///< of this frame, in order
    std::vector<uint32_t> loaded_slots;
    std::vector<Completion> arrived;
    std::vector<VisibleTile> visible;
    std::vector<uint8_t> drawn; ///< by slot, this frame
    bool recording = false;
    std::vector<TileKey> requests;
    bool is_ready = false;

    void collect_wants();
    void take_completions();
    void drop_stale();
    bool make_room();
    void place_wants();
    void start_loads();
    void start(uint32_t slot);
    void publish_loaded();
    void publish(uint32_t slot);
    void fail(uint32_t slot);
    void select_visible();
    void visit(TileKey key, const Frustum& frustum);
    void count();
    [[nodiscard]] bool wanted_now(uint32_t slot) const { return pool.wanted_frame[slot] == stats.frame; }
    void release(uint32_t slot) {
        context_bytes -= pool.context_bytes[slot];
        pool.erase(slot);
    }
};

void TileStreamer::Impl::collect_wants() {
    wants.clear();
    selector.collect(view, pool, false, wants);
    const auto& v = view.velocity_m_per_s;
    const double ahead = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) * static_cast<double>(settings.prefetch_s);
    const double cell = externals.cell_m * static_cast<double>(settings.view_cells);
    if (ahead > 0.05 * cell) {
        ViewState next = view;
        for (size_t i = 0; i < 3; ++i) next.eye_m[i] += v[i] * static_cast<double>(settings.prefetch_s);
        next.ground_m = std::min(next.ground_m + v[2] * static_cast<double>(settings.prefetch_s), next.eye_m[2]);
        next.ground_m = std::max(next.ground_m, view.ground_m);
        selector.collect(next, pool, true, wants);
        // One entry a key: the one that goes first.
        std::sort(wants.begin(), wants.end(),
                  [](const Want& a, const Want& b) { return a.key != b.key ? a.key < b.key : goes_before(a, b); });
        wants.erase(
            std::unique(wants.begin(), wants.end(), [](const Want& a, const Want& b) { return a.key == b.key; }),
            wants.end());
    }
    std::sort(wants.begin(), wants.end(), goes_before);
    stats.wanted = static_cast<int>(wants.size());
    stats.wanted_over_budget = std::max(0, stats.wanted - settings.slots);
    if (wants.size() > static_cast<size_t>(settings.slots)) wants.resize(static_cast<size_t>(settings.slots));
}

void TileStreamer::Impl::take_completions() {
    {
        const std::lock_guard lock(mailbox->mutex);
        arrived.swap(mailbox->done);
    }
    // Workers finish in any order; from here on only the order of the requests counts.
    std::sort(arrived.begin(), arrived.end(),
              [](const Completion& a, const Completion& b) { return a.sequence < b.sequence; });
    for (Completion& c : arrived) {
        --loads_in_flight;
        const bool live = pool.state[c.slot] != NodeState::absent && pool.sequence[c.slot] == c.sequence;
        if (!live || !c.result.ok()) {
            in_flight_bytes -= externals.max_payload_bytes;
            if (live) fail(c.slot);
            continue;
        }
        SAHEL_CHECK_LE((*c.result)->bytes(), externals.max_payload_bytes);
        pool.payload[c.slot] = std::move(c.result).value();
        if (!pool.reloading[c.slot]) pool.state[c.slot] = NodeState::loaded;
        loaded_slots.push_back(c.slot);
    }
    arrived.clear();
}

void TileStreamer::Impl::fail(uint32_t slot) {
    ++stats.failed_total;
    ++pool.attempts[slot];
    pool.time_s[slot] = time_s + static_cast<double>(settings.retry_after_s);
    if (pool.reloading[slot]) { // the old contents stay; try again later
        pool.reloading[slot] = 0;
        if (pool.attempts[slot] >= settings.max_attempts) pool.wanted_epoch[slot] = pool.epoch[slot];
        return;
    }
    pool.state[slot] = pool.attempts[slot] >= settings.max_attempts ? NodeState::failed : NodeState::retry_later;
}

/// Requests that nobody wants any more and that have not begun give their slots back at once (children first).
void TileStreamer::Impl::drop_stale() {
    for (uint32_t slot = pool.oldest(); slot != k_no_slot;) {
        if (wanted_now(slot)) break; // the rest of the list was touched this frame
        const uint32_t next = pool.newer(slot);
        const NodeState s = pool.state[slot];
        if ((s == NodeState::queued || s == NodeState::retry_later || s == NodeState::failed) &&
            pool.children[slot] == 0) {
            release(slot);
            ++stats.dropped;
        }
        slot = next;
    }
}

/// Frees one slot: the least recently wanted tile without children that this frame does not want.
bool TileStreamer::Impl::make_room() {
    for (uint32_t slot = pool.oldest(); slot != k_no_slot; slot = pool.newer(slot)) {
        if (wanted_now(slot)) return false;
        if (pool.state[slot] != NodeState::resident || pool.children[slot] != 0 || pool.reloading[slot]) continue;
        const NodeHandle handle = pool.handle(slot);
        const TileKey key = pool.key[slot];
        release(slot);
        ++stats.evicted;
        ++stats.evicted_total;
        if (externals.evicted) externals.evicted(handle, key);
        return true;
    }
    return false;
}

void TileStreamer::Impl::place_wants() {
    wanted_slots.clear();
    // First mark what is here, from the last want to the first, so that the list by age ends in wanted order.
    for (size_t i = wants.size(); i-- > 0;) {
        const uint32_t slot = pool.find(wants[i].key);
        if (slot == k_no_slot) continue;
        pool.touch(slot);
        pool.wanted_frame[slot] = stats.frame;
        pool.rank[slot] = static_cast<uint32_t>(i);
    }
    drop_stale();
    for (size_t i = 0; i < wants.size(); ++i) {
        const TileKey key = wants[i].key;
        uint32_t slot = pool.find(key);
        if (slot == k_no_slot) {
            uint32_t parent = k_no_slot;
            if (key.level < settings.root_level) {
                parent = pool.find(key.parent());
                if (parent == k_no_slot) continue; // no slot for the parent: none for the child
            }
            if (pool.free_slots() == 0 && !make_room()) continue;
            slot = pool.insert(key);
            pool.parent[slot] = parent;
            if (parent != k_no_slot) ++pool.children[parent];
            pool.wanted_frame[slot] = stats.frame;
            pool.rank[slot] = static_cast<uint32_t>(i);
            pool.first_wanted_frame[slot] = stats.frame;
            pool.wanted_epoch[slot] = epoch;
        }
        if (pool.state[slot] == NodeState::retry_later && time_s >= pool.time_s[slot])
            pool.state[slot] = NodeState::queued;
        wanted_slots.push_back(slot);
    }
}

void TileStreamer::Impl::start(uint32_t slot) {
    const uint64_t sequence = next_sequence++;
    pool.sequence[slot] = sequence;
    if (pool.state[slot] == NodeState::resident)
        pool.reloading[slot] = 1;
    else
        pool.state[slot] = NodeState::loading;
    pool.load_epoch[slot] = pool.wanted_epoch[slot];
    in_flight_bytes += externals.max_payload_bytes;
    ++loads_in_flight;
    if (recording) requests.push_back(pool.key[slot]);
    const uint32_t parent = pool.parent[slot];
    std::shared_ptr<const TileContext> context = parent == k_no_slot ? nullptr : pool.context[parent];
    externals.submit([box = mailbox, slot, sequence, key = pool.key[slot], context = std::move(context)] {
        {
            const std::lock_guard lock(box->mutex);
            if (box->closed) return;
            ++box->running;
        }
        Completion done{slot, sequence, box->load(key, context)};
        const std::lock_guard lock(box->mutex);
        --box->running;
        box->done.push_back(std::move(done));
        box->changed.notify_all();
    });
}

void TileStreamer::Impl::start_loads() {
    const uint64_t budget = static_cast<uint64_t>(settings.in_flight_mib) << 20;
    for (const uint32_t slot : wanted_slots) {
        const bool fresh = pool.state[slot] == NodeState::queued;
        const bool again = pool.state[slot] == NodeState::resident && !pool.reloading[slot] &&
                           pool.epoch[slot] != pool.wanted_epoch[slot] && time_s >= pool.time_s[slot];
        if (!fresh && !again) continue;
        const uint32_t parent = pool.parent[slot];
        // A child needs its parent's context, and the newest one.
        if (parent != k_no_slot &&
            (pool.state[parent] != NodeState::resident || pool.epoch[parent] != pool.wanted_epoch[parent]))
            continue;
        if (loads_in_flight >= settings.max_loads_in_flight || in_flight_bytes + externals.max_payload_bytes > budget)
            return;
        start(slot);
    }
}

void TileStreamer::Impl::publish(uint32_t slot) {
    TilePayload& payload = *pool.payload[slot];
    const uint64_t bytes = payload.bytes();
    externals.publish(pool.handle(slot), pool.key[slot], payload);
    context_bytes -= pool.context_bytes[slot];
    pool.context[slot] = payload.context();
    pool.context_bytes[slot] = pool.context[slot] ? pool.context[slot]->bytes() : 0;
    context_bytes += pool.context_bytes[slot];
    pool.low_m[slot] = payload.min_height_m();
    pool.high_m[slot] = payload.max_height_m();
    if (pool.reloading[slot]) {
        pool.reloading[slot] = 0;
    } else {
        pool.state[slot] = NodeState::resident;
        pool.time_s[slot] = time_s;
    }
    pool.epoch[slot] = pool.load_epoch[slot]; // older than wanted when it changed again meanwhile
    pool.attempts[slot] = 0;
    pool.payload[slot].reset();
    in_flight_bytes -= externals.max_payload_bytes;
    ++stats.published;
    ++stats.published_total;
    stats.published_bytes += bytes;
}

void TileStreamer::Impl::publish_loaded() {
    // Wanted ones first, in the order of the wants; then the rest, oldest request first.
    std::sort(loaded_slots.begin(), loaded_slots.end(), [&](uint32_t a, uint32_t b) {
        const bool wa = wanted_now(a), wb = wanted_now(b);
        if (wa != wb) return wa;
        if (wa && pool.rank[a] != pool.rank[b]) return pool.rank[a] < pool.rank[b];
        return pool.sequence[a] < pool.sequence[b];
    });
    const double begin = externals.now_s ? externals.now_s() : 0.0;
    const uint64_t byte_limit = static_cast<uint64_t>(settings.publish_mib_per_frame) << 20;
    size_t taken = 0;
    while (taken < loaded_slots.size() && stats.published < settings.publishes_per_frame) {
        const uint32_t slot = loaded_slots[taken];
        if (stats.published > 0 && stats.published_bytes + pool.payload[slot]->bytes() > byte_limit) break;
        publish(slot);
        ++taken;
        if (externals.now_s && (externals.now_s() - begin) * 1e3 >= static_cast<double>(settings.publish_ms_per_frame))
            break;
    }
    loaded_slots.erase(loaded_slots.begin(), loaded_slots.begin() + static_cast<std::ptrdiff_t>(taken));
}

void TileStreamer::Impl::visit(TileKey key, const Frustum& frustum) {
    const uint32_t slot = pool.find(key);
    VisibleTile tile;
    tile.key = key;
    tile.node = pool.handle(slot);
    if (pool.parent[slot] != k_no_slot) tile.parent = pool.handle(pool.parent[slot]);
    tile.min_height_m = pool.low_m[slot];
    tile.max_height_m = pool.high_m[slot];
    if (settings.fade_s > 0.0f && pool.parent[slot] != k_no_slot)
        tile.fade = static_cast<float>(
            std::clamp((time_s - pool.time_s[slot]) / static_cast<double>(settings.fade_s), 0.0, 1.0));
    const auto here = static_cast<std::ptrdiff_t>(visible.size());
    visible.push_back(tile);
    const double cell = externals.cell_m * static_cast<double>(settings.view_cells);
    const float margin = 1.0f + 0.01f * static_cast<float>(std::ldexp(cell, key.level));
    const HeightRange heights{pool.low_m[slot] - margin, pool.high_m[slot] + margin};
    for (int q = 0; q < 4; ++q) {
        // The quadrant is the square of a child, also at level 0, where it has none.
        GroundSquare square = selector.square(key, heights);
        square.side *= 0.5;
        square.x0 += (q & 1) * square.side;
        square.y0 += (q >> 1) * square.side;
        if (!frustum.may_see(square)) continue;
        if (selector.wants_child(view, key, q)) {
            const uint32_t child = pool.find(key.child(q));
            // Only what this frame wants: what is left over from another view must not change the picture.
            if (child != k_no_slot && pool.state[child] == NodeState::resident && wanted_now(child)) {
                visit(key.child(q), frustum);
                continue;
            }
            visible[static_cast<size_t>(here)].fallback_mask |= static_cast<uint8_t>(1 << q);
            ++stats.fallbacks;
        }
        visible[static_cast<size_t>(here)].quadrant_mask |= static_cast<uint8_t>(1 << q);
    }
    if (visible[static_cast<size_t>(here)].quadrant_mask != 0) drawn[slot] = 1;
}

void TileStreamer::Impl::select_visible() {
    visible.clear();
    drawn.assign(static_cast<size_t>(pool.slots()), 0);
    const Frustum frustum(view);
    const TileKey centre = selector.root_of(view);
    for (int64_t dy = -settings.root_radius; dy <= settings.root_radius; ++dy)
        for (int64_t dx = -settings.root_radius; dx <= settings.root_radius; ++dx) {
            const TileKey root{centre.level, centre.x + dx, centre.y + dy};
            const uint32_t slot = pool.find(root);
            if (slot != k_no_slot && pool.state[slot] == NodeState::resident) visit(root, frustum);
        }
    std::erase_if(visible, [](const VisibleTile& t) { return t.quadrant_mask == 0; });
    // Front to back: what is near hides what is far.
    std::sort(visible.begin(), visible.end(), [&](const VisibleTile& a, const VisibleTile& b) {
        const double da = lod_distance_m(view, selector.square(a.key, {0, 0})),
                     db = lod_distance_m(view, selector.square(b.key, {0, 0}));
        return da != db ? da < db : a.key < b.key;
    });
    stats.visible = static_cast<int>(visible.size());
}

void TileStreamer::Impl::count() {
    stats.nodes_in_state.fill(0);
    for (const NodeState s : pool.state) ++stats.nodes_in_state[static_cast<size_t>(s)];
    stats.loads_in_flight = loads_in_flight;
    stats.in_flight_bytes = in_flight_bytes;
    stats.context_bytes = context_bytes;
    stats.oldest_request_frames = 0;
    is_ready = stats.fallbacks == 0 || stats.wanted_over_budget > 0;
    for (const uint32_t slot : wanted_slots) {
        const WantGroup group = wants[pool.rank[slot]].group;
        if (pool.state[slot] == NodeState::resident && pool.epoch[slot] == pool.wanted_epoch[slot]) continue;
        if (pool.state[slot] == NodeState::failed) continue;
        stats.oldest_request_frames =
            std::max(stats.oldest_request_frames, stats.frame - pool.first_wanted_frame[slot]);
        if (group <= WantGroup::visible) is_ready = false;
    }
}

TileStreamer::TileStreamer(const StreamSettings& settings, StreamExternals externals) {
    const Status checked = check_ranges(settings, "stream settings");
    if (!checked.ok()) check_failed(__FILE__, __LINE__, "settings are in range", checked.error().message);
    const int roots = (2 * settings.root_radius + 1) * (2 * settings.root_radius + 1);
    SAHEL_CHECK_LE(roots, settings.slots);
    SAHEL_CHECK(externals.load && externals.publish && externals.submit);
    SAHEL_CHECK_LE(externals.max_payload_bytes, static_cast<uint64_t>(settings.in_flight_mib) << 20);
    impl_ = std::make_unique<Impl>(settings, std::move(externals));
}

TileStreamer::~TileStreamer() {
    std::unique_lock lock(impl_->mailbox->mutex);
    impl_->mailbox->closed = true; // jobs that have not begun will not
    impl_->mailbox->changed.wait(lock, [&] { return impl_->mailbox->running == 0; });
}

FrameResult TileStreamer::update(const ViewState& view, double dt_s) {
    Impl& s = *impl_;
    ++s.stats.frame;
    s.stats.published = s.stats.evicted = s.stats.dropped = s.stats.fallbacks = 0;
    s.stats.published_bytes = 0;
    s.time_s += dt_s;
    s.view = view;
    s.collect_wants();
    s.place_wants();
    s.take_completions();
    s.publish_loaded();
    s.start_loads();
    s.select_visible();
    s.count();
    return {s.visible, s.stats};
}

bool TileStreamer::ready() const {
    return impl_->is_ready;
}

bool TileStreamer::settle(const ViewState& view) {
    Impl& s = *impl_;
    for (;;) {
        update(view, static_cast<double>(s.settings.fade_s)); // what appears has eased in by the next one
        if (s.is_ready) break;
        const bool waiting = s.loads_in_flight > 0 || !s.loaded_slots.empty();
        if (!waiting) { // nothing under way: only retries are left
            bool retries = false;
            for (const uint32_t slot : s.wanted_slots)
                retries |= s.pool.state[slot] == NodeState::retry_later || s.pool.state[slot] == NodeState::queued ||
                           s.pool.epoch[slot] != s.pool.wanted_epoch[slot];
            if (!retries) return false;
            s.time_s += static_cast<double>(s.settings.retry_after_s);
            continue;
        }
        std::unique_lock lock(s.mailbox->mutex);
        if (s.loaded_slots.empty())
            s.mailbox->changed.wait_for(lock, std::chrono::milliseconds(50), [&] { return !s.mailbox->done.empty(); });
    }
    update(view, static_cast<double>(s.settings.fade_s));
    return s.is_ready;
}

void TileStreamer::invalidate(TileKey key) {
    Impl& s = *impl_;
    if (const uint32_t slot = s.pool.find(key); slot != k_no_slot) s.pool.wanted_epoch[slot] = ++s.epoch;
}

void TileStreamer::invalidate_all() {
    Impl& s = *impl_;
    ++s.epoch;
    for (uint32_t slot = 0; slot < static_cast<uint32_t>(s.pool.slots()); ++slot)
        if (s.pool.state[slot] != NodeState::absent) {
            s.pool.wanted_epoch[slot] = s.epoch;
            s.pool.first_wanted_frame[slot] = s.stats.frame;
        }
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
        if (impl_->pool.state[slot] != NodeState::absent)
            nodes.push_back({impl_->pool.key[slot], impl_->pool.state[slot],
                             slot < impl_->drawn.size() && impl_->drawn[slot] != 0});
}

void TileStreamer::record_requests(bool on) {
    impl_->recording = on;
}

const std::vector<TileKey>& TileStreamer::requests() const {
    return impl_->requests;
}

} // namespace sahel
