#include "toy_passes.h"

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

} // namespace sahel::test
