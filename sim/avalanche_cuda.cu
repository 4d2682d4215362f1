#include "sim/avalanche_sweep.h"
#include "sim/border_flows_cuda.cuh"
#include "sim/pass_cuda.cuh"

namespace sahel {

Status run_slide_cuda(const Launch& l, const SlidePass& f) {
    return cuda::launch(l, f);
}
Status run_slide_copy_cuda(const Launch& l, const SlideCopy& f) {
    return cuda::launch(l, f);
}
Status add_slide_flows_cuda(int32_t slots, const BorderFlowsView& view, const SlideDonor& donor) {
    return cuda::add_border_flows("sim/avalanche flows", slots, view, 1, donor);
}

} // namespace sahel
