#pragma once

#include "sim/pass.h"
#include "sim/slab_view.h"

#include <cstdint>

/// The surface that the wind meets: bedrock, soil, sand and water on top of each other, as one plane of ticks. Passes
/// that look far upwind read this plane alone. Differences of ticks are exact, so nothing is lost at 4000 m.
namespace sahel {

struct GroundPass {
    static constexpr PassDecl k_decl{
        "sim/ground",
        {{SimLayer::bedrock, 0}, {SimLayer::soil, 0}, {SimLayer::sand, 0}, {SimLayer::water, 0}},
        {SimLayer::surface},
        20};
    SlabView<const int32_t> bedrock, soil, sand, water;
    SlabView<int32_t> surface;
    SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y) const {
        surface(s, x, y) = (bedrock(s, x, y) + soil(s, x, y)) + (sand(s, x, y) + water(s, x, y));
    }
};

} // namespace sahel
