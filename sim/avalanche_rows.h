#pragma once

#include "sim/avalanche_blocks.h"
#include "sim/avalanche_rules.h"
#include "sim/slab_view.h"
#include "world/cpu_features.h"
#include "world/executor.h"

#include <cstdint>

/// Sweeps on the CPU, block by block. Every pair of neighbours is looked at once: rows of the block stream through a
/// ring of a few rows that stays in the caches, the loops over a row are vectorised, and what slid between two
/// rows is added to both.
///
///     pairs of row y   E: (x, y)-(x+1, y)   SE: (x, y)-(x+1, y+1)   S: (x, y)-(x, y+1)   SW: (x, y)-(x-1, y+1)
namespace sahel {

/// For each block of `work` whether anything stands steeper than repose by more than `start_ticks`. Looks 1 cell
/// beyond.
struct SlideProbe {
    SlideGround ground;
    int32_t start_ticks = 0;
};

/// One sweep of the donor rule from the present plane to the next. Looks 2 cells beyond.
struct SlideSweep {
    SlideGround ground; ///< its view of what slides: the present plane
    SlideRule rule;
    SlabView<int32_t> out;   ///< the next plane
    SlabView<int32_t> taken; ///< where rock arrives as sand: the sand, changed at the own cell; else null
};

/// What slides between the pairs of each cell and its four neighbours ahead. Looks 1 cell beyond.
struct SlideFlows {
    SlideGround ground;
    SlideInertia rule;
    SlabView<int32_t> e, se, s, sw; ///< in place
};

/// Moves what slides. Looks 1 cell beyond, at the flows.
struct SlideApply {
    SlideGround ground; ///< for what is closed
    SlabView<const int32_t> e, se, s, sw;
    SlabView<int32_t> sand; ///< in place
};

/// Work on blocks and the flag of each (null: not wanted).
struct SlideLaunch {
    const char* name = "";
    const SlideWork* work = nullptr;
    int32_t count = 0;
    uint8_t* slid = nullptr;
    bool backward = false;
    int64_t cells = 0;
};

SAHEL_ISA_DECLARE(void probe_slides(const SlideLaunch& l, const SlideProbe& f);
                  void sweep_slides(const SlideLaunch& l, const SlideSweep& f);
                  void flow_slides(const SlideLaunch& l, const SlideFlows& f);
                  void apply_slides(const SlideLaunch& l, const SlideApply& f))

} // namespace sahel
