#include "sim/avalanche.h"

#include "sim/avalanche_sweep.h"
#include "world/cuda_runtime.h"
#include "world/det_math.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace sahel {

namespace {

constexpr int32_t k_radius = 2; ///< a donor's donors' neighbours

float tangent_of(float degrees) {
    const det::SinCos a = det::sincos(degrees * (det::k_pi / 180.0f));
    return a.sin / a.cos;
}

SimLayer moving_layer(AvalancheKind kind) {
    return kind == AvalancheKind::sand   ? SimLayer::sand
           : kind == AvalancheKind::soil ? SimLayer::soil
                                         : SimLayer::bedrock;
}

template <class T> SlabView<const T> optional_view(const TileDomain& d, SimLayer layer) {
    if (!d.layers().contains(layer)) return {};
    if constexpr (std::is_same_v<T, float>)
        return d.reals(layer);
    else
        return d.ints(layer);
}

// All cells of the slab, halos too.
Status copy_plane(TileDomain& d, SimLayer from, SimLayer to) {
    const SlideCopy copy{std::as_const(d).ints(from), d.ints(to)};
    const Launch& launch = d.launch(d.halo(), true, "sim/avalanche copy");
    if (d.on_device()) {
        SAHEL_TRY(run_slide_copy_cuda(launch, copy));
    } else {
        SAHEL_ISA_CALL(run_slide_copy, launch, copy);
    }
    d.set_valid_halo(to, d.valid_halo(from));
    return d.fill_edges({to});
}

// Whether two planes of a layer hold the same owned cells.
Result<bool> same_cells(const TileDomain& d, SimLayer a, SimLayer b) {
    const auto cells = static_cast<size_t>(d.tile_cells()) * static_cast<size_t>(d.tile_cells());
    std::vector<int32_t> of_a(cells);
    std::vector<int32_t> of_b(cells);
    for (int32_t slot = 0; slot < d.slots(); ++slot) {
        SAHEL_TRY(d.store(slot, a, of_a.data()));
        SAHEL_TRY(d.store(slot, b, of_b.data()));
        if (of_a != of_b) return false;
    }
    return true;
}

} // namespace

SimLayerSet avalanche_layers() {
    return {SimLayer::surface_next};
}

Status avalanche(TileDomain& domain, const SandParams& params, double cell_m, AvalancheKind kind,
                 const AvalancheOptions& options, AvalancheStats* stats) {
    (void)options;
    AvalancheStats done;
    const bool sand = kind == AvalancheKind::sand;
    const bool to_sand = kind == AvalancheKind::bedrock && params.bedrock_to_sand;
    const bool until_quiet = sand && params.avalanche_sweeps == 0;
    const int sweeps = kind == AvalancheKind::soil      ? params.soil_sweeps
                       : kind == AvalancheKind::bedrock ? params.bedrock_sweeps
                       : until_quiet                    ? params.avalanche_max_sweeps
                                                        : params.avalanche_sweeps;
    if (domain.halo() < k_radius)
        return Error{ErrorKind::usage, "avalanching looks 2 cells far: choose a halo of at least 8"};

    SlideDonor donor;
    SlideGround& ground = donor.ground;
    ground.kind = kind;
    ground.n = domain.tile_cells();
    ground.ticks_per_tangent = static_cast<float>(cell_m) * k_ticks_per_m;
    const TileDomain& read = domain;
    SimLayerSet inputs{SimLayer::bedrock};
    ground.bedrock = read.ints(SimLayer::bedrock);
    if (kind != AvalancheKind::bedrock) {
        inputs.insert(SimLayer::soil);
        ground.soil = read.ints(SimLayer::soil);
    }
    if (sand || to_sand) ground.sand = read.ints(SimLayer::sand);
    if (sand) {
        inputs.insert({SimLayer::sand, SimLayer::repose});
        ground.repose = read.reals(SimLayer::repose);
    } else if (kind == AvalancheKind::soil) {
        ground.tangent = tangent_of(params.soil_repose_deg);
        ground.tangent_plants = tangent_of(params.soil_repose_plants_deg);
        ground.vegetation = optional_view<float>(read, SimLayer::vegetation);
        if (ground.vegetation.origin) inputs.insert(SimLayer::vegetation);
    } else {
        ground.tangent = tangent_of(params.bedrock_repose_deg);
        ground.object = optional_view<int32_t>(read, SimLayer::object);
        if (ground.object.origin) inputs.insert(SimLayer::object);
    }
    std::vector<uint8_t> closed(static_cast<size_t>(domain.slots()), 0);
    for (int32_t slot = 0; slot < domain.slots(); ++slot)
        for (int k = 0; k < k_direction_count; ++k)
            if (!is_live(domain.plan().border(slot, k)))
                closed[static_cast<size_t>(slot)] |= static_cast<uint8_t>(1 << k);
    ground.closed = closed.data();
    Buffer device_closed;
    if (domain.on_device()) {
        MemoryPool& pool = domain.pool();
        SAHEL_ASSIGN(device_closed, Buffer::allocate(pool, closed.size()));
        SAHEL_TRY(cuda::copy_to_device(device_closed.data(), closed.data(), closed.size()));
        ground.closed = static_cast<const uint8_t*>(device_closed.data());
    }

    SimLayer now = moving_layer(kind);
    SimLayer next = SimLayer::surface_next;
    SAHEL_TRY(copy_plane(domain, now, next)); // frozen cells are not written by sweeps
    inputs.for_each([&](SimLayer l) { SAHEL_CHECK_LE(0, domain.valid_halo(l)); });
    for (int n = 0; n < sweeps; ++n) {
        SimLayerSet stale;
        int32_t valid = domain.halo();
        inputs.for_each(
            [&](SimLayer l) { valid = std::min(valid, domain.valid_halo(l == moving_layer(kind) ? now : l)); });
        if (valid < k_radius) {
            inputs.for_each([&](SimLayer l) {
                const SimLayer plane = l == moving_layer(kind) ? now : l;
                if (domain.valid_halo(plane) < domain.halo()) stale.insert(plane);
            });
            SAHEL_TRY(domain.exchange(stale));
            valid = domain.halo();
        }
        const int32_t margin = valid - k_radius;
        const bool soft = n % params.avalanche_soft_every == 0 || n >= sweeps - params.avalanche_soft_last;
        donor.rule.strength = !sand                  ? params.avalanche_strength
                              : until_quiet || !soft ? 1.0f
                                                     : params.avalanche_strength;
        donor.rule.start_ticks =
            until_quiet ? static_cast<int32_t>(params.avalanche_tolerance * ground.ticks_per_tangent) : 0;
        SlidePass pass{donor, domain.ints(next), {}};
        SlabView<const int32_t> plane = read.ints(now);
        (kind == AvalancheKind::sand   ? pass.donor.ground.sand
         : kind == AvalancheKind::soil ? pass.donor.ground.soil
                                       : pass.donor.ground.bedrock) = plane;
        if (to_sand) pass.taken = domain.ints(SimLayer::sand);
        const Launch& launch = domain.launch(margin, false, "sim/avalanche");
        if (domain.keeps_flows()) {
            const BorderFlowsView view = domain.border_flows(to_sand ? SimLayer::sand : moving_layer(kind));
            if (domain.on_device()) {
                SAHEL_TRY(add_slide_flows_cuda(domain.slots(), view, pass.donor));
            } else {
                add_border_flows("sim/avalanche flows", domain.slots(), view, 1, pass.donor);
            }
        }
        if (domain.on_device()) {
            SAHEL_TRY(run_slide_cuda(launch, pass));
        } else {
            SAHEL_ISA_CALL(run_slide, launch, pass);
        }
        SAHEL_TRY(domain.fill_edges({next}));
        domain.set_valid_halo(next, margin);
        if (to_sand) domain.set_valid_halo(SimLayer::sand, std::min(margin, domain.valid_halo(SimLayer::sand)));
        std::swap(now, next);
        done.sweeps = n + 1;
        done.cells_swept += domain.owned_cells();
        done.cells_all += domain.owned_cells();
        if (until_quiet) {
            SAHEL_ASSIGN(done.quiet, same_cells(domain, now, next));
            if (done.quiet) break;
        }
    }
    if (now != moving_layer(kind)) SAHEL_TRY(copy_plane(domain, now, moving_layer(kind)));
    if (stats) *stats = done;
    return {};
}

} // namespace sahel
