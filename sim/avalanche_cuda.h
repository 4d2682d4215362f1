#pragma once

#include "sim/avalanche_blocks.h"
#include "sim/avalanche_donors.h"
#include "world/result.h"

#include <cstdint>

/// Sweeps on a device, block by block. Built without CUDA these answer "unsupported" (avalanche_cuda_none.cpp).
namespace sahel::cuda {

inline constexpr int32_t k_slide_device_block_x = 64;
inline constexpr int32_t k_slide_device_block_y = 16;

/// The account of what may move (avalanche_blocks.h), in device memory: every block looks at the nine flags of the
/// sweep before, and returns at once where nothing can have changed.
struct SlideFlags {
    SlideGrid grid;
    bool adaptive = true;
    uint8_t* before = nullptr; ///< [block]: something slid in the last sweep, or the block is to be worked out
    uint8_t* now = nullptr;    ///< [block]: written by this sweep
    float* quiet = nullptr;    ///< [block]: strongest rule under which it was found quiet, below 0: not known
    unsigned long long* cells = nullptr; ///< worked out so far
    int32_t* slid = nullptr;             ///< set where anything slid in this sweep
};

/// Every block is to be worked out.
Status wake_slides(const SlideFlags& flags);
/// Those that touch the halo are.
Status wake_slides_in_halo(const SlideFlags& flags);
Status sweep_slides(const SlideFlags& flags, int32_t margin, const SlideSweep& f);
Status flow_slides(const SlideFlags& flags, int32_t margin, const SlideFlows& f);
/// Where the flows of this sweep (flags.now) reach.
Status apply_slides(const SlideFlags& flags, int32_t margin, const SlideApply& f);
/// Copies slabs, or only what lies beyond the owned cells.
Status copy_slides(int32_t slots, int32_t n, SlabView<const int32_t> from, SlabView<int32_t> to, bool halo_alone);
Status zero_slides(int32_t slots, SlabView<int32_t> flows);

/// As passes.
Status run_slides(const Launch& l, const SlideSweepCell& f);
Status run_slides(const Launch& l, const SlideFlowsCell& f);
Status run_slides(const Launch& l, const SlideApplyCell& f);
Status add_slide_flows(int32_t slots, const BorderFlowsView& view, const SlideDonor& donor);
Status add_slide_flows(int32_t slots, const BorderFlowsView& view, const SlideFlowDonor& donor);

} // namespace sahel::cuda
