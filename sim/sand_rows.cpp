#include "sim/sand_kernels.h"

namespace sahel::SAHEL_ISA_NAMESPACE {

void run_ground(const Launch& l, const GroundPass& f) {
    launch(l, f);
}

void run_wind_shadow(const Launch& l, const WindShadowPass& f) {
    launch(l, f);
}

void run_cliff(const Launch& l, const CliffPass& f) {
    launch(l, f);
}

void run_echo(const Launch& l, const EchoPass& f) {
    launch(l, f);
}

void run_no_echo(const Launch& l, const NoEchoPass& f) {
    launch(l, f);
}

void run_lift(const Launch& l, const LiftPass& f) {
    launch(l, f);
}

void run_deposit(const Launch& l, const DepositPass& f) {
    launch(l, f);
}

void run_smooth(const Launch& l, const SmoothPass& f) {
    launch(l, f);
}

void run_apply_smooth(const Launch& l, const ApplySmoothPass& f) {
    launch(l, f);
}

void run_repose(const Launch& l, const ReposePass& f) {
    launch(l, f);
}

void run_covered(const Launch& l, const CoveredPass& f) {
    launch(l, f);
}

void run_supply(const Launch& l, const SupplyPass& f) {
    launch(l, f);
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
