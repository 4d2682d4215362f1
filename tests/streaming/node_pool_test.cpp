#include "streaming/node_pool.h"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <random>
#include <set>

namespace sahel {
namespace {

using enum NodeState;
constexpr std::array<NodeState, 7> k_states = {absent, queued, loading, loaded, resident, retry_later, failed};

TEST(NodeStates, OnlyTheDrawnArrows) {
    const std::set<std::pair<NodeState, NodeState>> drawn = {
        {absent, queued},  {queued, loading},     {loading, loaded}, {loaded, resident}, {loading, retry_later},
        {loading, failed}, {retry_later, queued}, {failed, queued},  {queued, absent},   {retry_later, absent},
        {failed, absent},  {loading, absent},     {loaded, absent},  {resident, absent}};
    for (const NodeState from : k_states)
        for (const NodeState to : k_states)
            EXPECT_EQ(is_legal_transition(from, to), drawn.contains({from, to})) << name_of(from) << ' ' << name_of(to);
}

TEST(NodeStatesDeathTest, AnyOtherStepIsOurBug) {
    NodePool pool(4);
    const uint32_t slot = pool.insert({3, 1, 1}, k_no_slot);
    EXPECT_DEATH(pool.set_state(slot, resident), "queued to resident");
    pool.set_state(slot, loading);
    pool.set_state(slot, loaded);
    pool.set_state(slot, resident);
    EXPECT_DEATH(pool.set_state(slot, loading), "resident to loading");
}

TEST(NodePool, HandlesGoStale) {
    NodePool pool(1);
    EXPECT_FALSE(pool.is_current(NodeHandle{}));
    const uint32_t slot = pool.insert({2, 5, -7}, k_no_slot);
    const NodeHandle first = pool.handle(slot);
    EXPECT_TRUE(pool.is_current(first));
    EXPECT_EQ(pool.insert({2, 6, -7}, k_no_slot), k_no_slot) << "full";
    pool.erase(slot);
    EXPECT_FALSE(pool.is_current(first));
    const uint32_t again = pool.insert({2, 5, -7}, k_no_slot);
    EXPECT_EQ(again, slot);
    EXPECT_FALSE(pool.is_current(first)) << "the same slot for the same key is another node";
    EXPECT_TRUE(pool.is_current(pool.handle(again)));
}

TEST(NodePoolDeathTest, ChildrenGoFirst) {
    NodePool pool(4);
    const uint32_t parent = pool.insert({1, 0, 0}, k_no_slot);
    const uint32_t child = pool.insert({0, 1, 1}, parent);
    EXPECT_EQ(pool.children[parent], 1);
    EXPECT_DEATH(pool.erase(parent), "children");
    pool.erase(child);
    pool.erase(parent);
    EXPECT_EQ(pool.free_slots(), 4);
}

// Against a map and a list that are obviously right: keys that share probe sequences, erased in any order.
TEST(NodePool, TableAndAgesAgreeWithSimpleOnes) {
    constexpr int k_slots = 48;
    NodePool pool(k_slots);
    std::map<TileKey, uint32_t> known;
    std::vector<uint32_t> ages; // oldest first
    std::mt19937 dice(3);
    for (int step = 0; step < 30000; ++step) {
        const TileKey key{static_cast<int32_t>(dice() % 3), static_cast<int64_t>(dice() % 8) - 4,
                          static_cast<int64_t>(dice() % 8) - 4};
        const auto it = known.find(key);
        ASSERT_EQ(pool.find(key), it == known.end() ? k_no_slot : it->second);
        const auto action = dice() % 3;
        if (it == known.end()) {
            const uint32_t slot = pool.insert(key, k_no_slot);
            ASSERT_EQ(slot == k_no_slot, known.size() == k_slots);
            if (slot == k_no_slot) continue;
            known[key] = slot;
            ages.push_back(slot);
        } else if (action == 0) {
            std::erase(ages, it->second);
            pool.erase(it->second);
            known.erase(it);
        } else if (action == 1) {
            pool.touch(it->second);
            std::erase(ages, it->second);
            ages.push_back(it->second);
        }
        ASSERT_EQ(pool.free_slots(), k_slots - static_cast<int>(known.size()));
        ASSERT_EQ(pool.in_state()[static_cast<size_t>(absent)], pool.free_slots());
        uint32_t slot = pool.oldest();
        for (const uint32_t expected : ages) {
            ASSERT_EQ(slot, expected);
            slot = pool.newer(slot);
        }
        ASSERT_EQ(slot, k_no_slot);
    }
}

} // namespace
} // namespace sahel
