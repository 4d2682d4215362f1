#pragma once

#include "sim/exchange_plan.h"
#include "sim/sim_layers.h"
#include "sim/slab_view.h"
#include "world/executor.h"
#include "world/macros.h"

#include <algorithm>
#include <array>
#include <cstdint>

/// What crosses the borders of tiles, tick by tick: the ledger's transfers, and the inboxes of frozen neighbours.
///
/// A pass that moves a conserved amount offers, beside the functor that writes cells, a donor:
///
///     struct HopDonor {                        // says what cell (x, y) gives, with the arithmetic of the pass itself
///         template <class Sink> SAHEL_HD void operator()(int32_t slot, int32_t x, int32_t y, Sink& sink) const {
///             sink(x2, y2, ticks);             // for every other cell that it gives to
///         }
///     };
///
/// add_border_flows asks the donors that lie within `reach` of a tile's border, on both sides of it: what leaves counts
/// as positive at the border it leaves by, what comes in as negative at the border it comes from. Both tiles of a
/// border measure it from what they themselves compute, so that the two must cancel; the ledger checks that.
///
///     halo |reach| owned |reach| halo          donors of a tile: the two frames of width `reach`
namespace sahel {

/// The halo of a tile as one array: n x n owned cells are left out. Used for what waits at frozen neighbours.
struct FrameIndex {
    int32_t n = 0;
    int32_t halo = 0;
    [[nodiscard]] SAHEL_HD int64_t count() const { return 4 * static_cast<int64_t>(halo) * (n + halo); }
    /// Of a halo cell (x, y), both in [-halo, n + halo).
    [[nodiscard]] SAHEL_HD int64_t of(int32_t x, int32_t y) const {
        const int64_t width = n + 2 * static_cast<int64_t>(halo);
        if (y < 0) return (y + halo) * width + (x + halo);
        if (y >= n) return halo * width + n * 2 * static_cast<int64_t>(halo) + (y - n) * width + (x + halo);
        return halo * width + y * 2 * static_cast<int64_t>(halo) + (x < 0 ? x + halo : halo + (x - n));
    }
};

/// What kernels see: for one conserved layer, the flows of every slot's eight borders, and the inboxes.
struct BorderFlowsView {
    int64_t* flows = nullptr;        ///< [slot][direction], out positive, ticks
    int32_t* inbox = nullptr;        ///< [slot][frame cell], ticks; null: nothing is frozen
    const uint8_t* frozen = nullptr; ///< [slot]: bit k: direction k is frozen
    FrameIndex frame;
};

/// One donor's sink, with or without atomics.
template <class Add> struct BorderSink {
    BorderFlowsView view;
    int32_t slot;
    int32_t from; ///< direction of the donor's own cell, -1: owned
    Add add;
    SAHEL_HD void operator()(int32_t x, int32_t y, int32_t ticks) const {
        if (ticks == 0) return;
        const int32_t n = view.frame.n;
        const int to =
            direction_of(x < 0 ? -1 : static_cast<int32_t>(x >= n), y < 0 ? -1 : static_cast<int32_t>(y >= n));
        int64_t* flows = view.flows + static_cast<int64_t>(slot) * k_direction_count;
        if (from < 0) {
            if (to < 0) return;
            add(flows[to], static_cast<int64_t>(ticks));
            if (view.inbox && (view.frozen[slot] >> to & 1) != 0)
                add(view.inbox[static_cast<int64_t>(slot) * view.frame.count() + view.frame.of(x, y)], ticks);
        } else if (to < 0) {
            add(flows[from], -static_cast<int64_t>(ticks));
        }
    }
};

struct PlainAdd {
    template <class T> SAHEL_HD void operator()(T& sum, T amount) const { sum += amount; }
};

/// Asks every donor of one slot whose amounts may cross a border. Serial within a slot: no atomics on the host.
template <class Donor, class Add>
SAHEL_HD void ask_border_donor(const BorderFlowsView& view, const Donor& donor, int32_t slot, int32_t x, int32_t y,
                               const Add& add) {
    const int32_t n = view.frame.n;
    const int from = direction_of(x < 0 ? -1 : static_cast<int32_t>(x >= n), y < 0 ? -1 : static_cast<int32_t>(y >= n));
    const BorderSink<Add> sink{view, slot, from, add};
    donor(slot, x, y, sink);
}

/// On the host; `reach` is at most the halo. The CUDA form is in border_flows_cuda.cuh.
template <class Donor>
void add_border_flows(const char* name, int32_t slots, const BorderFlowsView& view, int32_t reach, const Donor& donor) {
    const int32_t n = view.frame.n, r = reach;
    for_each_index(name, int64_t{slots} * 8 * n * r, slots, [&](int64_t i) {
        const auto slot = static_cast<int32_t>(i);
        for (int32_t y = -r; y < n + r; ++y) {
            const bool whole = y < r || y >= n - r || 2 * r >= n;
            for (int32_t x = -r; x < (whole ? n + r : r); ++x) ask_border_donor(view, donor, slot, x, y, PlainAdd{});
            if (whole) continue;
            for (int32_t x = n - r; x < n + r; ++x) ask_border_donor(view, donor, slot, x, y, PlainAdd{});
        }
    });
}

} // namespace sahel
