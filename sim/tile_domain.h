#pragma once

#include "sim/border_flows.h"
#include "sim/exchange_plan.h"
#include "sim/ledger_sources.h"
#include "sim/pass.h"
#include "sim/sim_layers.h"
#include "sim/slab_view.h"
#include "world/field.h"
#include "world/memory.h"
#include "world/result.h"

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

/// The resident tiles that a simulation advances: for every layer one slab of memory, tile after tile, each tile its
/// owned cells with `halo` cells around them. Kernels get a SlabView and run over all tiles in one launch.
///
///     slab of a layer   | slot 0: rows -h .. n+h-1 | slot 1 | slot 2 | ...      rows start on a cache line
///
/// Of every layer the domain knows how many halo cells are valid: equal to what the neighbours own. A load or a pass
/// sets it, an exchange restores it to the whole halo. Fresh memory is poison (0x7FA00000: a signalling NaN, and as
/// ticks 2^31 nearly) in every build, so that a halo read too far shows.
namespace sahel {

inline constexpr uint32_t k_poison = 0x7FA00000u;
inline constexpr int32_t k_nothing_valid = -1;

using HaloState =
    std::array<int32_t, k_sim_layer_count>; ///< valid halo cells of each layer; k_nothing_valid: none at all

class TileDomain {
  public:
    /// Errors: budget (the pool's limit), usage (a halo wider than a tile). `pool` may be CUDA memory.
    static Result<TileDomain> create(TileLayout layout, SimLayerSet layers, MemoryPool& pool = MemoryPool::host());
    /// The bytes that create takes for slabs, exactly.
    static uint64_t slab_bytes(const TileLayout& layout, SimLayerSet layers);

    [[nodiscard]] const TileLayout& layout() const { return layout_; }
    [[nodiscard]] const ExchangePlan& plan() const { return plan_; }
    [[nodiscard]] int32_t slots() const { return static_cast<int32_t>(layout_.tiles.size()); }
    [[nodiscard]] int32_t tile_cells() const { return layout_.tile_cells; }
    [[nodiscard]] int32_t halo() const { return layout_.halo; }
    [[nodiscard]] SimLayerSet layers() const { return layers_; }
    [[nodiscard]] bool on_device() const { return device_; }
    [[nodiscard]] MemoryPool& pool() const { return *pool_; }
    [[nodiscard]] CellPlaces places() const;
    [[nodiscard]] int64_t owned_cells() const { return int64_t{slots()} * tile_cells() * tile_cells(); }

    [[nodiscard]] SlabView<int32_t> ints(SimLayer layer) { return view<int32_t>(layer); }
    [[nodiscard]] SlabView<const int32_t> ints(SimLayer layer) const { return view<int32_t>(layer); }
    [[nodiscard]] SlabView<float> reals(SimLayer layer) { return view<float>(layer); }
    [[nodiscard]] SlabView<const float> reals(SimLayer layer) const { return view<float>(layer); }
    /// The words of a layer, whatever they mean.
    [[nodiscard]] SlabView<uint32_t> words(SimLayer layer) const;

    /// Copies owned cells in (rows of tile_cells words) and out; works for host and device memory.
    Status load(int32_t slot, SimLayer layer, const void* cells);
    Status store(int32_t slot, SimLayer layer, void* cells) const;
    /// Sets the cells of a frozen segment; rect is local, cells row by row. For tiles that are not resident.
    Status load_frozen(int32_t slot, int direction, SimLayer layer, const void* cells);
    /// Fills owned cells of every tile by f(world x, world y) -> int32 ticks or float.
    template <class F> Status fill(SimLayer layer, F&& f) {
        std::vector<uint32_t> cells(static_cast<size_t>(tile_cells()) * static_cast<size_t>(tile_cells()));
        for (int32_t slot = 0; slot < slots(); ++slot) {
            const TileKey key = layout_.tiles[static_cast<size_t>(slot)];
            size_t i = 0;
            for (int32_t y = 0; y < tile_cells(); ++y)
                for (int32_t x = 0; x < tile_cells(); ++x)
                    cells[i++] = __builtin_bit_cast(
                        uint32_t, f(key.x * tile_cells() + x, key.y * tile_cells() + y)); // a 4-byte value
            SAHEL_TRY(load(slot, layer, cells.data()));
        }
        return {};
    }

    [[nodiscard]] const HaloState& valid_halo() const { return valid_; }
    [[nodiscard]] int32_t valid_halo(SimLayer layer) const { return valid_[static_cast<size_t>(layer)]; }
    void set_valid_halo(SimLayer layer, int32_t cells);
    /// Called when owned cells were written by other means than a pass: their halos are stale.
    void touch(SimLayerSet layers);

    /// Refreshes whole halos from their owners and fills open borders.
    Status exchange(SimLayerSet layers);
    /// Fills the cells beyond open and level borders; after a pass wrote the layers.
    Status fill_edges(SimLayerSet layers);

    /// The launch over owned cells and `margin` halo cells.
    [[nodiscard]] const Launch& launch(int32_t margin, const char* name);
    /// The launch over the whole of every frozen segment.
    [[nodiscard]] const Launch& frozen_launch(const char* name);
    void set_order(VisitOrder order) { order_ = order; }
    [[nodiscard]] VisitOrder order() const { return order_; }

    /// Sum of owned cells of a tick layer, for each slot.
    Result<std::vector<int64_t>> sums(SimLayer layer) const;
    /// Hash of owned cells and their places in the world: the same for any tiling, order of tiles, machine.
    /// 32 hexadecimal digits. (A sum over cells of a mixed word; for comparing runs, not against forgery.)
    Result<std::string> hash(SimLayerSet layers) const;

    /// From now on passes account what crosses the borders of tiles (border_flows.h) and sources what they add, from
    /// zero. Errors: budget.
    Status keep_flows();
    /// The bytes that keep_flows takes of the pool, exactly.
    static uint64_t flow_bytes(const TileLayout& layout, SimLayerSet layers);
    [[nodiscard]] bool keeps_flows() const { return !flows_.empty(); }
    /// For the launchers of passes that move the conserved layer.
    [[nodiscard]] BorderFlowsView border_flows(SimLayer layer);
    /// Ticks that left each slot by each of its eight borders (came in: negative) since keep_flows.
    using SlotFlows = std::array<int64_t, k_direction_count>;
    [[nodiscard]] Result<std::vector<SlotFlows>> flows(SimLayer layer) const;
    /// What frozen neighbours were given since keep_flows: ticks for each halo cell, in FrameIndex order. Empty where
    /// nothing is frozen.
    [[nodiscard]] Result<std::vector<int32_t>> inbox(int32_t slot, SimLayer layer) const;
    /// Ticks that a named source added to a slot (taken: negative). Called by what adds them, when keeps_flows().
    void add_source(LedgerSource source, SimLayer layer, int32_t slot, int64_t ticks);
    [[nodiscard]] int64_t source(LedgerSource source, SimLayer layer, int32_t slot) const;
    /// Workspace that passes keep with the domain, by name; `fresh`: its bytes are not set. Errors: budget.
    Result<void*> scratch(const std::string& name, uint64_t bytes, bool* fresh = nullptr);
    [[nodiscard]] FrameIndex frame() const { return {tile_cells(), halo()}; }

    /// How often exchange ran, and how many halo words it moved.
    struct ExchangeCount {
        int64_t exchanges = 0;
        int64_t words = 0;
    };
    [[nodiscard]] ExchangeCount exchange_count() const { return counts_; }

  private:
    template <class T> [[nodiscard]] SlabView<T> view(SimLayer layer) const {
        SAHEL_CHECK((info_of(layer).type == LayerType::real) == (std::is_same_v<T, float>));
        const SlabView<uint32_t> w = words(layer);
        return {reinterpret_cast<T*>(w.origin), w.stride, w.slot_stride, w.first, w.last};
    }
    [[nodiscard]] size_t flow_index(SimLayer layer) const; ///< among the domain's conserved layers
    struct CoverList;
    const Launch& finished(CoverList& cover, const char* name);
    struct CoverList {
        std::vector<WorkItem> items;
        Buffer device_items;
        Launch launch;
    };

    TileLayout layout_;
    ExchangePlan plan_;
    SimLayerSet layers_;
    bool device_ = false;
    MemoryPool* pool_ = nullptr;
    int64_t stride_ = 0;
    int64_t slot_stride_ = 0;
    std::array<Buffer, k_sim_layer_count> slabs_;
    std::vector<int64_t> origins_;
    Buffer device_origins_;
    Buffer device_copies_;
    Buffer device_fills_;
    HaloState valid_{};
    std::map<int32_t, CoverList> covers_;
    VisitOrder order_ = VisitOrder::forward;
    ExchangeCount counts_;
    Buffer flows_;                 ///< int64 [conserved layer of the domain][slot][direction]
    Buffer inbox_;                 ///< int32 [conserved layer of the domain][slot][frame cell]
    Buffer frozen_;                ///< bits of frozen directions, by slot
    std::vector<int64_t> sources_; ///< [source][conserved layer of the domain][slot]
    std::map<std::string, Buffer> scratch_;
};

} // namespace sahel
