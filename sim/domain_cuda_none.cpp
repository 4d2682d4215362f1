#include "sim/domain_cuda.h"

namespace sahel::cuda {

namespace {
Status none() {
    return Error{ErrorKind::unsupported, "this build has no CUDA backend: run on the CPU"};
}
} // namespace

Status exchange(const HaloCopy*, int32_t, int32_t, SlabView<uint32_t>, Mirror) {
    return none();
}
Status pack(const HaloCopy*, const HaloMessage&, SlabView<const uint32_t>, Mirror, uint32_t*) {
    return none();
}
Status unpack(const HaloCopy*, const HaloMessage&, SlabView<uint32_t>, const uint32_t*) {
    return none();
}
Status fill_words(uint32_t*, int64_t, uint32_t) {
    return none();
}
Status fill_edges(const EdgeFill*, int32_t, int32_t, const EdgeLayers&) {
    return none();
}
Status sums(SlabView<const int32_t>, int32_t, int32_t, int64_t*) {
    return none();
}

} // namespace sahel::cuda
