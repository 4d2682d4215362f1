#include "paths.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

// What a frame may cost, and what leaves first when room is needed.
namespace sahel::test {
namespace {

TEST(StreamerBudget, MillisecondsPerFrame) {
    double clock_s = 0.0;
    FakeWorld::Options options = path_options(0, 0);
    options.settings.publishes_per_frame = 64;
    options.settings.max_loads_in_flight = 64;
    options.settings.in_flight_mib = 1024;
    options.settings.publish_mib_per_frame = 4096;
    options.settings.publish_ms_per_frame = 4.0f;
    options.now_s = [&] { return clock_s; };
    FakeWorld world(options);
    int published = 0, most = 0, frames_at_limit = 0;
    world.on_publish = [&](TileKey) {
        clock_s += 1.5e-3;
        ++published;
    };
    for (int i = 0; i < 200; ++i) {
        published = 0;
        world.frame(straight(i));
        most = std::max(most, published);
        frames_at_limit += published == 3 ? 1 : 0;
    }
    EXPECT_EQ(most, 3); // 1.5, 3.0, 4.5 ms: the tile that crosses the limit is the last
    EXPECT_GT(frames_at_limit, 20);
}

TEST(StreamerBudget, BytesAndTilesPerFrame) {
    for (const auto& [tiles, mib] : {std::pair{1, 64}, {64, 6}, {64, 13}, {3, 4096}}) {
        FakeWorld::Options options = path_options(0, 0);
        options.settings.publishes_per_frame = tiles;
        options.settings.publish_mib_per_frame = mib;
        options.settings.max_loads_in_flight = 16;
        FakeWorld world(options);
        int at_limit = 0;
        uint64_t most_bytes = 0;
        for (int i = 0; i < 200; ++i) { // the fake world checks both limits in every frame
            const StreamStats& s = world.frame(straight(i)).stats;
            at_limit += s.published == tiles ? 1 : 0;
            most_bytes = std::max(most_bytes, s.published_bytes);
        }
        if (tiles < 64) {
            EXPECT_GT(at_limit, 20);
        }
        if (mib < 64) {
            EXPECT_GT(most_bytes, (static_cast<uint64_t>(mib) << 20) - k_payload_bytes);
        }
    }
}

TEST(StreamerBudget, LoadsInFlight) {
    for (const int mib : {6, 13, 40}) {
        FakeWorld::Options options = path_options(10, 0);
        options.settings.in_flight_mib = mib;
        options.settings.max_loads_in_flight = 64;
        FakeWorld world(options);
        int most = 0;
        for (int i = 0; i < 400; ++i) most = std::max(most, world.frame(straight(i)).stats.loads_in_flight);
        EXPECT_EQ(most, mib / 6);
    }
}

TEST(StreamerBudget, LeastRecentlyWantedLeavesFirst) {
    FakeWorld::Options options = path_options(0, 0);
    options.run_at_once = true;
    FakeWorld world(options);
    const auto place = [](int i) { return view_at(i * 4.0e6, 0.0, 60.0, 0.3); };
    const auto place_of = [](TileKey key) {
        return std::lround(std::ldexp(512.0, key.level) * static_cast<double>(key.x) / 4.0e6);
    };
    std::array<int, 3> resident{};
    for (int p = 0; p < 2; ++p) ASSERT_TRUE(world.settle(place(p)));
    for (const auto& [key, published] : world.published()) ++resident.at(static_cast<size_t>(place_of(key)));
    ASSERT_GT(resident[0], 40);
    ASSERT_GT(resident[1], 40);
    const size_t before = world.evictions().size();
    for (int i = 0; i < 200; ++i) world.frame(place(2), 0.1); // needs the room
    const std::vector<TileKey> gone(world.evictions().begin() + static_cast<std::ptrdiff_t>(before),
                                    world.evictions().end());
    ASSERT_GT(gone.size(), static_cast<size_t>(resident[0]));
    for (size_t i = 0; i < gone.size(); ++i) { // all of the first place leaves before any of the second
        EXPECT_EQ(place_of(gone[i]), i < static_cast<size_t>(resident[0]) ? 0 : 1) << i;
    }
}

TEST(StreamerBudget, HandlesOfEvictedTilesAreStale) {
    FakeWorld::Options options = path_options(0, 0);
    options.run_at_once = true;
    options.settings.slots = 64;
    FakeWorld world(options);
    ASSERT_TRUE(world.settle(view_at(0, 0, 60.0, 0.3)));
    const auto before = world.published();
    ASSERT_TRUE(world.settle(view_at(7e6, 0, 60.0, 0.3)));
    int stale = 0;
    for (const auto& [key, published] : before) {
        const auto now = world.published().find(key);
        EXPECT_EQ(world.streamer().is_current(published.handle), now != world.published().end());
        stale += world.streamer().is_current(published.handle) ? 0 : 1;
    }
    EXPECT_GT(stale, 10);
}

TEST(StreamerBudget, CleanTilesLeaveBeforeDirtyOnes) {
    FakeWorld::Options options = path_options(0, 0);
    options.run_at_once = true;
    FakeWorld world(options);
    ASSERT_TRUE(world.settle(view_at(0, 0, 60.0, 0.3)));
    // The oldest tiles are changed: by age they would go first.
    std::set<TileKey> dirty;
    for (const auto& [key, published] : world.published())
        if (key.level < 4) dirty.insert(key);
    ASSERT_GT(dirty.size(), 20u);
    for (const TileKey& key : dirty) world.streamer().set_dirty(key, true);
    world.streamer().set_dirty({0, 123456, 7}, true); // unknown keys are ignored
    std::vector<TileKey> commits;
    bool may_commit = false;
    world.on_commit = [&](TileKey key) {
        if (may_commit) commits.push_back(key);
        return may_commit;
    };
    for (int p = 1; p <= 6; ++p) world.settle(view_at(p * 4e6, 0, 60.0, 0.3));
    EXPECT_GT(world.evictions().size(), 100u);
    for (const TileKey& key : world.evictions()) EXPECT_FALSE(dirty.contains(key)) << "not stored yet";
    for (const TileKey& key : dirty) EXPECT_TRUE(world.published().contains(key));
    // With a store that takes them they leave, each after it was committed; one that is clean again without.
    const TileKey cleaned = *dirty.begin();
    world.streamer().set_dirty(cleaned, false);
    may_commit = true;
    for (int p = 7; p <= 14; ++p) {
        ViewState low = view_at(p * 4e6, 0, 5.0, 0.3);
        world.settle(low);
    }
    EXPECT_FALSE(std::count(commits.begin(), commits.end(), cleaned));
    std::set<TileKey> committed(commits.begin(), commits.end());
    EXPECT_EQ(committed.size(), commits.size()) << "once each";
    for (const TileKey& key : dirty)
        EXPECT_EQ(key == cleaned || committed.contains(key), !world.published().contains(key));
}

TEST(StreamerBudget, AllTilesDirtyAndNothingToStoreThemIsNoDisaster) {
    FakeWorld::Options options = path_options(2, 0);
    options.settings.slots = 64;
    FakeWorld world(options);
    for (int i = 0; i < 600; ++i) world.frame(view_at(0, 0, 60.0, 0.3));
    for (const auto& [key, published] : std::map(world.published())) world.streamer().set_dirty(key, true);
    const size_t before = world.published().size();
    ASSERT_EQ(before, 64u);
    const size_t gone = world.evictions().size();
    for (int i = 0; i < 100; ++i) world.frame(view_at(4e6, 0, 60.0, 0.3)); // held: the old ground stays
    EXPECT_TRUE(world.streamer().stats().held);
    EXPECT_EQ(world.evictions().size(), gone);
    EXPECT_GE(world.published().size(), before);
    world.on_commit = [](TileKey) { return true; };
    for (int i = 0; i < 300; ++i) world.frame(view_at(4e6, 0, 60.0, 0.3), 0.1);
    EXPECT_FALSE(world.streamer().stats().held);
    EXPECT_EQ(world.streamer().stats().missing_roots, 0);
}

TEST(StreamerBudget, RenewalKeepsWhatIsDrawn) {
    FakeWorld world(path_options(5, 0));
    const ViewState view = view_at(500, 900, 60.0, 0.3);
    for (int i = 0; i < 400; ++i) world.frame(view);
    const auto before = world.published();
    const uint64_t picture = hash_visible(world.frame(view).visible);
    world.set_version(2);
    world.streamer().invalidate_all();
    std::vector<TileKey> renewed;
    world.on_publish = [&](TileKey key) { renewed.push_back(key); };
    int frames = 0;
    const auto wanted_old = [&] {
        int old = 0;
        std::vector<NodeInfo> nodes;
        world.streamer().list_nodes(nodes);
        for (const NodeInfo& n : nodes)
            if (n.drawn && world.published().at(n.key).version != 2) ++old;
        return old;
    };
    do {
        ASSERT_EQ(hash_visible(world.frame(view).visible), picture) << "the old contents stay until the new are there";
        ASSERT_LT(++frames, 1000);
    } while (wanted_old() > 0);
    for (const auto& [key, published] : before) EXPECT_EQ(world.published().at(key).handle, published.handle);
    std::map<TileKey, size_t> first;
    for (size_t i = renewed.size(); i-- > 0;) first[renewed[i]] = i;
    for (const auto& [key, at] : first) {
        const auto parent = first.find(key.parent());
        if (parent != first.end()) {
            EXPECT_LT(parent->second, at) << "coarse tiles first";
        }
    }
    // One tile alone.
    for (int i = 0; i < 600; ++i) world.frame(view); // and those that are not seen
    const size_t many = renewed.size();
    const TileKey one = world.frame(view).visible[0].key;
    world.set_version(3);
    world.streamer().invalidate(one);
    for (int i = 0; i < 60; ++i) world.frame(view);
    ASSERT_EQ(renewed.size(), many + 1);
    EXPECT_EQ(renewed.back(), one);
    EXPECT_EQ(world.published().at(one).version, 3u);
}

TEST(StreamerDeathTest, ViewsThatAreNoPlaces) {
    FakeWorld::Options options = path_options(0, 0);
    options.run_at_once = true;
    const auto look = [&](double ViewState::*member) {
        FakeWorld world(options);
        ViewState view = view_at(0, 0, 10, 0);
        view.*member = std::nan("");
        world.streamer().update(view, 0.0);
    };
    EXPECT_DEATH(look(&ViewState::ground_m), "isfinite");
    EXPECT_DEATH(
        {
            FakeWorld world(options);
            ViewState view = view_at(0, 0, 10, 0);
            view.eye_m[1] = std::nan("");
            world.streamer().update(view, 0.0);
        },
        "isfinite");
}

} // namespace
} // namespace sahel::test
