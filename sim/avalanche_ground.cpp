#include "sim/avalanche_ground.h"

#include "world/cuda_runtime.h"
#include "world/det_math.h"

#include <cstring>
#include <vector>

namespace sahel {

namespace {

float tangent_of(float degrees) {
    const det::SinCos a = det::sincos(degrees * (det::k_pi / 180.0f));
    return a.sin / a.cos;
}

} // namespace

Result<SlideBorders> SlideBorders::of(TileDomain& domain) {
    SlideBorders out;
    const auto slots = static_cast<size_t>(domain.slots());
    std::vector<uint8_t> bits(2 * slots, 0); // closed of every slot, then walls
    for (int32_t slot = 0; slot < domain.slots(); ++slot)
        for (int k = 0; k < k_direction_count; ++k) {
            const Border b = domain.plan().border(slot, k);
            const auto bit = static_cast<uint8_t>(1 << k);
            if (!is_live(b)) bits[static_cast<size_t>(slot)] |= bit;
            if (b == Border::wall) bits[slots + static_cast<size_t>(slot)] |= bit;
            out.any_wall = out.any_wall || b == Border::wall;
            out.any_open = out.any_open || b == Border::open || b == Border::level;
        }
    bool fresh = false;
    SAHEL_ASSIGN(void* const kept, domain.scratch("avalanche borders", bits.size(), &fresh));
    if (fresh) {
        if (domain.on_device()) {
            SAHEL_TRY(cuda::copy_to_device(kept, bits.data(), bits.size()));
        } else {
            std::memcpy(kept, bits.data(), bits.size());
        }
    }
    out.closed = static_cast<const uint8_t*>(kept);
    out.walls = out.closed + slots;
    return out;
}

SimLayerSet slide_inputs(const TileDomain& domain, AvalancheKind kind) {
    SimLayerSet inputs{SimLayer::bedrock};
    const auto if_there = [&](SimLayer l) {
        if (domain.layers().contains(l)) inputs.insert(l);
    };
    switch (kind) {
    case AvalancheKind::sand:
        inputs.insert({SimLayer::soil, SimLayer::sand, SimLayer::repose});
        break;
    case AvalancheKind::soil:
        inputs.insert({SimLayer::soil, SimLayer::sand});
        if_there(SimLayer::vegetation);
        if_there(SimLayer::moisture);
        break;
    case AvalancheKind::bedrock:
        if_there(SimLayer::object);
        break;
    }
    return inputs;
}

SlideGround slide_ground(const TileDomain& d, const SlideBorders& borders, const SandParams& params, double cell_m,
                         AvalancheKind kind) {
    const SimLayerSet inputs = slide_inputs(d, kind);
    const auto ints = [&](SimLayer l) { return inputs.contains(l) ? d.ints(l) : SlabView<const int32_t>{}; };
    const auto reals = [&](SimLayer l) { return inputs.contains(l) ? d.reals(l) : SlabView<const float>{}; };
    SlideGround g;
    g.kind = kind;
    g.n = d.tile_cells();
    g.closed = borders.closed;
    g.walls = borders.walls;
    g.ticks_per_tangent = static_cast<float>(cell_m) * k_ticks_per_m;
    g.bedrock = ints(SimLayer::bedrock);
    g.soil = ints(SimLayer::soil);
    g.sand = ints(SimLayer::sand);
    g.repose = reals(SimLayer::repose);
    g.vegetation = reals(SimLayer::vegetation);
    g.moisture = ints(SimLayer::moisture);
    g.object = ints(SimLayer::object);
    g.tangent = tangent_of(kind == AvalancheKind::bedrock ? params.bedrock_repose_deg : params.soil_repose_deg);
    g.tangent_plants = tangent_of(params.soil_repose_plants_deg);
    g.moisture_capacity_ticks = params.moisture_capacity_m * k_ticks_per_m;
    g.moisture_depth_ticks = params.moisture_depth_m * k_ticks_per_m;
    return g;
}

SlideInertia slide_inertia(const SandParams& params, double cell_m) {
    const float ticks = static_cast<float>(cell_m) * k_ticks_per_m;
    const auto start = static_cast<int32_t>(params.avalanche_tolerance * ticks);
    return {start, start / 4, k_slide_drag_per_cell / ticks};
}

} // namespace sahel
