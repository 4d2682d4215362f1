#pragma once

#include "sim/avalanche_rules.h"
#include "sim/border_flows.h"
#include "sim/pass.h"
#include "world/cpu_features.h"

#include <cstdint>

/// One sweep as a functor over cells, in the plainest form: every cell works out what it gives and, again, what each
/// neighbour gives to it. The faster kernels (avalanche_rows.h, avalanche.cu) give the same bits.
namespace sahel {

/// What cell (x, y) gives to each neighbour.
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

struct SlidePass {
    SlideDonor donor;
    SlabView<int32_t> out;   ///< next plane of what slides
    SlabView<int32_t> taken; ///< where rock arrives as sand: the sand, changed at the own cell

    SAHEL_HD void operator()(int32_t slot, int32_t x, int32_t y) const {
        const SlideDonor::Gift own = donor.gift(slot, x, y);
        int32_t given = 0;
        int32_t received = 0;
        for (int k = 0; k < k_direction_count; ++k) {
            given += slide_amount(own.excess[k], own.share);
            const SlideDonor::Gift from = donor.gift(slot, x + direction_x(k), y + direction_y(k));
            received += slide_amount(from.excess[k ^ 4], from.share);
        }
        const SlideGround& g = donor.ground;
        const int32_t now = g.kind == AvalancheKind::sand   ? g.sand(slot, x, y)
                            : g.kind == AvalancheKind::soil ? g.soil(slot, x, y)
                                                            : g.bedrock(slot, x, y);
        if (taken.origin) {
            out(slot, x, y) = now - given;
            taken(slot, x, y) += received;
        } else {
            out(slot, x, y) = now - given + received;
        }
    }
};

struct SlideCopy {
    SlabView<const int32_t> from;
    SlabView<int32_t> to;
    SAHEL_HD void operator()(int32_t slot, int32_t x, int32_t y) const { to(slot, x, y) = from(slot, x, y); }
};

SAHEL_ISA_DECLARE(void run_slide(const Launch& l, const SlidePass& f);
                  void run_slide_copy(const Launch& l, const SlideCopy& f))
Status run_slide_copy_cuda(const Launch& l, const SlideCopy& f);
Status run_slide_cuda(const Launch& l, const SlidePass& f);
Status add_slide_flows_cuda(int32_t slots, const BorderFlowsView& view, const SlideDonor& donor);

} // namespace sahel
