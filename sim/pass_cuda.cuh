#pragma once

#include "sim/pass.h"
#include "world/cuda_check.cuh"

#include <algorithm>
#include <cstdint>

/// The CUDA side of pass.h: the same functors, one launch over all resident tiles, blockIdx.z = work item. Included by
/// `.cu` launchers only.
namespace sahel::cuda {

namespace pass_detail {

inline constexpr int k_block_x = 64; // a row of 64 words is two full memory segments
inline constexpr int k_block_y = 4;
inline constexpr int32_t k_max_grid_z = 65535;

template <class F>
__global__ void __launch_bounds__(k_block_x* k_block_y) items_kernel(F f, const WorkItem* items, LocalRect bounds) {
    const WorkItem item = items[blockIdx.z];
    const int32_t x = bounds.x0 + static_cast<int32_t>(blockIdx.x * k_block_x + threadIdx.x);
    const int32_t y = bounds.y0 + static_cast<int32_t>(blockIdx.y * k_block_y + threadIdx.y);
    if (x >= item.rect.x0 && x < item.rect.x1 && y >= item.rect.y0 && y < item.rect.y1) f(item.slot, x, y);
}

} // namespace pass_detail

/// f(slot, x, y) for every cell of every item. Returns at once; an error names the launch.
template <class F> Status launch(const Launch& l, const F& f) {
    using namespace pass_detail;
    if (l.count == 0 || l.bounds.empty()) return {};
    for (int32_t first = 0; first < l.count; first += k_max_grid_z) {
        const dim3 grid(static_cast<unsigned>((l.bounds.x1 - l.bounds.x0 + k_block_x - 1) / k_block_x),
                        static_cast<unsigned>((l.bounds.y1 - l.bounds.y0 + k_block_y - 1) / k_block_y),
                        static_cast<unsigned>(std::min(l.count - first, k_max_grid_z)));
        items_kernel<<<grid, dim3(k_block_x, k_block_y)>>>(f, l.device_items + first, l.bounds);
        SAHEL_TRY(check_launch(l.name));
    }
    return {};
}

} // namespace sahel::cuda
