#pragma once

#include "sim/border_flows.h"
#include "sim/pass.h"
#include "sim/slab_view.h"
#include "sim/tile_domain.h"
#include "world/cpu_features.h"
#include "world/det_math.h"
#include "world/field.h"
#include "world/random.h"

/// Three small passes with everything real ones have: a float stencil, a transfer of ticks in gather form, and grains
/// that hop by random numbers. Each runs on every machine from this one source.
namespace sahel::test {

/// A float field from ticks: five-point smoothing of the sand's height. Radius 1.
struct SmoothPass {
    static constexpr PassDecl k_decl{"test/smooth", {{SimLayer::sand, 1}}, {SimLayer::wind_shadow}, 8};
    SlabView<const int32_t> sand;
    SlabView<float> out;
    SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y) const {
        const int32_t here = sand(s, x, y);
        const float sum = (metres_of_ticks(sand(s, x - 1, y) - here) + metres_of_ticks(sand(s, x + 1, y) - here)) +
                          (metres_of_ticks(sand(s, x, y - 1) - here) + metres_of_ticks(sand(s, x, y + 1) - here));
        out(s, x, y) = det::exp(-det::abs(0.25f * sum));
    }
};

/// Sand flows to lower sides by a share that depends on the smoothed field; each cell works out again what its
/// neighbours give. Radius 2 in sand, 1 in the field. `reach` wider than 1 breaks the declaration, for the test of it.
struct SlumpPass {
    static constexpr PassDecl k_decl{
        "test/slump", {{SimLayer::sand, 2}, {SimLayer::wind_shadow, 1}}, {SimLayer::surface}, 12};
    SlabView<const int32_t> sand;
    SlabView<const float> share;
    SlabView<int32_t> out;
    int32_t reach = 1;

    SAHEL_HD int32_t given(int32_t s, int32_t xs, int32_t ys, int32_t xd, int32_t yd) const {
        const int32_t drop = sand(s, xs, ys) - sand(s, xd, yd);
        const int32_t amount =
            static_cast<int32_t>(0.125f * share(s, xs, ys) * static_cast<float>(drop > 0 ? drop : 0));
        const int32_t quarter = sand(s, xs, ys) / 4;
        return amount < quarter ? amount : quarter;
    }
    SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y) const {
        const int32_t r = reach;
        int32_t v = sand(s, x, y);
        v += given(s, x - r, y, x, y) - given(s, x, y, x - r, y);
        v += given(s, x + r, y, x, y) - given(s, x, y, x + r, y);
        v += given(s, x, y - r, x, y) - given(s, x, y, x, y - r);
        v += given(s, x, y + r, x, y) - given(s, x, y, x, y + r);
        out(s, x, y) = v;
    }
};

/// Part of every column hops up to three cells in a direction of its own, drawn from the world cell. Radius 3.
struct HopPass {
    static constexpr PassDecl k_decl{"test/hop", {{SimLayer::surface, 3}}, {SimLayer::sand}, 8};
    SlabView<const int32_t> in;
    SlabView<int32_t> out;
    CellPlaces places;
    RandomStream random;

    SAHEL_HD int32_t given(int32_t s, int32_t xs, int32_t ys, int32_t xd, int32_t yd) const {
        const Random4 r = places.random(random, s, xs, ys);
        const int32_t dx = static_cast<int32_t>(r.v[0] % 7u) - 3;
        const int32_t dy = static_cast<int32_t>(r.v[1] % 7u) - 3;
        const int32_t amount = stochastic_round(static_cast<float>(in(s, xs, ys)) * 1e-4f, r.v[2]);
        return (xs + dx == xd && ys + dy == yd) ? amount : 0;
    }
    SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y) const {
        const Random4 r = places.random(random, s, x, y);
        int32_t v = in(s, x, y) - stochastic_round(static_cast<float>(in(s, x, y)) * 1e-4f, r.v[2]);
        for (int32_t dy = -3; dy <= 3; ++dy)
            for (int32_t dx = -3; dx <= 3; ++dx) v += given(s, x + dx, y + dy, x, y);
        out(s, x, y) = v;
    }
};

/// Airborne sand drifts up to three cells with the wind, half of it one cell further in y: as real saltation, in
/// a world with borders of every kind (beyond open and frozen ones there is none). Radius 4.
struct DriftPass {
    static constexpr int32_t k_reach = 4;
    static constexpr PassDecl k_decl{
        "test/drift",
        {{SimLayer::airborne_sand, k_reach}, {SimLayer::wind_x, k_reach}, {SimLayer::wind_y, k_reach}},
        {SimLayer::hopping},
        16};
    SlabView<const int32_t> in;
    SlabView<const float> wind_x, wind_y;
    SlabView<int32_t> out;

    SAHEL_HD static int32_t cells(float wind) {
        return wind < 0.0f ? -static_cast<int32_t>(-wind) : static_cast<int32_t>(wind);
    }
    SAHEL_HD int32_t given(int32_t s, int32_t xs, int32_t ys, int32_t xd, int32_t yd) const {
        const int32_t amount = in(s, xs, ys);
        const float vy = wind_y(s, xs, ys);
        const int32_t tx = xs + cells(wind_x(s, xs, ys));
        const int32_t ty = ys + cells(vy);
        const int32_t further = ty + (vy > 0.0f) - (vy < 0.0f); // calm picks no side: beyond a wall it is the other
        const int32_t half = amount / 2;
        return (tx == xd && ty == yd ? amount - half : 0) + (tx == xd && further == yd ? half : 0);
    }
    SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y) const {
        int32_t v = 0;
        for (int32_t dy = -k_reach; dy <= k_reach; ++dy)
            for (int32_t dx = -k_reach; dx <= k_reach; ++dx) v += given(s, x + dx, y + dy, x, y);
        out(s, x, y) = v;
    }
};

/// What a cell gives in DriftPass.
struct DriftDonor {
    DriftPass pass;
    template <class Sink> SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y, Sink& sink) const {
        for (int32_t dy = -DriftPass::k_reach; dy <= DriftPass::k_reach; ++dy)
            for (int32_t dx = -DriftPass::k_reach; dx <= DriftPass::k_reach; ++dx)
                if (dx != 0 || dy != 0) sink(x + dx, y + dy, pass.given(s, x, y, x + dx, y + dy));
    }
};

/// The end of DriftPass.
struct LandPass {
    static constexpr PassDecl k_decl{"test/land", {{SimLayer::hopping, 0}}, {SimLayer::airborne_sand}, 8};
    SlabView<const int32_t> in;
    SlabView<int32_t> out;
    SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y) const { out(s, x, y) = in(s, x, y); }
};

SAHEL_ISA_DECLARE(void run_smooth(const Launch& l, const SmoothPass& f))
SAHEL_ISA_DECLARE(void run_slump(const Launch& l, const SlumpPass& f))
SAHEL_ISA_DECLARE(void run_hop(const Launch& l, const HopPass& f))
SAHEL_ISA_DECLARE(void run_drift(const Launch& l, const DriftPass& f))
SAHEL_ISA_DECLARE(void run_land(const Launch& l, const LandPass& f))
Status run_smooth_cuda(const Launch& l, const SmoothPass& f);
Status run_slump_cuda(const Launch& l, const SlumpPass& f);
Status run_hop_cuda(const Launch& l, const HopPass& f);

Status run_drift_cuda(const Launch& l, const DriftPass& f);
Status run_drift_flows_cuda(int32_t slots, const BorderFlowsView& view, const DriftDonor& f);
Status run_land_cuda(const Launch& l, const LandPass& f);

inline const SimLayerSet k_toy_layers{SimLayer::sand, SimLayer::surface, SimLayer::wind_shadow};

Pass smooth_pass();
Pass slump_pass(int32_t reach = 1);
inline const SimLayerSet k_drift_layers{SimLayer::airborne_sand, SimLayer::wind_x, SimLayer::wind_y, SimLayer::hopping};
/// The two passes of a drift; they account what crosses borders if the domain keeps flows.
std::vector<Pass> drift_passes();
Pass hop_pass(uint64_t seed, int64_t step);

} // namespace sahel::test
