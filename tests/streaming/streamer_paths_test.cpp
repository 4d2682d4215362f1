#include "fake_world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sahel::test {

namespace {

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

/// What a path showed, for comparing two runs and for its own limits.
struct Seen {
    std::vector<TileKey> requests;
    std::vector<uint64_t> pictures;
    int64_t oldest_visible = 0;
    int64_t rootless_frames = 0;
    int64_t published = 0, evicted = 0, failed = 0;
};

template <class Path> Seen fly(FakeWorld& world, int frames, Path&& path) {
    Seen seen;
    for (int i = 0; i < frames; ++i) {
        const ViewState view = path(i);
        const FrameResult frame = world.frame(view);
        audit(world, view, frame);
        seen.pictures.push_back(hash_visible(frame.visible));
        seen.oldest_visible = std::max(seen.oldest_visible, frame.stats.oldest_visible_frames);
        seen.rootless_frames += frame.stats.missing_roots > 0 ? 1 : 0;
        if (::testing::Test::HasFailure()) {
            ADD_FAILURE() << "at frame " << i;
            break;
        }
    }
    seen.requests = world.streamer().requests();
    seen.published = world.streamer().stats().published_total;
    seen.evicted = world.streamer().stats().evicted_total;
    seen.failed = world.streamer().stats().failed_total;
    return seen;
}

ViewState straight(int frame) {
    ViewState v = view_at(300.0 / 60.0 * frame, 1000.0, 120.0, 0.0);
    v.velocity_m_per_s = {300.0, 0.0, 0.0};
    return v;
}
ViewState spin(int frame) {
    return view_at(512.0 * 256.0, 512.0 * 256.0 * 3, 2.0, frame * 0.05); // a corner of four roots
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

} // namespace

TEST(StreamerPaths, StraightAtThreeHundredMetresPerSecond) {
    FakeWorld world(path_options(5, 0));
    const Seen seen = fly(world, 3000, straight);
    EXPECT_GT(seen.published, 300);
    EXPECT_GT(seen.evicted, 50);
    EXPECT_LE(seen.rootless_frames, 12);
    EXPECT_LE(seen.oldest_visible, 150);
}

TEST(StreamerPaths, SpinOnTheSpotIsServedFromMemory) {
    FakeWorld world(path_options(5, 0));
    const Seen first = fly(world, 600, spin);
    const int64_t loads = world.loads();
    const Seen more = fly(world, 600, spin);
    EXPECT_EQ(world.loads(), loads) << "everything around is resident by then";
    EXPECT_EQ(more.evicted, 0);
    EXPECT_LE(first.oldest_visible, 200);
    for (int i = 0; i < 100; ++i) {
        const FrameResult frame = world.frame(spin(i));
        EXPECT_EQ(frame.stats.fallbacks, 0);
        EXPECT_LE(greatest_level_step(frame.visible), 1);
    }
}

TEST(StreamerPaths, ClimbToTwentyKilometres) {
    FakeWorld world(path_options(5, 0));
    const Seen seen = fly(world, 2000, climb);
    EXPECT_LE(seen.rootless_frames, 12);
    EXPECT_LE(seen.oldest_visible, 150);
    world.streamer().settle(climb(2000));
    const auto visible = world.frame(climb(2000)).visible;
    ASSERT_FALSE(visible.empty());
    for (const VisibleTile& t : visible) EXPECT_GE(t.key.level, 4); // 20 km / (2.1 * 256 m * 2^k) < 1
}

TEST(StreamerPaths, Teleport) {
    FakeWorld world(path_options(5, 0));
    const Seen seen = fly(world, 3000, teleport);
    EXPECT_LE(seen.rootless_frames, 20 * 40);
    EXPECT_LE(seen.oldest_visible, 160);
    // After a jump, roots are asked for first, then coarse and near before fine.
    const ViewState there = view_at(9.0e6, 9.0e6, 100.0, 0.3);
    const size_t before = world.streamer().requests().size();
    world.frame(there);
    for (int i = 0; i < 30; ++i) world.frame(there);
    const auto& requests = world.streamer().requests();
    ASSERT_GT(requests.size(), before + 9);
    for (size_t i = before; i < before + 9; ++i) EXPECT_EQ(requests[i].level, world.settings().root_level);
}

TEST(StreamerPaths, TenThousandFramesOfRandomMoves) {
    FakeWorld world(path_options(9, 30));
    std::mt19937_64 dice(5);
    const auto uniform = [&](double a, double b) {
        return a + (b - a) * static_cast<double>(dice() >> 11) * 0x1.0p-53;
    };
    double x = 0, y = 0, height = 100, heading = 0, pitch = -0.1, vx = 0, vy = 0, turn = 0, lift = 0;
    int teleports = 0;
    const Seen seen = fly(world, 10000, [&](int) {
        if (uniform(0, 1) < 0.01) {
            const double speed = uniform(0, 1) < 0.3 ? 0.0 : uniform(0.0, 600.0), way = uniform(0.0, 6.28);
            vx = speed * std::cos(way), vy = speed * std::sin(way);
            turn = uniform(0, 1) < 0.5 ? 0.0 : uniform(-2.0, 2.0);
            lift = uniform(-80.0, 100.0);
        }
        if (uniform(0, 1) < 0.002) {
            const double far = uniform(0, 1) < 0.2 ? 2.0e9 : 1.0e6;
            x = uniform(-far, far), y = uniform(-far, far);
            ++teleports;
        }
        if (uniform(0, 1) < 0.004) heading = uniform(0.0, 6.28), pitch = uniform(-1.4, 0.4);
        x += vx / 60, y += vy / 60, heading += turn / 60;
        height = std::clamp(height + lift / 60, 1.7, 20000.0);
        ViewState v = view_at(x, y, height, heading, pitch);
        v.velocity_m_per_s = {vx, vy, lift};
        return v;
    });
    EXPECT_GT(teleports, 5);
    EXPECT_GT(seen.failed, 50);
    EXPECT_LE(seen.oldest_visible, 900); // a few failures in a row: 120 + 240 + 480 frames
    EXPECT_LE(seen.rootless_frames, (teleports + 1) * 200);
    RecordProperty("oldest_visible_frames", static_cast<int>(seen.oldest_visible));
    RecordProperty("rootless_frames", static_cast<int>(seen.rootless_frames));
}

TEST(StreamerPaths, SamePathSameOrder) {
    for (const auto path : {straight, spin, climb, teleport}) {
        FakeWorld a(path_options(7, 20)), b(path_options(7, 20));
        FakeWorld::Options turned = path_options(7, 20);
        turned.last_first = true; // workers that finish in another order within a frame
        FakeWorld c(turned);
        const Seen sa = fly(a, 800, path), sb = fly(b, 800, path), sc = fly(c, 800, path);
        EXPECT_GT(sa.requests.size(), 100u);
        EXPECT_EQ(sa.requests, sb.requests);
        EXPECT_EQ(sa.pictures, sb.pictures);
        EXPECT_EQ(sa.requests, sc.requests);
        EXPECT_EQ(sa.pictures, sc.pictures);
    }
}

TEST(StreamerPaths, SettledViewDependsOnTheViewAlone) {
    for (const int slots : {24, 96, 320}) { // far too few, too few, enough
        StreamSettings s = path_settings();
        s.slots = slots;
        FakeWorld::Options options;
        options.settings = s;
        options.run_at_once = true;
        FakeWorld old(options);
        for (int i = 0; i < 40; ++i) {
            const ViewState view = view_at(i * 400.0, i * i * 90.0, 20.0 + i * 3.0, i * 0.7);
            for (int k = 0; k < 7; ++k) old.frame(straight(i * 30 + k)); // something else in between
            const bool settled = old.streamer().settle(view);
            const StreamStats& st = old.streamer().stats();
            ASSERT_TRUE(settled) << "slots " << slots << ", view " << i << " missing " << st.missing_roots
                                 << " unplaced " << st.unplaced << " fallb " << st.fallbacks << " over "
                                 << st.wanted_over_budget << " inflight " << st.loads_in_flight << " free "
                                 << st.nodes_in_state[0] << " queued " << st.nodes_in_state[1] << " res "
                                 << st.nodes_in_state[4];
            ASSERT_TRUE(old.streamer().ready());
            FakeWorld fresh(options);
            ASSERT_TRUE(fresh.streamer().settle(view));
            const FrameResult a = old.frame(view, 0.0), b = fresh.frame(view, 0.0);
            ASSERT_EQ(hash_visible(a.visible), hash_visible(b.visible)) << "slots " << slots << ", view " << i;
            for (const VisibleTile& t : a.visible) ASSERT_EQ(t.fade, 1.0f);
            audit(old, view, a);
            if (a.stats.wanted_over_budget == 0) {
                ASSERT_LE(greatest_level_step(a.visible), 1);
            }
            if (HasFailure()) return;
        }
    }
}

} // namespace sahel::test
