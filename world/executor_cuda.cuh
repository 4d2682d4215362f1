#pragma once

#include "world/cuda_check.cuh"
#include "world/executor.h"

#include <cstdint>

/// The CUDA side of executor.h: the same functors, one launch over all resident tiles, blockIdx.z = slot. Included by
/// `.cu` launchers only. Views inside the functor point to device memory.
namespace sahel::cuda {

namespace detail {

inline constexpr int k_block_x = 64; // a row of 64 floats is two full memory segments
inline constexpr int k_block_y = 4;
inline constexpr int32_t k_max_grid_yz = 65535;

template <class F> __global__ void __launch_bounds__(k_block_x* k_block_y) rect_kernel(F f, LocalRect rect) {
    const int32_t x = rect.x0 + static_cast<int32_t>(blockIdx.x * k_block_x + threadIdx.x);
    const int32_t y = rect.y0 + static_cast<int32_t>(blockIdx.y * k_block_y + threadIdx.y);
    if (x < rect.x1 && y < rect.y1) f(x, y);
}

template <class F>
__global__ void __launch_bounds__(k_block_x* k_block_y) tiles_kernel(F f, LocalRect rect, int32_t first_slot) {
    const int32_t x = rect.x0 + static_cast<int32_t>(blockIdx.x * k_block_x + threadIdx.x);
    const int32_t y = rect.y0 + static_cast<int32_t>(blockIdx.y * k_block_y + threadIdx.y);
    if (x < rect.x1 && y < rect.y1) f(first_slot + static_cast<int32_t>(blockIdx.z), x, y);
}

inline dim3 grid_of(const LocalRect& rect, int32_t slots) {
    return {static_cast<unsigned>((rect.x1 - rect.x0 + k_block_x - 1) / k_block_x),
            static_cast<unsigned>((rect.y1 - rect.y0 + k_block_y - 1) / k_block_y), static_cast<unsigned>(slots)};
}

/// Times a launch with events while launches are recorded (which then wait for their end); else costs nothing.
class LaunchTimer {
  public:
    LaunchTimer(const char* name, int64_t cells, cudaStream_t stream) : name_(name), cells_(cells), stream_(stream) {
        if (!sahel::detail::launches_recorded()) return;
        on_ = cudaEventCreate(&start_) == cudaSuccess && cudaEventCreate(&stop_) == cudaSuccess &&
              cudaEventRecord(start_, stream_) == cudaSuccess;
    }
    LaunchTimer(const LaunchTimer&) = delete;
    LaunchTimer& operator=(const LaunchTimer&) = delete;
    ~LaunchTimer() {
        if (start_ != nullptr) (void)cudaEventDestroy(start_);
        if (stop_ != nullptr) (void)cudaEventDestroy(stop_);
    }
    Status finish() {
        if (!on_) return {};
        float ms = 0.0f;
        SAHEL_TRY(check_call(cudaEventRecord(stop_, stream_), name_));
        SAHEL_TRY(check_call(cudaEventSynchronize(stop_), name_));
        SAHEL_TRY(check_call(cudaEventElapsedTime(&ms, start_, stop_), name_));
        sahel::detail::add_launch(name_, cells_, static_cast<double>(ms));
        return {};
    }

  private:
    const char* name_;
    int64_t cells_;
    cudaStream_t stream_;
    cudaEvent_t start_ = nullptr;
    cudaEvent_t stop_ = nullptr;
    bool on_ = false;
};

} // namespace detail

/// f(x, y) for every cell of the rectangle (at most 262140 rows). Returns at once; an error names the launch.
template <class F>
Status for_each_cell(const char* name, const LocalRect& rect, const F& f, cudaStream_t stream = nullptr) {
    if (rect.empty()) return {};
    SAHEL_CHECK_LE(rect.y1 - rect.y0, detail::k_max_grid_yz * detail::k_block_y);
    detail::LaunchTimer timer(name, rect.area(), stream);
    detail::rect_kernel<<<detail::grid_of(rect, 1), dim3(detail::k_block_x, detail::k_block_y), 0, stream>>>(f, rect);
    SAHEL_TRY(check_launch(name));
    return timer.finish();
}

/// f(slot, x, y) for every cell of the rectangle in each of `slots` tiles: one launch up to 65535 tiles.
template <class F>
Status for_each_cell(const char* name, int32_t slots, const LocalRect& rect, const F& f,
                     cudaStream_t stream = nullptr) {
    if (rect.empty() || slots <= 0) return {};
    SAHEL_CHECK_LE(rect.y1 - rect.y0, detail::k_max_grid_yz * detail::k_block_y);
    detail::LaunchTimer timer(name, rect.area() * slots, stream);
    for (int32_t first = 0; first < slots; first += detail::k_max_grid_yz) {
        const int32_t count = slots - first < detail::k_max_grid_yz ? slots - first : detail::k_max_grid_yz;
        detail::tiles_kernel<<<detail::grid_of(rect, count), dim3(detail::k_block_x, detail::k_block_y), 0, stream>>>(
            f, rect, first);
        SAHEL_TRY(check_launch(name));
    }
    return timer.finish();
}

} // namespace sahel::cuda
