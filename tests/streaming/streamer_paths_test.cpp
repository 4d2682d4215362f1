#include "paths.h"

#include <gtest/gtest.h>

#include <cstdio>

// Every frame of every path is audited: no hole, no overlap, no lost slot, no byte above a budget (audit in
// fake_world.cpp), states along the drawn arrows. Time is the tests' own.
namespace sahel::test {

TEST(StreamerPaths, StraightAtThreeHundredMetresPerSecond) {
    FakeWorld world(path_options(5, 0));
    const Seen seen = fly(world, 3000, straight);
    EXPECT_GT(seen.published, 300);
    EXPECT_GT(seen.evicted, 50);
    EXPECT_LE(seen.first_full, 12);
    EXPECT_EQ(seen.held_frames, 0) << "roots come in time";
    EXPECT_LE(seen.oldest_visible, 150);
    expect_nothing_leaked(world);
}

TEST(StreamerPaths, SpinOnTheSpotIsServedFromMemory) {
    FakeWorld world(path_options(5, 0));
    const Seen first = fly(world, 600, spin);
    const int64_t loads = world.loads();
    const Seen more = fly(world, 600, spin);
    EXPECT_EQ(world.loads(), loads) << "everything around is resident by then";
    EXPECT_EQ(more.evicted, 0);
    EXPECT_EQ(first.held_frames, 0);
    EXPECT_LE(first.oldest_visible, 200);
    for (int i = 0; i < 100; ++i) {
        const FrameResult frame = world.frame(spin(i));
        EXPECT_EQ(frame.stats.fallbacks, 0);
        EXPECT_LE(greatest_level_step(frame.visible), 1);
    }
    expect_nothing_leaked(world);
}

TEST(StreamerPaths, ClimbToTwentyKilometres) {
    FakeWorld world(path_options(5, 0));
    const Seen seen = fly(world, 2000, climb);
    EXPECT_LE(seen.first_full, 12);
    EXPECT_EQ(seen.held_frames, 0);
    EXPECT_LE(seen.oldest_visible, 150);
    for (int i = 0; i < 300; ++i) world.frame(climb(2000), 0.1);
    const FrameResult frame = world.streamer().frame();
    ASSERT_FALSE(frame.visible.empty());
    for (const VisibleTile& t : frame.visible) EXPECT_GE(t.key.level, 4); // 20 km / (2.1 * 256 m * 2^k) < 1
    expect_nothing_leaked(world);
}

TEST(StreamerPaths, Teleport) {
    FakeWorld world(path_options(5, 0));
    const Seen seen = fly(world, 3000, teleport);
    EXPECT_LE(seen.first_full, 12);
    EXPECT_GT(seen.held_frames, 19);
    EXPECT_LE(seen.longest_hold, 20); // nine roots, six at a time, five frames each
    EXPECT_LE(seen.oldest_visible, 160);
    // After a jump, roots are asked for first, then coarse and near before fine.
    const ViewState there = view_at(9.0e6, 9.0e6, 100.0, 0.3);
    const size_t before = world.streamer().requests().size();
    const FrameResult jump = world.frame(there);
    EXPECT_TRUE(jump.stats.held);
    EXPECT_EQ(jump.view.eye_m, teleport(2999).eye_m);
    for (int i = 0; i < 30; ++i) world.frame(there);
    EXPECT_FALSE(world.streamer().stats().held);
    const auto& requests = world.streamer().requests();
    ASSERT_GT(requests.size(), before + 9);
    for (size_t i = before; i < before + 9; ++i) EXPECT_EQ(requests[i].level, world.settings().root_level);
    expect_nothing_leaked(world);
}

TEST(StreamerPaths, TenThousandFramesOfRandomMoves) {
    FakeWorld world(path_options(9, 30));
    RandomFlight path(5);
    const Seen seen = fly(world, 10000, path);
    EXPECT_GT(path.teleports, 5);
    EXPECT_GT(seen.failed, 50);
    EXPECT_LE(seen.oldest_visible, 900); // a few failures in a row: 120 + 240 + 480 frames
    EXPECT_LE(seen.longest_hold, 40);
    std::printf("10 000 random frames: %d jumps, %d frames held (at most %d in a row), oldest request %lld frames\n",
                path.teleports, seen.held_frames, seen.longest_hold, static_cast<long long>(seen.oldest_visible));
    expect_nothing_leaked(world);
}

// The same with as little room as the settings allow.
TEST(StreamerPaths, RandomMovesInTheSmallestBudgets) {
    FakeWorld::Options options = path_options(9, 30);
    options.settings.slots = 32;
    options.settings.max_loads_in_flight = 1;
    options.settings.publishes_per_frame = 1;
    options.settings.in_flight_mib = 6;
    options.settings.publish_mib_per_frame = 6;
    options.settings.context_mib = 5; // 32 roots, twice: 4.3 MiB
    FakeWorld world(options);
    RandomFlight path(6);
    fly(world, 4000, path);
    expect_nothing_leaked(world);
}

TEST(StreamerPaths, SamePathSameOrder) {
    RandomFlight dice(11);
    std::vector<ViewState> random_views;
    for (int i = 0; i < 800; ++i) random_views.push_back(dice(i));
    const auto random = [&](int i) { return random_views[static_cast<size_t>(i)]; };
    const std::vector<std::function<ViewState(int)>> paths = {straight, spin, climb, teleport, random};
    for (const auto& path : paths) {
        FakeWorld a(path_options(7, 20)), b(path_options(7, 20));
        FakeWorld::Options turned = path_options(7, 20);
        turned.last_first = true; // workers that finish in another order within a frame
        FakeWorld c(turned);
        const Seen sa = fly(a, 800, path), sb = fly(b, 800, path), sc = fly(c, 800, path);
        EXPECT_GT(sa.requests.size(), 100u);
        EXPECT_EQ(first_difference(sa.requests, sb.requests), -1);
        EXPECT_EQ(first_difference(sa.pictures, sb.pictures), -1);
        EXPECT_EQ(first_difference(sa.requests, sc.requests), -1);
        EXPECT_EQ(first_difference(sa.pictures, sc.pictures), -1);
    }
}

TEST(StreamerPaths, PrefetchAlongTheVelocityHelps) {
    int64_t fallbacks[2] = {0, 0};
    for (const bool ahead : {false, true}) {
        FakeWorld::Options options = path_options(20, 0);
        options.settings.prefetch_s = ahead ? 3.0f : 0.0f;
        FakeWorld world(options);
        fly(world, 300, straight); // what is there at the start is not the question
        const Seen seen = fly(world, 3000, [](int i) { return straight(300 + i); });
        fallbacks[ahead ? 1 : 0] = seen.fallbacks;
    }
    std::printf("quadrants drawn too coarse at 300 m/s, loads of up to 20 frames: %lld without prefetch, %lld with\n",
                static_cast<long long>(fallbacks[0]), static_cast<long long>(fallbacks[1]));
    EXPECT_GT(fallbacks[0], 0);
    EXPECT_LT(fallbacks[1] * 2, fallbacks[0]);
}

TEST(StreamerPaths, SettledViewDependsOnTheViewAlone) {
    for (const int slots : {32, 96, 320}) { // far too few, too few, enough
        StreamSettings s = path_settings();
        s.slots = slots;
        FakeWorld::Options options;
        options.settings = s;
        options.run_at_once = true;
        FakeWorld old(options);
        for (int i = 0; i < 40; ++i) {
            const ViewState view = view_at(i * 400.0, i * i * 90.0, 20.0 + i * 3.0, i * 0.7);
            for (int k = 0; k < 7; ++k) old.frame(straight(i * 30 + k)); // something else in between
            ASSERT_TRUE(old.settle(view)) << "slots " << slots << ", view " << i;
            ASSERT_TRUE(old.streamer().ready());
            FakeWorld fresh(options);
            ASSERT_TRUE(fresh.settle(view));
            const FrameResult a = old.frame(view, 0.0), b = fresh.frame(view, 0.0);
            ASSERT_EQ(hash_visible(a.visible), hash_visible(b.visible)) << "slots " << slots << ", view " << i;
            for (const VisibleTile& t : a.visible) ASSERT_EQ(t.fade, 1.0f);
            if (a.stats.wanted_over_budget == 0) {
                ASSERT_LE(greatest_level_step(a.visible), 1);
            }
            if (HasFailure()) return;
        }
    }
}

} // namespace sahel::test
