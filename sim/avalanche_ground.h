#pragma once

#include "sim/avalanche_rules.h"
#include "sim/sand_params.h"
#include "sim/tile_domain.h"

#include <cstdint>

/// What the kernels of an avalanche are given: the layers, the angles, and which borders are closed.
namespace sahel {

/// Borders of every slot, as kernels see them; lives in the domain.
struct SlideBorders {
    const uint8_t* closed = nullptr;
    const uint8_t* walls = nullptr;
    bool any_wall = false;
    bool any_open = false; ///< beyond some border ground goes on as it ends

    static Result<SlideBorders> of(TileDomain& domain);
};

constexpr SimLayer moving_layer(AvalancheKind kind) {
    return kind == AvalancheKind::sand   ? SimLayer::sand
           : kind == AvalancheKind::soil ? SimLayer::soil
                                         : SimLayer::bedrock;
}
/// What a neighbour receives.
constexpr SimLayer received_layer(AvalancheKind kind, const SandParams& params) {
    return kind == AvalancheKind::bedrock && params.bedrock_to_sand ? SimLayer::sand : moving_layer(kind);
}

inline constexpr SimLayerSet k_slide_flow_layers{SimLayer::slide_e, SimLayer::slide_se, SimLayer::slide_s,
                                                 SimLayer::slide_sw};

/// Layers that the rules of a kind read, of those the domain has.
SimLayerSet slide_inputs(const TileDomain& domain, AvalancheKind kind);
SlideGround slide_ground(const TileDomain& domain, const SlideBorders& borders, const SandParams& params, double cell_m,
                         AvalancheKind kind);
SlideInertia slide_inertia(const SandParams& params, double cell_m);

} // namespace sahel
