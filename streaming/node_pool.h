#pragma once

#include "streaming/load_jobs.h"
#include "streaming/streamer.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

/// Fixed slots, columns by slot, a hash table from keys to slots and a list by age. After the node pool of do
/// Nascimento et al.: nothing is allocated while the camera flies.
///
///     key ---hash---> table_ (open addressing, a quarter full) ---> slot ---> key[slot], state[slot], parent[slot],
///     ... list by age:  newest <-> ... <-> oldest   (newer_, older_: slots)
namespace sahel {

inline constexpr uint32_t k_no_slot = 0xFFFFFFFFu;

/// Whether the drawing in streamer.h has this arrow.
bool is_legal_transition(NodeState from, NodeState to);

class NodePool {
  public:
    explicit NodePool(int slots);

    [[nodiscard]] int slots() const { return static_cast<int>(key.size()); }
    [[nodiscard]] int free_slots() const { return static_cast<int>(free_.size()); }
    [[nodiscard]] uint32_t find(TileKey k) const;
    /// A free slot for a key that is not in the pool; k_no_slot when all are taken. State becomes queued.
    uint32_t insert(TileKey k, uint32_t parent_slot);
    /// Gives the slot back; handles to it go stale. It must have no children in the pool.
    void erase(uint32_t slot);
    void set_state(uint32_t slot, NodeState state);
    [[nodiscard]] NodeState state(uint32_t slot) const { return state_[slot]; }
    [[nodiscard]] bool is_resident(uint32_t slot) const {
        return slot != k_no_slot && state_[slot] == NodeState::resident;
    }
    /// Slots by state; absent counts the free ones.
    [[nodiscard]] const std::array<int, 7>& in_state() const { return in_state_; }
    void touch(uint32_t slot); ///< becomes the newest
    [[nodiscard]] uint32_t oldest() const { return tail_; }
    [[nodiscard]] uint32_t newer(uint32_t slot) const { return newer_[slot]; }
    [[nodiscard]] NodeHandle handle(uint32_t slot) const { return {slot, generation_[slot]}; }
    [[nodiscard]] bool is_current(NodeHandle h) const {
        return h.generation != 0 && h.slot < generation_.size() && generation_[h.slot] == h.generation &&
               state_[h.slot] != NodeState::absent;
    }

    // Columns, by slot.
    std::vector<TileKey> key;
    std::vector<uint32_t> parent;      ///< slot, k_no_slot at the roots
    std::vector<uint8_t> children;     ///< nodes in the pool that hang on this one
    std::vector<uint8_t> attempts;     ///< loads that failed since the last success
    std::vector<uint8_t> reloading;    ///< resident, and a newer version is loading or loaded
    std::vector<uint8_t> dirty;        ///< contents are not stored yet
    std::vector<uint8_t> blocked;      ///< cannot come: it or an ancestor failed (of this frame's wanted ones)
    std::vector<int64_t> wanted_frame; ///< last frame that wanted it
    std::vector<int64_t> first_wanted_frame;
    std::vector<int64_t> listed_frame;  ///< scratch of collect_wants
    std::vector<uint32_t> rank;         ///< place in the wanted order of wanted_frame
    std::vector<uint64_t> sequence;     ///< of its load
    std::vector<uint64_t> epoch;        ///< version of its contents, 0 none
    std::vector<uint64_t> wanted_epoch; ///< version it should have
    std::vector<uint64_t> load_epoch;   ///< version that is loading
    std::vector<double> wanted_s;       ///< when it was wanted last
    std::vector<double> born_s;         ///< when it appeared
    std::vector<double> retry_s;        ///< not tried again before
    std::vector<float> low_m, high_m;   ///< heights, where resident
    std::vector<std::shared_ptr<LoadJob>> job;
    std::vector<std::shared_ptr<const TileContext>> context;
    std::vector<std::unique_ptr<TilePayload>> payload; ///< loaded, not yet published

  private:
    void unlink(uint32_t slot);
    void push_newest(uint32_t slot);
    [[nodiscard]] size_t place_of(uint32_t slot) const;

    std::array<int, 7> in_state_{};
    std::vector<NodeState> state_;
    std::vector<uint32_t> generation_; ///< counts up at insert; 0 is never used
    std::vector<uint32_t> table_;      ///< open addressing, linear probing; slot or k_no_slot
    std::vector<uint32_t> free_;
    std::vector<uint32_t> newer_, older_;
    uint32_t head_ = k_no_slot, tail_ = k_no_slot;
    size_t mask_;
};

} // namespace sahel
