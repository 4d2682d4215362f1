#pragma once

#include "streaming/streamer.h"

#include <cstdint>
#include <memory>
#include <vector>

/// Fixed slots, columns by slot, a hash table from keys to slots and a list by age. After the node pool of do
/// Nascimento et al.: nothing is allocated while the camera flies.
namespace sahel {

inline constexpr uint32_t k_no_slot = 0xFFFFFFFFu;

class NodePool {
  public:
    explicit NodePool(int slots);

    [[nodiscard]] int slots() const { return static_cast<int>(key.size()); }
    [[nodiscard]] int free_slots() const { return static_cast<int>(free_.size()); }
    [[nodiscard]] uint32_t find(TileKey k) const;
    /// A free slot for a key that is not in the pool; k_no_slot when all are taken. State becomes queued.
    uint32_t insert(TileKey k);
    /// Gives the slot back; handles to it go stale.
    void erase(uint32_t slot);
    void touch(uint32_t slot); ///< most recently used
    [[nodiscard]] uint32_t oldest() const { return tail_; }
    [[nodiscard]] uint32_t newer(uint32_t slot) const { return newer_[slot]; }
    [[nodiscard]] NodeHandle handle(uint32_t slot) const { return {slot, generation[slot]}; }
    [[nodiscard]] bool is_current(NodeHandle h) const {
        return h.generation != 0 && h.slot < generation.size() && generation[h.slot] == h.generation &&
               state[h.slot] != NodeState::absent;
    }

    // Columns, by slot.
    std::vector<TileKey> key;
    std::vector<NodeState> state;
    std::vector<uint32_t> generation; ///< even slots of time are free: counts up at insert and erase
    std::vector<uint32_t> parent;     ///< slot, k_no_slot at the roots
    std::vector<uint8_t> children;    ///< nodes in the pool that hang on this one
    std::vector<uint8_t> attempts;
    std::vector<uint8_t> reloading;    ///< resident, and a newer version is loading
    std::vector<int64_t> wanted_frame; ///< last frame that wanted it
    std::vector<int64_t> first_wanted_frame;
    std::vector<uint32_t> rank;         ///< place in the wanted order of wanted_frame
    std::vector<uint64_t> sequence;     ///< of its load; a result with another number is dead
    std::vector<uint64_t> epoch;        ///< version of its contents
    std::vector<uint64_t> wanted_epoch; ///< version it should have
    std::vector<uint64_t> load_epoch; ///< version that is loading
    std::vector<double> time_s;         ///< when it appeared, or may be tried again
    std::vector<float> low_m, high_m;
    std::vector<uint64_t> context_bytes;
    std::vector<std::shared_ptr<const TileContext>> context;
    std::vector<std::unique_ptr<TilePayload>> payload; ///< loaded, not yet published

  private:
    void unlink(uint32_t slot);
    std::vector<uint32_t> table_; ///< open addressing, linear probing; slot or k_no_slot
    std::vector<uint32_t> free_;
    std::vector<uint32_t> newer_, older_;
    uint32_t head_ = k_no_slot, tail_ = k_no_slot;
    size_t mask_;
};

} // namespace sahel
