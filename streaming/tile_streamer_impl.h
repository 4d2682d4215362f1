#pragma once

#include "streaming/load_jobs.h"
#include "streaming/selection.h"

#include <span>

/// The parts of TileStreamer, one file each, called in this order once a frame:
///
///     residency.cpp   collect_wants   what the view (and its future) wants, in the total order, cut to the budgets
///                     place_wants     slots for it: the release queue, the list by age
///     loading.cpp     take_arrived    what workers brought
///                     publish_loaded  within the publish budgets
///                     start_loads     within the load budgets
///     visible.cpp     choose_shown    the view asked for, once its ground is there
///                     select_visible  what to draw, from what is there
///                     count           statistics, readiness
namespace sahel {

struct TileStreamer::Impl {
    Impl(const StreamSettings& s, StreamExternals e);

    const StreamSettings settings;
    const StreamExternals externals;
    NodePool pool;
    Selector selector;
    ContextAccount contexts;
    std::shared_ptr<LoadMailbox> mailbox;

    // This frame.
    ViewState view;  ///< asked for
    ViewState shown; ///< drawn: the same, or the last one whose ground was there
    bool has_shown = false;
    bool is_held = false; ///< shown is not view
    double time_s = 0.0;
    StreamStats stats;
    std::vector<Want> wants;
    std::vector<TileKey> absent_keys;
    std::vector<uint32_t> wanted_slots; ///< in the order of the wants
    std::vector<VisibleTile> visible;
    std::vector<double> visible_distance_m;
    std::vector<uint8_t> drawn; ///< by slot
    bool is_ready = false;
    bool may_progress = false; ///< something is under way, or will be tried again

    // From frame to frame.
    std::vector<uint32_t> unsettled; ///< every slot that is neither absent nor resident, parents before children
    std::vector<uint32_t> loaded_slots;
    std::vector<Completion> arrived;
    uint64_t next_sequence = 1;
    uint64_t epoch = 1; ///< counts invalidations
    uint64_t in_flight_bytes = 0;
    uint64_t payload_bytes = 0;
    std::vector<uint64_t> in_flight; ///< sequences of the loads that are under way, oldest first
    bool lockstep = false;           ///< settle: no decision depends on how fast the workers are
    uint64_t awaited = 0;            ///< lockstep: the load to take this frame, 0 none
    int starts_since_reload = 0;
    int dirty_tiles = 0;
    bool recording = false;
    std::vector<TileKey> requests;

    void collect_wants();
    void collect_shown(size_t from);
    [[nodiscard]] int count_missing_roots(bool may_come) const;
    void place_wants();
    void drop_unwanted();
    bool make_room(WantGroup group);
    bool evict(bool dirty_ones, WantGroup group);

    void take_arrived();
    void publish_loaded();
    void publish(uint32_t slot);
    void start_loads();
    bool start_some(bool reloads, int most);
    void start(uint32_t slot);
    void fail(uint32_t slot, ErrorKind kind);
    bool abandon(uint32_t slot);
    [[nodiscard]] bool load_fits() const;
    [[nodiscard]] bool context_fits() const;
    [[nodiscard]] bool is_stale(uint32_t slot) const { return pool.epoch[slot] != pool.wanted_epoch[slot]; }
    [[nodiscard]] bool may_reload(uint32_t slot) const {
        return is_stale(slot) && pool.attempts[slot] < settings.max_attempts;
    }

    void choose_shown();
    void select_visible();
    void visit(uint32_t slot, const Frustum& frustum);
    void count();
    bool settle(TileStreamer& self, const ViewState& wanted);

    [[nodiscard]] int loads_in_flight() const { return static_cast<int>(in_flight.size()); }
    void landed(uint64_t sequence);
    [[nodiscard]] bool wanted_now(uint32_t slot) const { return pool.wanted_frame[slot] == stats.frame; }
    void release(uint32_t slot);
};

} // namespace sahel
