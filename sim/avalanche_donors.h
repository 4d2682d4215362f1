#pragma once

#include "sim/avalanche_rows.h"
#include "sim/avalanche_rules.h"
#include "sim/border_flows.h"
#include "sim/pass.h"

#include <cstdint>

/// The sweeps as functors over cells, in their plainest form, and the donors of what crosses the borders of tiles
/// (border_flows.h). The row kernels of the host and the block kernels of a device give the same bits.
namespace sahel {

/// What cell (x, y) gives to each neighbour by the donor rule.
struct SlideDonor {
    SlideGround ground;
    SlideRule rule;

    struct Gift {
        int32_t excess[k_direction_count];
        float share;
    };
    SAHEL_HD Gift gift(int32_t slot, int32_t x, int32_t y) const {
        Gift g{{}, 0.0f};
        if (!ground.gives(slot, x, y)) return g;
        const SlideCell here = ground(slot, x, y);
        const int32_t across = repose_across(here.repose);
        int32_t sum = 0;
        int32_t largest = 0;
        for (int k = 0; k < k_direction_count; ++k) {
            const int32_t drop = here.height - ground(slot, x + direction_x(k), y + direction_y(k)).height;
            const int32_t e = slide_excess(drop, (k & 1) != 0 ? across : here.repose);
            g.excess[k] = e;
            sum += e;
            largest = e > largest ? e : largest;
        }
        g.share = slide_share(rule, sum, largest, here.limit);
        return g;
    }
    template <class Sink> SAHEL_HD void operator()(int32_t slot, int32_t x, int32_t y, Sink& sink) const {
        const Gift g = gift(slot, x, y);
        for (int k = 0; k < k_direction_count; ++k)
            sink(x + direction_x(k), y + direction_y(k), slide_amount(g.excess[k], g.share));
    }
};

/// What cell (x, y) gives by the flows of its eight edges.
struct SlideFlowDonor {
    SlabView<const int32_t> e, se, s, sw;

    template <class Sink> SAHEL_HD void operator()(int32_t slot, int32_t x, int32_t y, Sink& sink) const {
        const int32_t ahead[4] = {e(slot, x, y), se(slot, x, y), s(slot, x, y), sw(slot, x, y)};
        const int32_t behind[4] = {e(slot, x - 1, y), se(slot, x - 1, y - 1), s(slot, x, y - 1),
                                   sw(slot, x + 1, y - 1)};
        int32_t any = 0;
        for (int k = 0; k < 4; ++k) any |= ahead[k] | behind[k];
        if (any == 0) return; // nearly everywhere
        for (int k = 0; k < 4; ++k) {
            sink(x + direction_x(k), y + direction_y(k), ahead[k] > 0 ? ahead[k] : 0);
            sink(x - direction_x(k), y - direction_y(k), behind[k] < 0 ? -behind[k] : 0);
        }
    }
};

/// One sweep of the donor rule.
struct SlideSweepCell {
    SlideSweep sweep;

    SAHEL_HD void operator()(int32_t slot, int32_t x, int32_t y) const {
        const SlideDonor donor{sweep.ground, sweep.rule};
        const SlideDonor::Gift own = donor.gift(slot, x, y);
        int32_t given = 0;
        int32_t received = 0;
        for (int k = 0; k < k_direction_count; ++k) {
            given += slide_amount(own.excess[k], own.share);
            const SlideDonor::Gift from = donor.gift(slot, x + direction_x(k), y + direction_y(k));
            received += slide_amount(from.excess[k ^ 4], from.share);
        }
        const SlideGround& g = sweep.ground;
        const int32_t now = g.sliding()(slot, x, y);
        if (sweep.taken.origin) {
            sweep.out(slot, x, y) = now - given;
            sweep.taken(slot, x, y) += received;
        } else {
            sweep.out(slot, x, y) = now - given + received;
        }
    }
};

/// The flows of the four edges of a cell; the bits of all that are not 0.
struct SlideFlowsCell {
    SlideFlows f;

    SAHEL_HD static SlideSide side(const SlideCell& c, bool across, bool gives) {
        return {across ? repose_across(c.repose) : c.repose, gives ? slide_cap(c.limit) : 0};
    }
    SAHEL_HD int32_t edge(int32_t slot, int32_t x, int32_t y, const SlideCell& here, bool gives, int k,
                          int32_t& flow) const {
        const SlideGround& g = f.ground;
        const int32_t x2 = x + direction_x(k);
        const int32_t y2 = y + direction_y(k);
        if (g.sealed(slot, x, y, x2, y2)) return flow = 0;
        const SlideCell there = g(slot, x2, y2);
        const bool across = (k & 1) != 0;
        const int32_t before = g.remembered(slot, x, y, x2, y2, flow);
        return flow = slide_flow(f.rule, before, here.height - there.height, side(here, across, gives),
                                 side(there, across, g.gives(slot, x2, y2)));
    }
    SAHEL_HD int32_t flow(int32_t slot, int32_t x, int32_t y) const {
        const SlideCell here = f.ground(slot, x, y);
        const bool gives = f.ground.gives(slot, x, y);
        return edge(slot, x, y, here, gives, 0, f.e(slot, x, y)) | edge(slot, x, y, here, gives, 1, f.se(slot, x, y)) |
               edge(slot, x, y, here, gives, 2, f.s(slot, x, y)) | edge(slot, x, y, here, gives, 3, f.sw(slot, x, y));
    }
    SAHEL_HD void operator()(int32_t slot, int32_t x, int32_t y) const { flow(slot, x, y); }
};

/// What the flows bring to a cell.
struct SlideApplyCell {
    SlideApply f;

    SAHEL_HD void operator()(int32_t slot, int32_t x, int32_t y) const {
        if (!f.ground.moves(slot, x, y)) return;
        const int32_t got = ((f.e(slot, x - 1, y) - f.e(slot, x, y)) + (f.se(slot, x - 1, y - 1) - f.se(slot, x, y))) +
                            ((f.s(slot, x, y - 1) - f.s(slot, x, y)) + (f.sw(slot, x + 1, y - 1) - f.sw(slot, x, y)));
        if (got != 0) f.sand(slot, x, y) += got;
    }
};

} // namespace sahel
