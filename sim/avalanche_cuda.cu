#include "sim/avalanche_cuda.h"
#include "sim/border_flows_cuda.cuh"
#include "sim/pass_cuda.cuh"

#include <algorithm>

namespace sahel::cuda {

namespace {

constexpr int k_threads_x = k_slide_device_block_x;
constexpr int k_threads_y = 4;
constexpr int k_rim = 2;
constexpr int k_wide = k_slide_device_block_x + 2 * k_rim;
constexpr int k_high = k_slide_device_block_y + 2 * k_rim;

struct Place {
    int32_t slot, block;
    LocalRect rect;
};

__device__ Place place_of(const SlideGrid& g, int32_t margin) {
    const auto bx = static_cast<int32_t>(blockIdx.x);
    const auto by = static_cast<int32_t>(blockIdx.y);
    const auto slot = static_cast<int32_t>(blockIdx.z);
    return {slot, slot * g.per_slot() + by * g.count_x + bx, g.rect(bx, by, margin)};
}

// Whether something slid in one of the nine blocks. Every thread of the block gets the answer.
__device__ bool any_of_nine(const SlideGrid& g, const uint8_t* flags) {
    const auto t = static_cast<int32_t>(threadIdx.y * blockDim.x + threadIdx.x);
    int found = 0;
    if (t < 9) {
        const int32_t bx = static_cast<int32_t>(blockIdx.x) + t % 3 - 1;
        const int32_t by = static_cast<int32_t>(blockIdx.y) + t / 3 - 1;
        if (bx >= 0 && by >= 0 && bx < g.count_x && by < g.count_y)
            found = flags[static_cast<int32_t>(blockIdx.z) * g.per_slot() + by * g.count_x + bx];
    }
    return __syncthreads_or(found) != 0;
}

// Whether the block has to be worked out; else notes that nothing slid in it.
__device__ bool to_do(const SlideFlags& f, const Place& p, float strength) {
    if (p.rect.empty()) {
        if (threadIdx.x == 0 && threadIdx.y == 0) f.now[p.block] = 0;
        return false;
    }
    const bool changed = any_of_nine(f.grid, f.before);
    if (!f.adaptive || changed || f.quiet[p.block] < strength) return true;
    if (threadIdx.x == 0 && threadIdx.y == 0) f.now[p.block] = 0;
    return false;
}

// `changed` was asked before; the strongest quiet rule is forgotten where something slid around.
__device__ void note(const SlideFlags& f, const Place& p, bool changed, bool slid, float strength) {
    if (threadIdx.x != 0 || threadIdx.y != 0) return;
    const float known = changed ? -1.0f : f.quiet[p.block];
    f.quiet[p.block] = slid ? -1.0f : (known > strength ? known : strength);
    f.now[p.block] = slid ? 1 : 0;
    if (slid) *f.slid = 1;
    atomicAdd(f.cells, static_cast<unsigned long long>(p.rect.area()));
}

__global__ void __launch_bounds__(k_threads_x* k_threads_y)
    sweep_kernel(SlideFlags flags, int32_t margin, SlideSweep f) {
    __shared__ int32_t height[k_high][k_wide];
    __shared__ int32_t repose[k_high][k_wide];
    __shared__ float share[k_high][k_wide];
    const Place p = place_of(flags.grid, margin);
    if (!to_do(flags, p, f.rule.strength)) return;
    const bool changed = any_of_nine(flags.grid, flags.before);
    const SlideGround& g = f.ground;
    const int32_t w = p.rect.x1 - p.rect.x0;
    const int32_t h = p.rect.y1 - p.rect.y0;
    const auto tx = static_cast<int32_t>(threadIdx.x);
    const auto ty = static_cast<int32_t>(threadIdx.y);
    for (int32_t r = ty; r < h + 2 * k_rim; r += k_threads_y)
        for (int32_t c = tx; c < w + 2 * k_rim; c += k_threads_x) {
            const int32_t x = p.rect.x0 + c - k_rim;
            const int32_t y = p.rect.y0 + r - k_rim;
            const SlideCell cell = g(p.slot, x, y);
            height[r][c] = cell.height;
            repose[r][c] = cell.repose;
            share[r][c] = __int_as_float(g.gives(p.slot, x, y) ? cell.limit : 0); // until the next step
        }
    __syncthreads();
    for (int32_t r = ty + 1; r < h + 2 * k_rim - 1; r += k_threads_y)
        for (int32_t c = tx + 1; c < w + 2 * k_rim - 1; c += k_threads_x) {
            const int32_t beside = repose[r][c];
            const int32_t across = repose_across(beside);
            int32_t sum = 0;
            int32_t largest = 0;
            for (int k = 0; k < k_direction_count; ++k) {
                const int32_t e = slide_excess(height[r][c] - height[r + direction_y(k)][c + direction_x(k)],
                                               (k & 1) != 0 ? across : beside);
                sum += e;
                largest = e > largest ? e : largest;
            }
            share[r][c] = slide_share(f.rule, sum, largest, __float_as_int(share[r][c]));
        }
    __syncthreads();
    int moved = 0;
    for (int32_t r = ty; r < h; r += k_threads_y)
        for (int32_t c = tx; c < w; c += k_threads_x) {
            const int32_t x = p.rect.x0 + c;
            const int32_t y = p.rect.y0 + r;
            const int32_t now = g.sliding()(p.slot, x, y);
            if (!g.gives(p.slot, x, y)) {
                f.out(p.slot, x, y) = now;
                continue;
            }
            const int32_t i = r + k_rim;
            const int32_t j = c + k_rim;
            const int32_t beside = repose[i][j];
            const int32_t across = repose_across(beside);
            int32_t given = 0;
            int32_t received = 0;
            for (int k = 0; k < k_direction_count; ++k) {
                const int32_t i2 = i + direction_y(k);
                const int32_t j2 = j + direction_x(k);
                const int32_t drop = height[i][j] - height[i2][j2];
                given += slide_amount(slide_excess(drop, (k & 1) != 0 ? across : beside), share[i][j]);
                const int32_t theirs = (k & 1) != 0 ? repose_across(repose[i2][j2]) : repose[i2][j2];
                received += slide_amount(slide_excess(-drop, theirs), share[i2][j2]);
            }
            moved |= given | received;
            if (f.taken.origin) {
                f.out(p.slot, x, y) = now - given;
                f.taken(p.slot, x, y) += received;
            } else {
                f.out(p.slot, x, y) = now - given + received;
            }
        }
    note(flags, p, changed, __syncthreads_or(moved) != 0, f.rule.strength);
}

__global__ void __launch_bounds__(k_threads_x* k_threads_y)
    flow_kernel(SlideFlags flags, int32_t margin, SlideFlows f) {
    const Place p = place_of(flags.grid, margin);
    if (!to_do(flags, p, 1.0f)) return;
    const bool changed = any_of_nine(flags.grid, flags.before);
    const SlideFlowsCell cell{f};
    int moved = 0;
    for (int32_t y = p.rect.y0 + static_cast<int32_t>(threadIdx.y); y < p.rect.y1; y += k_threads_y)
        for (int32_t x = p.rect.x0 + static_cast<int32_t>(threadIdx.x); x < p.rect.x1; x += k_threads_x)
            moved |= cell.flow(p.slot, x, y);
    note(flags, p, changed, __syncthreads_or(moved) != 0, 1.0f);
}

__global__ void __launch_bounds__(k_threads_x* k_threads_y)
    apply_kernel(SlideFlags flags, int32_t margin, SlideApply f) {
    const Place p = place_of(flags.grid, margin);
    if (p.rect.empty() || !any_of_nine(flags.grid, flags.now)) return;
    const SlideApplyCell cell{f};
    for (int32_t y = p.rect.y0 + static_cast<int32_t>(threadIdx.y); y < p.rect.y1; y += k_threads_y)
        for (int32_t x = p.rect.x0 + static_cast<int32_t>(threadIdx.x); x < p.rect.x1; x += k_threads_x)
            cell(p.slot, x, y);
}

__global__ void wake_kernel(SlideFlags flags, bool halo_alone) {
    const SlideGrid& g = flags.grid;
    const auto i = static_cast<int32_t>(blockIdx.x * blockDim.x + threadIdx.x);
    if (i >= g.count()) return;
    const int32_t in_slot = i % g.per_slot();
    if (halo_alone && !g.in_halo(in_slot % g.count_x, in_slot / g.count_x)) return;
    flags.before[i] = 1;
    if (!halo_alone) flags.quiet[i] = -1.0f;
}

__global__ void copy_kernel(int32_t n, SlabView<const int32_t> from, SlabView<int32_t> to, bool halo_alone) {
    const int32_t y = static_cast<int32_t>(blockIdx.y) + from.first;
    const auto slot = static_cast<int32_t>(blockIdx.z);
    const int32_t x = static_cast<int32_t>(blockIdx.x * blockDim.x + threadIdx.x) + from.first;
    if (x >= from.last || (halo_alone && x >= 0 && x < n && y >= 0 && y < n)) return;
    to(slot, x, y) = from(slot, x, y);
}

__global__ void zero_kernel(SlabView<int32_t> to) {
    const int32_t y = static_cast<int32_t>(blockIdx.y) + to.first;
    const int32_t x = static_cast<int32_t>(blockIdx.x * blockDim.x + threadIdx.x) + to.first;
    if (x < to.last) to(static_cast<int32_t>(blockIdx.z), x, y) = 0;
}

dim3 grid_of(const SlideFlags& f) {
    return {static_cast<unsigned>(f.grid.count_x), static_cast<unsigned>(f.grid.count_y),
            static_cast<unsigned>(f.grid.slots)};
}

constexpr unsigned k_row_threads = 128;

dim3 rows_of(int32_t slots, int32_t side) {
    return {(static_cast<unsigned>(side) + k_row_threads - 1) / k_row_threads, static_cast<unsigned>(side),
            static_cast<unsigned>(slots)};
}

Status wake(const SlideFlags& flags, bool halo_alone) {
    constexpr int k_threads = 256;
    const auto blocks = static_cast<unsigned>((flags.grid.count() + k_threads - 1) / k_threads);
    wake_kernel<<<blocks, k_threads>>>(flags, halo_alone);
    return check_launch("sim/avalanche wake");
}

} // namespace

Status wake_slides(const SlideFlags& flags) {
    return wake(flags, false);
}
Status wake_slides_in_halo(const SlideFlags& flags) {
    return wake(flags, true);
}
Status sweep_slides(const SlideFlags& flags, int32_t margin, const SlideSweep& f) {
    sweep_kernel<<<grid_of(flags), dim3(k_threads_x, k_threads_y)>>>(flags, margin, f);
    return check_launch("sim/avalanche sweep");
}
Status flow_slides(const SlideFlags& flags, int32_t margin, const SlideFlows& f) {
    flow_kernel<<<grid_of(flags), dim3(k_threads_x, k_threads_y)>>>(flags, margin, f);
    return check_launch("sim/avalanche flows");
}
Status apply_slides(const SlideFlags& flags, int32_t margin, const SlideApply& f) {
    apply_kernel<<<grid_of(flags), dim3(k_threads_x, k_threads_y)>>>(flags, margin, f);
    return check_launch("sim/avalanche apply");
}
Status copy_slides(int32_t slots, int32_t n, SlabView<const int32_t> from, SlabView<int32_t> to, bool halo_alone) {
    copy_kernel<<<rows_of(slots, from.last - from.first), k_row_threads>>>(n, from, to, halo_alone);
    return check_launch("sim/avalanche copy");
}
Status zero_slides(int32_t slots, SlabView<int32_t> flows) {
    zero_kernel<<<rows_of(slots, flows.last - flows.first), k_row_threads>>>(flows);
    return check_launch("sim/avalanche zero");
}

Status run_slides(const Launch& l, const SlideSweepCell& f) {
    return cuda::launch(l, f);
}
Status run_slides(const Launch& l, const SlideFlowsCell& f) {
    return cuda::launch(l, f);
}
Status run_slides(const Launch& l, const SlideApplyCell& f) {
    return cuda::launch(l, f);
}
Status add_slide_flows(int32_t slots, const BorderFlowsView& view, const SlideDonor& donor) {
    return cuda::add_border_flows("sim/avalanche border", slots, view, 1, donor);
}
Status add_slide_flows(int32_t slots, const BorderFlowsView& view, const SlideFlowDonor& donor) {
    return cuda::add_border_flows("sim/avalanche border", slots, view, 1, donor);
}

} // namespace sahel::cuda
