#include "world/cuda_runtime.h"

namespace sahel::cuda {

namespace {
Error not_built() {
    return {ErrorKind::unsupported, "CUDA: this program was built without a CUDA compiler; use the CPU"};
}
} // namespace

const DeviceStatus& status() {
    static const DeviceStatus none = [] {
        DeviceStatus s;
        s.why_not = "built without a CUDA compiler";
        return s;
    }();
    return none;
}

Result<void*> allocate(uint64_t) {
    return not_built();
}
void free(void*) {}
Status copy_to_device(void*, const void*, uint64_t) {
    return not_built();
}
Status copy_to_host(void*, const void*, uint64_t) {
    return not_built();
}
Status synchronize() {
    return not_built();
}

} // namespace sahel::cuda
