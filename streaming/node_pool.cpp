#include "streaming/node_pool.h"

#include <bit>

namespace sahel {

NodePool::NodePool(int slots) {
    const auto n = static_cast<size_t>(slots);
    key.resize(n);
    state.resize(n, NodeState::absent);
    generation.resize(n, 0);
    parent.resize(n, k_no_slot);
    children.resize(n, 0);
    attempts.resize(n, 0);
    reloading.resize(n, 0);
    wanted_frame.resize(n, -1);
    first_wanted_frame.resize(n, -1);
    rank.resize(n, 0);
    sequence.resize(n, 0);
    epoch.resize(n, 0);
    wanted_epoch.resize(n, 0);
    load_epoch.resize(n, 0);
    time_s.resize(n, 0.0);
    low_m.resize(n, 0.0f);
    high_m.resize(n, 0.0f);
    context_bytes.resize(n, 0);
    context.resize(n);
    payload.resize(n);
    newer_.resize(n, k_no_slot);
    older_.resize(n, k_no_slot);
    table_.resize(std::bit_ceil(n * 4), k_no_slot); // a quarter full: probes stay short
    mask_ = table_.size() - 1;
    free_.reserve(n);
    for (size_t i = n; i-- > 0;) free_.push_back(static_cast<uint32_t>(i)); // the lowest slot is taken first
}

uint32_t NodePool::find(TileKey k) const {
    for (size_t i = std::hash<TileKey>{}(k)&mask_;; i = (i + 1) & mask_) {
        const uint32_t slot = table_[i];
        if (slot == k_no_slot || key[slot] == k) return slot;
    }
}

uint32_t NodePool::insert(TileKey k) {
    SAHEL_DCHECK(find(k) == k_no_slot);
    if (free_.empty()) return k_no_slot;
    const uint32_t slot = free_.back();
    free_.pop_back();
    size_t i = std::hash<TileKey>{}(k)&mask_;
    while (table_[i] != k_no_slot) i = (i + 1) & mask_;
    table_[i] = slot;
    key[slot] = k;
    state[slot] = NodeState::queued;
    ++generation[slot];
    if (generation[slot] == 0) generation[slot] = 1; // 0 is the null handle
    parent[slot] = k_no_slot;
    children[slot] = 0;
    attempts[slot] = 0;
    reloading[slot] = 0;
    wanted_frame[slot] = -1;
    first_wanted_frame[slot] = -1;
    epoch[slot] = 0;
    wanted_epoch[slot] = 0;
    newer_[slot] = k_no_slot;
    older_[slot] = head_;
    if (head_ != k_no_slot) newer_[head_] = slot;
    head_ = slot;
    if (tail_ == k_no_slot) tail_ = slot;
    return slot;
}

void NodePool::unlink(uint32_t slot) {
    const uint32_t n = newer_[slot], o = older_[slot];
    if (n != k_no_slot) older_[n] = o;
    if (o != k_no_slot) newer_[o] = n;
    if (head_ == slot) head_ = o;
    if (tail_ == slot) tail_ = n;
}

void NodePool::touch(uint32_t slot) {
    if (head_ == slot) return;
    unlink(slot);
    newer_[slot] = k_no_slot;
    older_[slot] = head_;
    if (head_ != k_no_slot) newer_[head_] = slot;
    head_ = slot;
    if (tail_ == k_no_slot) tail_ = slot;
}

void NodePool::erase(uint32_t slot) {
    SAHEL_CHECK(state[slot] != NodeState::absent);
    SAHEL_CHECK_EQ(static_cast<int>(children[slot]), 0);
    size_t i = std::hash<TileKey>{}(key[slot]) & mask_;
    while (table_[i] != slot) i = (i + 1) & mask_;
    // Backward shift: what follows in the probe sequence moves up, so lookups need no tombstones.
    for (size_t j = (i + 1) & mask_; table_[j] != k_no_slot; j = (j + 1) & mask_) {
        const size_t home = std::hash<TileKey>{}(key[table_[j]]) & mask_;
        if (((j - home) & mask_) >= ((j - i) & mask_)) {
            table_[i] = table_[j];
            i = j;
        }
    }
    table_[i] = k_no_slot;
    unlink(slot);
    if (parent[slot] != k_no_slot) --children[parent[slot]];
    parent[slot] = k_no_slot;
    state[slot] = NodeState::absent;
    ++generation[slot];
    context[slot].reset();
    context_bytes[slot] = 0;
    payload[slot].reset();
    free_.push_back(slot);
}

} // namespace sahel
