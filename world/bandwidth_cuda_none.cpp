#include "world/bandwidth.h"

namespace sahel {

Result<Bandwidth> measure_cuda_bandwidth(uint64_t) {
    return Error{ErrorKind::unsupported, "CUDA: this program was built without a CUDA compiler; use the CPU"};
}

} // namespace sahel
