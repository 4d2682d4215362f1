#include "toy_passes.h"

#include "sim/border_flows_cuda.cuh"
#include "sim/pass_cuda.cuh"

namespace sahel::test {

Status run_smooth_cuda(const Launch& l, const SmoothPass& f) {
    return cuda::launch(l, f);
}
Status run_slump_cuda(const Launch& l, const SlumpPass& f) {
    return cuda::launch(l, f);
}
Status run_hop_cuda(const Launch& l, const HopPass& f) {
    return cuda::launch(l, f);
}
Status run_drift_cuda(const Launch& l, const DriftPass& f) {
    return cuda::launch(l, f);
}
Status run_drift_flows_cuda(int32_t slots, const BorderFlowsView& view, const DriftDonor& f) {
    return cuda::add_border_flows("test/drift_flows", slots, view, DriftPass::k_reach, f);
}
Status run_land_cuda(const Launch& l, const LandPass& f) {
    return cuda::launch(l, f);
}

} // namespace sahel::test
