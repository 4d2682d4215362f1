#include "world/bandwidth.h"
#include "world/cuda_runtime.h"
#include "world/executor_cuda.cuh"
#include "world/memory.h"

#include <algorithm>

namespace sahel {

namespace {

struct Triad {
    float* a;
    const float* b;
    const float* c;
    float s;
    int32_t width;
    SAHEL_HD void operator()(int32_t x, int32_t y) const {
        const int64_t i = static_cast<int64_t>(y) * width + x;
        a[i] = b[i] + s * c[i];
    }
};

constexpr int k_repetitions = 10;
constexpr int32_t k_width = 1 << 14;

// Events that are given back on every way out.
struct Events {
    cudaEvent_t start = nullptr;
    cudaEvent_t stop = nullptr;
    Events() = default;
    Events(const Events&) = delete;
    Events& operator=(const Events&) = delete;
    ~Events() {
        if (start != nullptr) (void)cudaEventDestroy(start);
        if (stop != nullptr) (void)cudaEventDestroy(stop);
    }
};

} // namespace

Result<Bandwidth> measure_cuda_bandwidth(uint64_t array_bytes) {
    if (!cuda::available())
        return Error{ErrorKind::unsupported, "CUDA: no device to measure: " + cuda::status().why_not};
    const auto rows = static_cast<int32_t>(
        std::clamp<uint64_t>(array_bytes / (sizeof(float) * k_width), 1, cuda::detail::k_max_grid_yz));
    const uint64_t bytes = static_cast<uint64_t>(rows) * k_width * sizeof(float);
    MemoryPool pool("bandwidth measurement", MemoryKind::cuda, 3 * bytes + 4096);
    SAHEL_ASSIGN(const Buffer a, Buffer::allocate(pool, bytes));
    SAHEL_ASSIGN(const Buffer b, Buffer::allocate(pool, bytes));
    SAHEL_ASSIGN(const Buffer c, Buffer::allocate(pool, bytes));
    SAHEL_TRY(cuda::check_call(cudaMemset(b.data(), 0, bytes), "cudaMemset"));
    SAHEL_TRY(cuda::check_call(cudaMemset(c.data(), 0, bytes), "cudaMemset"));
    const Triad triad{static_cast<float*>(a.data()), static_cast<const float*>(b.data()),
                      static_cast<const float*>(c.data()), 2.0f, k_width};
    const LocalRect rect{0, 0, k_width, rows};
    Events events;
    SAHEL_TRY(cuda::check_call(cudaEventCreate(&events.start), "cudaEventCreate"));
    SAHEL_TRY(cuda::check_call(cudaEventCreate(&events.stop), "cudaEventCreate"));
    float best_ms = 1e30f;
    for (int r = 0; r < k_repetitions; ++r) {
        float ms = 0.0f;
        SAHEL_TRY(cuda::check_call(cudaEventRecord(events.start), "world/triad"));
        SAHEL_TRY(cuda::for_each_cell("world/triad", rect, triad));
        SAHEL_TRY(cuda::check_call(cudaEventRecord(events.stop), "world/triad"));
        SAHEL_TRY(cuda::check_call(cudaEventSynchronize(events.stop), "world/triad"));
        SAHEL_TRY(cuda::check_call(cudaEventElapsedTime(&ms, events.start, events.stop), "world/triad"));
        best_ms = std::min(best_ms, ms);
    }
    return Bandwidth{3.0 * static_cast<double>(bytes) / static_cast<double>(best_ms) * 1e-6, bytes, 0};
}

} // namespace sahel
