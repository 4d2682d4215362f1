#include "streaming/node_pool.h"

#include <bit>

namespace sahel {

bool is_legal_transition(NodeState from, NodeState to) {
    using enum NodeState;
    switch (from) {
    case absent:
        return to == queued;
    case queued:
        return to == loading || to == absent;
    case loading:
        return to == loaded || to == retry_later || to == failed || to == absent;
    case loaded:
        return to == resident || to == absent;
    case resident:
        return to == absent;
    case retry_later:
        return to == queued || to == absent;
    case failed:
        return to == queued || to == absent;
    }
    return false;
}

NodePool::NodePool(int slots) {
    const auto n = static_cast<size_t>(slots);
    key.resize(n);
    parent.resize(n, k_no_slot);
    children.resize(n);
    attempts.resize(n);
    reloading.resize(n);
    dirty.resize(n);
    blocked.resize(n);
    wanted_frame.resize(n);
    first_wanted_frame.resize(n);
    listed_frame.resize(n, -1);
    rank.resize(n);
    sequence.resize(n);
    epoch.resize(n);
    wanted_epoch.resize(n);
    load_epoch.resize(n);
    wanted_s.resize(n);
    born_s.resize(n);
    retry_s.resize(n);
    low_m.resize(n);
    high_m.resize(n);
    job.resize(n);
    context.resize(n);
    payload.resize(n);
    state_.resize(n, NodeState::absent);
    generation_.resize(n, 0);
    newer_.resize(n, k_no_slot);
    older_.resize(n, k_no_slot);
    table_.resize(std::bit_ceil(n * 4), k_no_slot); // a quarter full: probes stay short
    mask_ = table_.size() - 1;
    free_.reserve(n);
    for (size_t i = n; i-- > 0;) free_.push_back(static_cast<uint32_t>(i)); // the lowest slot is taken first
    in_state_[static_cast<size_t>(NodeState::absent)] = slots;
}

uint32_t NodePool::find(TileKey k) const {
    for (size_t i = std::hash<TileKey>{}(k)&mask_;; i = (i + 1) & mask_) {
        const uint32_t slot = table_[i];
        if (slot == k_no_slot || key[slot] == k) return slot;
    }
}

void NodePool::set_state(uint32_t slot, NodeState state) {
    const NodeState before = state_[slot];
    if (!is_legal_transition(before, state))
        check_failed(__FILE__, __LINE__, "legal transition", std::string(name_of(before)) + " to " + name_of(state));
    --in_state_[static_cast<size_t>(before)];
    ++in_state_[static_cast<size_t>(state)];
    state_[slot] = state;
}

uint32_t NodePool::insert(TileKey k, uint32_t parent_slot) {
    SAHEL_DCHECK(find(k) == k_no_slot);
    if (free_.empty()) return k_no_slot;
    const uint32_t slot = free_.back();
    free_.pop_back();
    size_t i = std::hash<TileKey>{}(k)&mask_;
    while (table_[i] != k_no_slot) i = (i + 1) & mask_;
    table_[i] = slot;
    key[slot] = k;
    if (++generation_[slot] == 0) generation_[slot] = 1; // 0 is the null handle
    set_state(slot, NodeState::queued);
    parent[slot] = parent_slot;
    if (parent_slot != k_no_slot) ++children[parent_slot];
    children[slot] = attempts[slot] = reloading[slot] = dirty[slot] = blocked[slot] = 0;
    wanted_frame[slot] = first_wanted_frame[slot] = listed_frame[slot] = -1;
    sequence[slot] = epoch[slot] = wanted_epoch[slot] = load_epoch[slot] = 0;
    wanted_s[slot] = born_s[slot] = retry_s[slot] = 0.0;
    push_newest(slot);
    return slot;
}

void NodePool::push_newest(uint32_t slot) {
    newer_[slot] = k_no_slot;
    older_[slot] = head_;
    if (head_ != k_no_slot) newer_[head_] = slot;
    head_ = slot;
    if (tail_ == k_no_slot) tail_ = slot;
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
    push_newest(slot);
}

size_t NodePool::place_of(uint32_t slot) const {
    size_t i = std::hash<TileKey>{}(key[slot]) & mask_;
    while (table_[i] != slot) i = (i + 1) & mask_;
    return i;
}

void NodePool::erase(uint32_t slot) {
    SAHEL_CHECK_EQ(static_cast<int>(children[slot]), 0);
    set_state(slot, NodeState::absent);
    size_t i = place_of(slot);
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
    sequence[slot] = 0;
    job[slot].reset();
    context[slot].reset();
    payload[slot].reset();
    free_.push_back(slot);
}

} // namespace sahel
