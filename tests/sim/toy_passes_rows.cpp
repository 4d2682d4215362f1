#include "toy_passes.h"

namespace sahel::test::SAHEL_ISA_NAMESPACE {

void run_smooth(const Launch& l, const SmoothPass& f) {
    launch(l, f);
}
void run_slump(const Launch& l, const SlumpPass& f) {
    launch(l, f);
}
void run_hop(const Launch& l, const HopPass& f) {
    launch(l, f);
}
void run_drift(const Launch& l, const DriftPass& f) {
    launch(l, f);
}
void run_land(const Launch& l, const LandPass& f) {
    launch(l, f);
}

} // namespace sahel::test::SAHEL_ISA_NAMESPACE
