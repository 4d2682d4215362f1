#include "sim/avalanche_sweep.h"

namespace sahel::SAHEL_ISA_NAMESPACE {

void run_slide(const Launch& l, const SlidePass& f) {
    launch(l, f);
}
void run_slide_copy(const Launch& l, const SlideCopy& f) {
    launch(l, f);
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
