#include "sim/avalanche_sweep.h"

namespace sahel {

namespace {
Status none() {
    return Error{ErrorKind::unsupported, "built without CUDA"};
}
} // namespace

Status run_slide_cuda(const Launch&, const SlidePass&) {
    return none();
}
Status run_slide_copy_cuda(const Launch&, const SlideCopy&) {
    return none();
}
Status add_slide_flows_cuda(int32_t, const BorderFlowsView&, const SlideDonor&) {
    return none();
}

} // namespace sahel
