#pragma once

#include "world/cpu_features.h"
#include "world/det_math.h"
#include "world/executor.h"
#include "world/field.h"
#include "world/random.h"
#include "world/result.h"

#include <cstdint>

/// A pass as those of the simulation will be: nine-point stencil, deterministic functions, a random number per world
/// cell, amounts in ticks. It runs on every machine from this one source.
namespace sahel::test {

struct StencilPass {
    FieldView<const int32_t> height; ///< ticks
    FieldView<int32_t> moved;        ///< ticks
    FieldView<float> steepness;
    RandomStream random;
    int64_t origin_x = 0; ///< world cell of local (0, 0)
    int64_t origin_y = 0;

    SAHEL_HD void operator()(int32_t x, int32_t y) const {
        const int32_t here = height(x, y);
        float sum = 0.0f;
        for (int32_t dy = -1; dy <= 1; ++dy) // a fixed order: the sum is part of the result
            for (int32_t dx = -1; dx <= 1; ++dx) sum += metres_of_ticks(height(x + dx, y + dy) - here);
        const float slope = det::abs(sum) * 0.125f;
        const float share = 1.0f - det::exp(-slope) + 0.1f * det::sin(sum) * det::pow(slope, 1.5f);
        const Random4 r = random.at(origin_x + x, origin_y + y);
        moved(x, y) = stochastic_round(share * 3.7f, r.v[0]);
        steepness(x, y) = det::atan2(sum, 1.0f + det::sqrt(slope)) + det::log(1.0f + slope) + uniform(r.v[1]);
    }
};

/// The pass in `slots` tiles that lie one below the other in the same columns of memory, `tile_rows` rows apart.
struct TilesStencilPass {
    StencilPass pass;
    int32_t tile_rows = 0;
    SAHEL_HD void operator()(int32_t slot, int32_t x, int32_t y) const { pass(x, y + slot * tile_rows); }
};

SAHEL_ISA_DECLARE(void run_stencil(const LocalRect& rect, const StencilPass& pass))
SAHEL_ISA_DECLARE(void run_stencil_tiles(int32_t slots, const LocalRect& rect, const TilesStencilPass& pass))

/// On the CUDA device; views point to its memory. Built where there is a CUDA compiler.
Status run_stencil_cuda(const LocalRect& rect, const StencilPass& pass);
Status run_stencil_tiles_cuda(int32_t slots, const LocalRect& rect, const TilesStencilPass& pass);

} // namespace sahel::test
