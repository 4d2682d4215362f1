#include "paths.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace sahel::test {

StreamSettings path_settings() {
    StreamSettings s;
    s.slots = 256;
    s.max_loads_in_flight = 6;
    return s;
}

FakeWorld::Options path_options(int latency_frames, int failures_per_mille) {
    FakeWorld::Options o;
    o.settings = path_settings();
    o.latency_frames = latency_frames;
    o.failures_per_mille = failures_per_mille;
    return o;
}

ViewState straight(int frame) {
    ViewState v = view_at(300.0 / 60.0 * frame, 1000.0, 120.0, 0.0);
    v.velocity_m_per_s = {300.0, 0.0, 0.0};
    return v;
}
ViewState spin(int frame) {
    return view_at(512.0 * 256.0, 512.0 * 256.0 * 3, 2.0, frame * 0.05);
}
ViewState climb(int frame) {
    ViewState v = view_at(-7000.0, -9000.0, 2.0 + frame * 10.0, 1.0, -0.6);
    v.velocity_m_per_s = {0.0, 0.0, 600.0};
    return v;
}
ViewState teleport(int frame) {
    const int place = frame / 150;
    return view_at(place * 3.0e6 * ((place & 1) ? -1.0 : 1.0), place * 1.7e6, 30.0 + 400.0 * (place % 3), place * 0.9);
}

double RandomFlight::uniform(double a, double b) {
    return a + (b - a) * static_cast<double>(dice_() >> 11) * 0x1.0p-53;
}

ViewState RandomFlight::operator()(int) {
    if (uniform(0, 1) < 0.01) {
        const double speed = uniform(0, 1) < 0.3 ? 0.0 : uniform(0.0, 600.0), way = uniform(0.0, 6.28);
        vx_ = speed * std::cos(way), vy_ = speed * std::sin(way);
        turn_ = uniform(0, 1) < 0.5 ? 0.0 : uniform(-2.0, 2.0);
        lift_ = uniform(-80.0, 100.0);
    }
    if (uniform(0, 1) < 0.002) {
        const double far = uniform(0, 1) < 0.2 ? 2.0e9 : 1.0e6;
        x_ = uniform(-far, far), y_ = uniform(-far, far);
        ++teleports;
    }
    if (uniform(0, 1) < 0.004) heading_ = uniform(0.0, 6.28), pitch_ = uniform(-1.4, 0.4);
    x_ += vx_ / 60, y_ += vy_ / 60, heading_ += turn_ / 60;
    height_ = std::clamp(height_ + lift_ / 60, 1.7, 20000.0);
    ViewState v = view_at(x_, y_, height_, heading_, pitch_);
    v.velocity_m_per_s = {vx_, vy_, lift_};
    return v;
}

void Seen::add(int frame_number, const FrameResult& frame) {
    pictures.push_back(hash_visible(frame.visible));
    oldest_visible = std::max(oldest_visible, frame.stats.oldest_visible_frames);
    if (first_full < 0 && frame.stats.missing_roots == 0) first_full = frame_number;
    held_frames += frame.stats.held ? 1 : 0;
    hold_ = frame.stats.held ? hold_ + 1 : 0;
    longest_hold = std::max(longest_hold, hold_);
    fallbacks += frame.stats.fallbacks;
}

void Seen::finish(FakeWorld& world) {
    requests = world.streamer().requests();
    published = world.streamer().stats().published_total;
    evicted = world.streamer().stats().evicted_total;
    failed = world.streamer().stats().failed_total;
}

void StateWatch::look(const TileStreamer& streamer) {
    // One frame may take several arrows: (absent ->) queued -> loading, loading -> loaded -> resident.
    using enum NodeState;
    const auto may_become = [](NodeState from, NodeState to) {
        if (from == to || to == absent) return true;
        switch (from) {
        case absent:
            return to == queued || to == loading;
        case queued:
            return to == loading;
        case loading:
            return to == loaded || to == resident || to == retry_later || to == failed;
        case loaded:
            return to == resident;
        case resident:
            return false;
        case retry_later:
        case failed:
            return to == queued || to == loading;
        }
        return false;
    };
    streamer.list_nodes(nodes_);
    std::map<TileKey, NodeState> now;
    for (const NodeInfo& n : nodes_) now[n.key] = n.state;
    for (const auto& [key, state] : now) {
        const auto it = before_.find(key);
        const NodeState before = it == before_.end() ? absent : it->second;
        EXPECT_TRUE(is_first_ || may_become(before, state)) << name_of(before) << " to " << name_of(state);
    }
    before_ = std::move(now);
    is_first_ = false;
}

bool has_failed_at(int frame) {
    if (!::testing::Test::HasFailure()) return false;
    ADD_FAILURE() << "at frame " << frame;
    return true;
}

namespace {

template <class T> int64_t differ_at(const std::vector<T>& a, const std::vector<T>& b) {
    const size_t n = std::min(a.size(), b.size());
    for (size_t i = 0; i < n; ++i)
        if (!(a[i] == b[i])) return static_cast<int64_t>(i);
    return a.size() == b.size() ? -1 : static_cast<int64_t>(n);
}

} // namespace

int64_t first_difference(const std::vector<TileKey>& a, const std::vector<TileKey>& b) {
    return differ_at(a, b);
}
int64_t first_difference(const std::vector<uint64_t>& a, const std::vector<uint64_t>& b) {
    return differ_at(a, b);
}

void expect_nothing_leaked(FakeWorld& world) {
    // Somewhere else, standing still, until all that can come has come.
    const ViewState view = view_at(-4.4e7, 5.5e7, 50.0, 0.2);
    for (int i = 0; i < 3000; ++i) {
        const StreamStats& s = world.frame(view).stats;
        if (s.loads_in_flight == 0 && s.in_flight_bytes == 0 && world.waiting_jobs() == 0 && s.missing_roots == 0 &&
            s.nodes_in_state[1] + s.nodes_in_state[5] == 0)
            break;
    }
    const StreamStats& s = world.streamer().stats();
    EXPECT_EQ(s.in_flight_bytes, 0u);
    EXPECT_EQ(s.payload_bytes, 0u);
    EXPECT_EQ(world.alive().payloads.load(), 0);
    EXPECT_EQ(world.alive().contexts.load(), s.nodes_in_state[static_cast<size_t>(NodeState::resident)]);
    for (const NodeState state : {NodeState::queued, NodeState::loading, NodeState::loaded, NodeState::retry_later})
        EXPECT_EQ(s.nodes_in_state[static_cast<size_t>(state)], 0) << name_of(state);
}

} // namespace sahel::test
