#include "sim/border_flows.h"
#include "sim/sand_kernels.h"

namespace sahel::cuda {

namespace {
Status none() {
    return Error{ErrorKind::unsupported, "built without CUDA"};
}
} // namespace

Status run_ground(const Launch&, const GroundPass&) {
    return none();
}
Status run_wind_shadow(const Launch&, const WindShadowPass&) {
    return none();
}
Status run_cliff(const Launch&, const CliffPass&) {
    return none();
}
Status run_echo(const Launch&, const EchoPass&) {
    return none();
}
Status run_no_echo(const Launch&, const NoEchoPass&) {
    return none();
}
Status run_lift(const Launch&, const LiftPass&) {
    return none();
}
Status run_hop_leg(const Launch&, const HopLegPass&) {
    return none();
}
Status run_deposit(const Launch&, const DepositPass&) {
    return none();
}
Status run_smooth(const Launch&, const SmoothPass&) {
    return none();
}
Status run_apply_smooth(const Launch&, const ApplySmoothPass&) {
    return none();
}
Status run_repose(const Launch&, const ReposePass&) {
    return none();
}
Status run_covered(const Launch&, const CoveredPass&) {
    return none();
}
Status run_supply(const Launch&, const SupplyPass&) {
    return none();
}
Status add_flows(int32_t, const BorderFlowsView&, int32_t, const HopLegPass&) {
    return none();
}
Status add_flows(int32_t, const BorderFlowsView&, int32_t, const SmoothPass&) {
    return none();
}

} // namespace sahel::cuda
