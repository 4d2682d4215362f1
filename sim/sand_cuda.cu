#include "sim/border_flows_cuda.cuh"
#include "sim/pass_cuda.cuh"
#include "sim/sand_kernels.h"

namespace sahel::cuda {

Status run_ground(const Launch& l, const GroundPass& f) {
    return cuda::launch(l, f);
}
Status run_wind_shadow(const Launch& l, const WindShadowPass& f) {
    return cuda::launch(l, f);
}
Status run_cliff(const Launch& l, const CliffPass& f) {
    return cuda::launch(l, f);
}
Status run_echo(const Launch& l, const EchoPass& f) {
    return cuda::launch(l, f);
}
Status run_no_echo(const Launch& l, const NoEchoPass& f) {
    return cuda::launch(l, f);
}
Status run_lift(const Launch& l, const LiftPass& f) {
    return cuda::launch(l, f);
}
Status run_deposit(const Launch& l, const DepositPass& f) {
    return cuda::launch(l, f);
}
Status run_smooth(const Launch& l, const SmoothPass& f) {
    return cuda::launch(l, f);
}
Status run_apply_smooth(const Launch& l, const ApplySmoothPass& f) {
    return cuda::launch(l, f);
}
Status run_repose(const Launch& l, const ReposePass& f) {
    return cuda::launch(l, f);
}
Status run_covered(const Launch& l, const CoveredPass& f) {
    return cuda::launch(l, f);
}
Status run_supply(const Launch& l, const SupplyPass& f) {
    return cuda::launch(l, f);
}

Status add_flows(int32_t slots, const BorderFlowsView& view, int32_t reach, const HopLegPass& f) {
    return cuda::add_border_flows("sim/hop_flows", slots, view, reach, f);
}
Status add_flows(int32_t slots, const BorderFlowsView& view, int32_t reach, const SmoothPass& f) {
    return cuda::add_border_flows("sim/smooth_flows", slots, view, reach, f);
}

namespace {

struct ZeroPass {
    SlabView<int32_t> to;
    SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y) const { to(s, x, y) = 0; }
};

// One thread a giving cell: the cells of a rectangle and those within reach of it. What lands outside the rectangle is
// another's to take. Sums of integers: the order of threads does not show.
__global__ void __launch_bounds__(256) hop_kernel(HopLegPass f, const WorkItem* items, LocalRect bounds) {
    const WorkItem item = items[blockIdx.z];
    const int32_t reach = f.radius();
    const int32_t x = bounds.x0 - reach + static_cast<int32_t>(blockIdx.x * blockDim.x + threadIdx.x);
    const int32_t y = bounds.y0 - reach + static_cast<int32_t>(blockIdx.y * blockDim.y + threadIdx.y);
    const LocalRect r = item.rect;
    if (x < r.x0 - reach || x >= r.x1 + reach || y < r.y0 - reach || y >= r.y1 + reach) return;
    const int32_t amount = f.from(item.slot, x, y);
    if (amount == 0) return;
    const HopLegPass::Target g = f.target(f.wind_x(item.slot, x, y), f.wind_y(item.slot, x, y));
    const HopLegPass::Shares shares = HopLegPass::shares(amount, g.u, g.v);
    for (int32_t k = 0; k < 4; ++k) {
        const int32_t tx = x + g.x + (k & 1);
        const int32_t ty = y + g.y + (k >> 1);
        if (shares.t[k] != 0 && tx >= r.x0 && tx < r.x1 && ty >= r.y0 && ty < r.y1)
            atomicAdd(&f.to(item.slot, tx, ty), shares.t[k]);
    }
}

} // namespace

Status run_hop_leg(const Launch& l, const HopLegPass& f) {
    if (l.count == 0 || l.bounds.empty()) return {};
    SAHEL_TRY(cuda::launch(l, ZeroPass{f.to}));
    const dim3 block(pass_detail::k_block_x, pass_detail::k_block_y);
    const int32_t width = l.bounds.x1 - l.bounds.x0 + 2 * f.radius();
    const int32_t height = l.bounds.y1 - l.bounds.y0 + 2 * f.radius();
    for (int32_t first = 0; first < l.count; first += pass_detail::k_max_grid_z) {
        const dim3 grid(static_cast<unsigned>((width + pass_detail::k_block_x - 1) / pass_detail::k_block_x),
                        static_cast<unsigned>((height + pass_detail::k_block_y - 1) / pass_detail::k_block_y),
                        static_cast<unsigned>(std::min(l.count - first, pass_detail::k_max_grid_z)));
        hop_kernel<<<grid, block>>>(f, l.device_items + first, l.bounds);
        SAHEL_TRY(check_launch(l.name));
    }
    return {};
}

} // namespace sahel::cuda
