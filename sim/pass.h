#pragma once

#include "sim/sim_layers.h"
#include "world/check.h"
#include "world/executor.h"
#include "world/result.h"

#include <array>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <span>
#include <string_view>

/// A pass: a small functor over cells, and a declaration of how far it looks. The declaration is data: the step plan
/// (step_plan.h) adds radii up along the list of passes, and a property test proves every declaration by noise.
///
///     struct SlumpPass {                                         // slump_pass.h: one source for both machines
///         SlabView<const int32_t> in;
///         SlabView<int32_t> out;
///         SAHEL_HD void operator()(int32_t slot, int32_t x, int32_t y) const;     // writes its own cell alone
///     };
///     SAHEL_ISA_DECLARE(void run_slump(const Launch&, const SlumpPass&))
///     // slump_pass.cpp, by sahel_add_isa_sources: launch(l, pass);     slump_pass.cu: return cuda::launch(l, pass);
///
/// A pass gathers: it reads any cell within its radius and writes its own. A layer that it writes it may read at its
/// own cell only (else another cell could see either value).
namespace sahel {

struct LayerRead {
    SimLayer layer = SimLayer::count_;
    int32_t radius = 0; ///< in cells, largest of |dx| and |dy|
};

/// The reads of a pass; a fixed array, so that declarations can be constants.
class ReadList {
  public:
    static constexpr int k_capacity = 16;
    constexpr ReadList() = default;
    constexpr ReadList(std::initializer_list<LayerRead> reads) {
        for (const LayerRead& r : reads) add(r);
    }
    constexpr void add(LayerRead r) {
        SAHEL_CHECK(count_ < k_capacity);
        reads_[static_cast<size_t>(count_++)] = r;
    }
    [[nodiscard]] constexpr const LayerRead* begin() const { return reads_.data(); }
    [[nodiscard]] constexpr const LayerRead* end() const { return reads_.data() + count_; }
    [[nodiscard]] constexpr bool empty() const { return count_ == 0; }

  private:
    std::array<LayerRead, k_capacity> reads_{};
    int count_ = 0;
};

struct PassDecl {
    std::string_view name; ///< "sim/slump"; lives as long as the program
    ReadList reads;
    SimLayerSet writes;
    int32_t least_bytes = 0; ///< bytes per cell that no implementation can do without: each plane once

    /// The largest radius.
    [[nodiscard]] constexpr int32_t radius() const {
        int32_t r = 0;
        for (const LayerRead& read : reads) r = read.radius > r ? read.radius : r;
        return r;
    }
    [[nodiscard]] constexpr SimLayerSet read_set() const {
        SimLayerSet set;
        for (const LayerRead& read : reads) set.insert(read.layer);
        return set;
    }
    /// No layer is both written and read beside the own cell.
    [[nodiscard]] constexpr bool sound() const {
        for (const LayerRead& read : reads)
            if (read.radius < 0 || (read.radius > 0 && writes.contains(read.layer))) return false;
        return !writes.empty();
    }
    /// Makes working layers of nothing but the own cell: it is run on frozen cells too.
    [[nodiscard]] constexpr bool derives() const {
        bool working = true;
        writes.for_each([&](SimLayer l) {
            working = working && info_of(l).role == SimRole::working && info_of(l).outside == Outside::as_edge;
        });
        return working && radius() == 0;
    }
};

/// Cells of one tile that a launch covers.
struct WorkItem {
    int32_t slot = 0;
    LocalRect rect;
};

/// The order in which tiles and blocks are handed out. No result may depend on it; tests run both.
enum class VisitOrder : uint8_t { forward, backward };

/// One launch over all resident tiles. On the host `items` is memory of the host, on a device `device_items` of it.
struct Launch {
    const char* name = "";
    const WorkItem* items = nullptr;
    int32_t count = 0;
    VisitOrder order = VisitOrder::forward;
    int64_t cells = 0;
    LocalRect bounds; ///< around the rectangles of all items
    const WorkItem* device_items = nullptr;
};

class TileDomain;

/// What a pass is run with. `margin`: how many halo cells around the owned ones are to be computed.
struct PassRun {
    TileDomain& domain;
    const Launch& launch;
    int32_t margin;
};

/// A pass as the plan sees it. `run` covers exactly the launch's cells.
struct Pass {
    PassDecl decl;
    std::function<Status(const PassRun&)> run;
};

// The templates below are compiled into the caller's instruction set (executor.h says why they have a namespace).
inline namespace SAHEL_EXECUTOR_NAMESPACE {
namespace launch_detail {

inline constexpr int32_t k_rows_per_block = 16; // of a 2048 cell row: 32 KiB of each plane

template <class F> struct Work {
    const F* kernel;
    const WorkItem* items;
    int32_t count;
    int32_t blocks_per_item;
    bool backward;
};

template <class F> void run_block(const void* context, int64_t index) {
    const auto& work = *static_cast<const Work<F>*>(context);
    const int64_t i = work.backward ? static_cast<int64_t>(work.count) * work.blocks_per_item - 1 - index : index;
    const WorkItem item = work.items[i / work.blocks_per_item];
    const auto block = static_cast<int32_t>(i % work.blocks_per_item);
    const int32_t y0 = item.rect.y0 + block * k_rows_per_block;
    const int32_t y1 = y0 + k_rows_per_block < item.rect.y1 ? y0 + k_rows_per_block : item.rect.y1;
    const F f = *work.kernel; // a copy of its own: the compiler sees that no store of a cell changes it
    const int32_t slot = item.slot;
    const int32_t x0 = item.rect.x0;
    const int32_t x1 = item.rect.x1;
    for (int32_t y = y0; y < y1; ++y) {
        SAHEL_VECTORIZE
        for (int32_t x = x0; x < x1; ++x) f(slot, x, y);
    }
}

} // namespace launch_detail

/// f(slot, x, y) for every cell of every item, on the threads set.
template <class F> void launch(const Launch& l, const F& f) {
    if (l.count == 0 || l.bounds.empty()) return;
    const int32_t rows = l.bounds.y1 - l.bounds.y0;
    const int32_t per_item = (rows + launch_detail::k_rows_per_block - 1) / launch_detail::k_rows_per_block;
    const launch_detail::Work<F> work{&f, l.items, l.count, per_item, l.order == VisitOrder::backward};
    detail::run_blocks(l.name, l.cells, static_cast<int64_t>(l.count) * per_item, &launch_detail::run_block<F>, &work);
}

} // namespace SAHEL_EXECUTOR_NAMESPACE
} // namespace sahel
