#pragma once

#include "sim/border_flows.h"
#include "world/cuda_check.cuh"

/// The CUDA side of border_flows.h: one thread a donor, blockIdx.z = slot, 64-bit integer atomics (sums of integers
/// commute, so that the order of threads does not show). Included by `.cu` launchers only.
namespace sahel::cuda {

namespace border_flows_detail {

struct AtomicAdd {
    __device__ void operator()(int64_t& sum, int64_t amount) const {
        atomicAdd(reinterpret_cast<unsigned long long*>(&sum), static_cast<unsigned long long>(amount));
    }
    __device__ void operator()(int32_t& sum, int32_t amount) const { atomicAdd(&sum, amount); }
};

template <class Donor>
__global__ void __launch_bounds__(256) donors_kernel(BorderFlowsView view, int32_t reach, Donor donor) {
    const int32_t n = view.frame.n;
    const int32_t side = n + 2 * reach;
    const int64_t i = static_cast<int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
    const int32_t band = 4 * reach < side ? 4 * reach : side; // rows above and below, then columns left and right
    const int64_t rows = static_cast<int64_t>(band) * side;
    const int64_t columns = band == side ? 0 : static_cast<int64_t>(side - band) * band;
    if (i >= rows + columns) return;
    int32_t x = 0;
    int32_t y = 0;
    if (i < rows) {
        y = static_cast<int32_t>(i / side);
        x = static_cast<int32_t>(i % side);
        if (y >= 2 * reach) y += side - band;
    } else {
        const int64_t j = i - rows;
        y = 2 * reach + static_cast<int32_t>(j / band);
        x = static_cast<int32_t>(j % band);
        if (x >= 2 * reach) x += side - band;
    }
    const auto slot = static_cast<int32_t>(blockIdx.z);
    x -= reach;
    y -= reach;
    const int from = direction_of(x < 0 ? -1 : static_cast<int32_t>(x >= n), y < 0 ? -1 : static_cast<int32_t>(y >= n));
    const BorderSink<AtomicAdd> sink{view, slot, from, {}};
    donor(slot, x, y, sink);
}

} // namespace border_flows_detail

template <class Donor>
Status add_border_flows(const char* name, int32_t slots, const BorderFlowsView& view, int32_t reach,
                        const Donor& donor) {
    if (slots == 0 || reach == 0) return {};
    const int64_t side = view.frame.n + 2 * int64_t{reach};
    const int64_t band = 4 * int64_t{reach} < side ? 4 * int64_t{reach} : side;
    const int64_t donors = band * side + (band == side ? 0 : (side - band) * band);
    constexpr int k_threads = 256;
    const dim3 grid(static_cast<unsigned>((donors + k_threads - 1) / k_threads), 1, static_cast<unsigned>(slots));
    border_flows_detail::donors_kernel<<<grid, k_threads>>>(view, reach, donor);
    return check_launch(name);
}

} // namespace sahel::cuda
