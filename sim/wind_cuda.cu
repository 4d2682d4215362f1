#include "sim/pass_cuda.cuh"
#include "sim/wind_ground.h"
#include "sim/wind_pass.h"
#include "world/cuda_runtime.h"

namespace sahel {

namespace {

constexpr int k_block_x = 32;
constexpr int k_block_y = 4;

// One thread for each coarse cell: a row of it is one sector of memory.
__global__ void ground_sums_kernel(GroundSums f, int32_t first_slot) {
    const int32_t x = static_cast<int32_t>(blockIdx.x * k_block_x + threadIdx.x);
    const int32_t y = static_cast<int32_t>(blockIdx.y * k_block_y + threadIdx.y);
    const int32_t slot = first_slot + static_cast<int32_t>(blockIdx.z);
    if (x < f.n && y < f.n) f.out[(int64_t{slot} * f.n + y) * f.n + x] = f.sum(slot, x, y);
}

} // namespace

Status run_wind_pass_cuda(const Launch& l, const WindPass& f) {
    return cuda::launch(l, f);
}

Status run_ground_sums_cuda(const GroundSums& host, int32_t slots) {
    const uint64_t bytes = sizeof(int64_t) * static_cast<uint64_t>(slots) * host.n * host.n;
    if (bytes == 0) return {};
    SAHEL_ASSIGN(void* const device, cuda::allocate(bytes));
    const auto work = [&]() -> Status {
        constexpr int32_t k_most_slots = 65535;
        GroundSums f = host;
        f.out = static_cast<int64_t*>(device);
        for (int32_t first = 0; first < slots; first += k_most_slots) {
            const int32_t count = slots - first < k_most_slots ? slots - first : k_most_slots;
            const dim3 grid(static_cast<unsigned>((f.n + k_block_x - 1) / k_block_x),
                            static_cast<unsigned>((f.n + k_block_y - 1) / k_block_y), static_cast<unsigned>(count));
            ground_sums_kernel<<<grid, dim3(k_block_x, k_block_y)>>>(f, first);
            SAHEL_TRY(cuda::check_launch("sim/wind_ground"));
        }
        return cuda::copy_to_host(host.out, device, bytes);
    };
    Status done = work();
    cuda::free(device);
    return done;
}

} // namespace sahel
