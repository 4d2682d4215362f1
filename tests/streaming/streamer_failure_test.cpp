#include "paths.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

// Loads that fail: the ground stays whole, others go on, and what can be mended comes.
namespace sahel::test {
namespace {

/// A tile that the view wants in detail, with its parent.
TileKey victim_of(FakeWorld& world, const ViewState& view, int level) {
    EXPECT_TRUE(world.settle(view));
    for (const auto& [key, published] : world.published())
        if (key.level == level) return key;
    ADD_FAILURE() << "no tile of level " << level;
    return {};
}

NodeState state_of(const TileStreamer& streamer, TileKey key) {
    std::vector<NodeInfo> nodes;
    streamer.list_nodes(nodes);
    for (const NodeInfo& n : nodes)
        if (n.key == key) return n.state;
    return NodeState::absent;
}

const ViewState k_view = view_at(300.0, -700.0, 40.0, 0.4);

TEST(StreamerFailure, ErrorsForGoodAreTriedOnce) {
    FakeWorld probe(path_options(0, 0));
    FakeWorld::Options options = path_options(0, 0);
    options.run_at_once = true;
    FakeWorld whole(options);
    const TileKey victim = victim_of(whole, k_view, 2);
    for (const ErrorKind kind : {ErrorKind::usage, ErrorKind::unsupported}) {
        FakeWorld world(options);
        world.break_key(victim, kind);
        EXPECT_FALSE(world.settle(k_view)) << "something is missing for good";
        EXPECT_EQ(state_of(world.streamer(), victim), NodeState::failed);
        EXPECT_EQ(world.streamer().stats().failed_total, 1);
        EXPECT_FALSE(world.streamer().stats().held);
        // All the others came, but what hangs on it.
        for (const auto& [key, published] : whole.published())
            EXPECT_EQ(world.published().contains(key), key.level > 2 || !(key.ancestor(2) == victim));
        for (int i = 0; i < 300; ++i) world.frame(k_view, 1.0);
        EXPECT_EQ(world.streamer().stats().failed_total, 1);
        // Mended and said so: it gets a new chance.
        world.mend_all();
        world.streamer().invalidate(victim);
        EXPECT_TRUE(world.settle(k_view));
        EXPECT_EQ(state_of(world.streamer(), victim), NodeState::resident);
        EXPECT_EQ(hash_visible(world.streamer().frame().visible), hash_visible(whole.streamer().frame().visible));
    }
}

TEST(StreamerFailure, OthersAreTriedAgainLaterAndLater) {
    FakeWorld::Options options = path_options(0, 0);
    options.run_at_once = true;
    options.settings.retry_after_s = 2.0f;
    options.settings.max_attempts = 4;
    FakeWorld whole(options);
    const TileKey victim = victim_of(whole, k_view, 1);
    std::vector<double> tried;
    double time_s = 0.0;
    options.on_load = [&](TileKey key) {
        if (key == victim) tried.push_back(time_s);
    };
    FakeWorld world(options);
    world.break_key(victim, ErrorKind::corrupt);
    for (int i = 0; i < 1000; ++i) {
        time_s += 0.1;
        world.frame(k_view, 0.1);
    }
    ASSERT_EQ(tried.size(), 4u);
    EXPECT_NEAR(tried[1] - tried[0], 2.0, 0.25);
    EXPECT_NEAR(tried[2] - tried[1], 4.0, 0.25);
    EXPECT_NEAR(tried[3] - tried[2], 8.0, 0.25);
    EXPECT_EQ(state_of(world.streamer(), victim), NodeState::failed);
    EXPECT_GT(world.streamer().stats().fallbacks, 0) << "its parent stands in";
}

TEST(StreamerFailure, SettleWaitsForRetries) {
    FakeWorld::Options options = path_options(0, 300); // three of ten
    options.run_at_once = true;
    options.settings.max_attempts = 50;
    FakeWorld world(options), whole(path_options(0, 0));
    EXPECT_TRUE(world.settle(k_view));
    EXPECT_GT(world.streamer().stats().failed_total, 20);
    EXPECT_EQ(world.streamer().stats().fallbacks, 0);
}

TEST(StreamerFailure, AnExceptionIsAFailedLoad) {
    FakeWorld::Options options = path_options(0, 0);
    options.run_at_once = true;
    int thrown = 0;
    options.on_load = [&](TileKey key) {
        if (key.level == 3 && thrown++ < 5) throw std::runtime_error("no memory");
    };
    FakeWorld world(options);
    EXPECT_TRUE(world.settle(k_view));
    EXPECT_EQ(world.streamer().stats().failed_total, 5);
}

TEST(StreamerFailure, ARootThatFailsIsAHoleAndHoldsNobody) {
    FakeWorld::Options options = path_options(3, 0);
    FakeWorld world(options);
    for (int i = 0; i < 100; ++i) world.frame(k_view);
    const ViewState there = view_at(5.0e6, 5.0e6, 40.0, 0.4);
    const auto side = 512.0 * 256.0;
    const TileKey root{8, static_cast<int64_t>(5.0e6 / side), static_cast<int64_t>(5.0e6 / side)};
    world.break_key(root, ErrorKind::io);
    int held = 0;
    for (int i = 0; i < 100; ++i) held += world.frame(there).stats.held ? 1 : 0; // the audit knows of it
    EXPECT_LT(held, 20);
    EXPECT_FALSE(world.streamer().stats().held);
    EXPECT_EQ(world.streamer().stats().missing_roots, 1);
    world.mend_all();
    for (int i = 0; i < 100; ++i) world.frame(there, 0.1);
    EXPECT_EQ(world.streamer().stats().missing_roots, 0);
}

TEST(StreamerFailure, ARenewalThatFailsKeepsTheOldContents) {
    FakeWorld::Options options = path_options(0, 0);
    options.run_at_once = true;
    FakeWorld world(options);
    const TileKey victim = victim_of(world, k_view, 2);
    const uint64_t picture = hash_visible(world.streamer().frame().visible);
    world.break_key(victim, ErrorKind::io);
    world.set_version(2);
    world.streamer().invalidate(victim);
    EXPECT_FALSE(world.settle(k_view));
    EXPECT_EQ(state_of(world.streamer(), victim), NodeState::resident);
    EXPECT_EQ(world.published().at(victim).version, 1u);
    EXPECT_EQ(hash_visible(world.streamer().frame().visible), picture);
    world.mend_all();
    world.streamer().invalidate(victim);
    EXPECT_TRUE(world.settle(k_view));
    EXPECT_EQ(world.published().at(victim).version, 2u);
}

} // namespace
} // namespace sahel::test
