#include "sim/wind_ground.h"
#include "sim/wind_pass.h"

namespace sahel {

namespace {
Status none() {
    return Error{ErrorKind::unsupported, "this build has no CUDA backend: run on the CPU"};
}
} // namespace

Status run_wind_pass_cuda(const Launch&, const WindPass&) {
    return none();
}
Status run_ground_sums_cuda(const GroundSums&, int32_t) {
    return none();
}

} // namespace sahel
