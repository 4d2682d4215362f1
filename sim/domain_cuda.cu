#include "sim/domain_cuda.h"

#include "world/cuda_check.cuh"
#include "world/cuda_runtime.h"

#include <algorithm>

namespace sahel::cuda {

namespace {

constexpr int k_threads = 256;
constexpr int32_t k_max_blocks_x = 4096; // of one copy; threads stride over the rest

dim3 grid_of(int32_t longest_cells, int32_t count) {
    const int32_t blocks = std::clamp((longest_cells + k_threads - 1) / k_threads, 1, k_max_blocks_x);
    return {static_cast<unsigned>(blocks), static_cast<unsigned>(count)};
}

__device__ uint32_t source_word(const HaloCopy& c, SlabView<const uint32_t> slab, Mirror mirror, int32_t x, int32_t y) {
    const uint32_t word = slab(c.src_slot, c.src_x + x * c.step_x, c.src_y + y * c.step_y);
    return mirrored_word(word, mirror, c.step_x < 0, c.step_y < 0);
}

__global__ void exchange_kernel(const HaloCopy* copies, SlabView<uint32_t> slab, Mirror mirror) {
    const HaloCopy c = copies[blockIdx.y];
    const int32_t width = c.dst.x1 - c.dst.x0;
    const int32_t cells = width * (c.dst.y1 - c.dst.y0);
    for (int32_t i = blockIdx.x * k_threads + threadIdx.x; i < cells; i += gridDim.x * k_threads) {
        const int32_t x = i % width;
        const int32_t y = i / width;
        slab(c.dst_slot, c.dst.x0 + x, c.dst.y0 + y) = source_word(c, slab, mirror, x, y);
    }
}

__global__ void pack_kernel(const HaloCopy* copies, int32_t count, SlabView<const uint32_t> slab, Mirror mirror,
                            uint32_t* words) {
    int64_t first = 0;
    for (int32_t i = 0; i < static_cast<int32_t>(blockIdx.y); ++i) first += copies[i].dst.area();
    const HaloCopy c = copies[blockIdx.y];
    const int32_t width = c.dst.x1 - c.dst.x0;
    const int32_t cells = width * (c.dst.y1 - c.dst.y0);
    for (int32_t i = blockIdx.x * k_threads + threadIdx.x; i < cells; i += gridDim.x * k_threads)
        words[first + i] = source_word(c, slab, mirror, i % width, i / width);
}

__global__ void unpack_kernel(const HaloCopy* copies, int32_t count, SlabView<uint32_t> slab, const uint32_t* words) {
    int64_t first = 0;
    for (int32_t i = 0; i < static_cast<int32_t>(blockIdx.y); ++i) first += copies[i].dst.area();
    const HaloCopy c = copies[blockIdx.y];
    const int32_t width = c.dst.x1 - c.dst.x0;
    const int32_t cells = width * (c.dst.y1 - c.dst.y0);
    for (int32_t i = blockIdx.x * k_threads + threadIdx.x; i < cells; i += gridDim.x * k_threads)
        slab(c.dst_slot, c.dst.x0 + i % width, c.dst.y0 + i / width) = words[first + i];
}

__global__ void fill_words_kernel(uint32_t* words, int64_t count, uint32_t value) {
    const int64_t step = static_cast<int64_t>(gridDim.x) * k_threads;
    for (int64_t i = static_cast<int64_t>(blockIdx.x) * k_threads + threadIdx.x; i < count; i += step) words[i] = value;
}

__global__ void fill_edges_kernel(const EdgeFill* fills, EdgeLayers layers) {
    const EdgeFill f = fills[blockIdx.y];
    const int32_t width = f.dst.x1 - f.dst.x0;
    const int32_t cells = width * (f.dst.y1 - f.dst.y0);
    for (int32_t i = blockIdx.x * k_threads + threadIdx.x; i < cells; i += gridDim.x * k_threads) {
        layers.fill(f, f.dst.x0 + i % width, f.dst.y0 + i / width);
    }
}

__global__ void sums_kernel(SlabView<const int32_t> slab, int32_t n, unsigned long long* out) {
    __shared__ unsigned long long partial[k_threads];
    const int32_t slot = static_cast<int32_t>(blockIdx.y);
    long long sum = 0;
    for (int32_t y = static_cast<int32_t>(blockIdx.x); y < n; y += gridDim.x)
        for (int32_t x = threadIdx.x; x < n; x += k_threads) sum += slab(slot, x, y);
    partial[threadIdx.x] = static_cast<unsigned long long>(sum); // modulo 2^64: exact whatever the order
    __syncthreads();
    for (int half = k_threads / 2; half > 0; half /= 2) {
        if (threadIdx.x < half) partial[threadIdx.x] += partial[threadIdx.x + half];
        __syncthreads();
    }
    if (threadIdx.x == 0) atomicAdd(out + slot, partial[0]);
}

} // namespace

Status exchange(const HaloCopy* device_copies, int32_t count, int32_t longest_cells, SlabView<uint32_t> slab,
                Mirror mirror) {
    if (count == 0) return {};
    exchange_kernel<<<grid_of(longest_cells, count), k_threads>>>(device_copies, slab, mirror);
    return check_launch("sim/exchange");
}

Status pack(const HaloCopy* device_copies, const HaloMessage& m, SlabView<const uint32_t> slab, Mirror mirror,
            uint32_t* words) {
    pack_kernel<<<grid_of(static_cast<int32_t>(m.cells), m.copy_count), k_threads>>>(device_copies + m.first_copy,
                                                                                     m.copy_count, slab, mirror, words);
    return check_launch("sim/pack");
}

Status unpack(const HaloCopy* device_copies, const HaloMessage& m, SlabView<uint32_t> slab, const uint32_t* words) {
    unpack_kernel<<<grid_of(static_cast<int32_t>(m.cells), m.copy_count), k_threads>>>(device_copies + m.first_copy,
                                                                                       m.copy_count, slab, words);
    return check_launch("sim/unpack");
}

Status fill_words(uint32_t* words, int64_t count, uint32_t value) {
    if (count == 0) return {};
    const auto blocks = static_cast<unsigned>(std::min<int64_t>((count + k_threads - 1) / k_threads, 65535));
    fill_words_kernel<<<blocks, k_threads>>>(words, count, value);
    return check_launch("sim/fill_words");
}

Status fill_edges(const EdgeFill* device_fills, int32_t count, int32_t longest_cells, const EdgeLayers& layers) {
    if (count == 0) return {};
    fill_edges_kernel<<<grid_of(longest_cells, count), k_threads>>>(device_fills, layers);
    return check_launch("sim/fill_edges");
}

Status sums(SlabView<const int32_t> slab, int32_t slots, int32_t n, int64_t* host_sums) {
    const uint64_t bytes = sizeof(int64_t) * static_cast<uint64_t>(slots);
    SAHEL_ASSIGN(void* const device, allocate(bytes));
    const auto work = [&]() -> Status {
        SAHEL_TRY(fill_words(static_cast<uint32_t*>(device), 2 * int64_t{slots}, 0));
        sums_kernel<<<dim3(static_cast<unsigned>(std::min(n, 256)), static_cast<unsigned>(slots)), k_threads>>>(
            slab, n, static_cast<unsigned long long*>(device));
        SAHEL_TRY(check_launch("sim/sums"));
        return copy_to_host(host_sums, device, bytes);
    };
    Status done = work();
    free(device);
    return done;
}

} // namespace sahel::cuda
