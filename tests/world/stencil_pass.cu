#include "stencil_pass.h"

#include "world/executor_cuda.cuh"

namespace sahel::test {

Status run_stencil_cuda(const LocalRect& rect, const StencilPass& pass) {
    return cuda::for_each_cell("test/stencil", rect, pass);
}

Status run_stencil_tiles_cuda(int32_t slots, const LocalRect& rect, const TilesStencilPass& pass) {
    return cuda::for_each_cell("test/stencil_tiles", slots, rect, pass);
}

} // namespace sahel::test
