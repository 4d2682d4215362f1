#include "stencil_pass.h"

namespace sahel::test::SAHEL_ISA_NAMESPACE {

void run_stencil(const LocalRect& rect, const StencilPass& pass) {
    for_each_cell("test/stencil", rect, pass);
}

void run_stencil_tiles(int32_t slots, const LocalRect& rect, const TilesStencilPass& pass) {
    for_each_cell("test/stencil_tiles", slots, rect, pass);
}

} // namespace sahel::test::SAHEL_ISA_NAMESPACE
