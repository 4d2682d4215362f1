#include "sim/avalanche_cuda.h"

namespace sahel::cuda {

namespace {
Status none() {
    return Error{ErrorKind::unsupported, "built without CUDA"};
}
} // namespace

Status wake_slides(const SlideFlags&) {
    return none();
}
Status wake_slides_in_halo(const SlideFlags&) {
    return none();
}
Status sweep_slides(const SlideFlags&, int32_t, const SlideSweep&) {
    return none();
}
Status flow_slides(const SlideFlags&, int32_t, const SlideFlows&) {
    return none();
}
Status apply_slides(const SlideFlags&, int32_t, const SlideApply&) {
    return none();
}
Status copy_slides(int32_t, int32_t, SlabView<const int32_t>, SlabView<int32_t>, bool) {
    return none();
}
Status zero_slides(int32_t, SlabView<int32_t>) {
    return none();
}
Status run_slides(const Launch&, const SlideSweepCell&) {
    return none();
}
Status run_slides(const Launch&, const SlideFlowsCell&) {
    return none();
}
Status run_slides(const Launch&, const SlideApplyCell&) {
    return none();
}
Status add_slide_flows(int32_t, const BorderFlowsView&, const SlideDonor&) {
    return none();
}
Status add_slide_flows(int32_t, const BorderFlowsView&, const SlideFlowDonor&) {
    return none();
}

} // namespace sahel::cuda
