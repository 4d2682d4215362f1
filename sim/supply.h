#pragma once

#include "sim/pass.h"
#include "sim/slab_view.h"
#include "world/layers.h"
#include "world/random.h"

#include <cstdint>

/// Supply control: every so many steps sand falls, or is taken away, until a given share of the ground is covered
/// (Desertscape method 3.3). Coverage is counted exactly. The published pattern is one sine hash, the same at every
/// event; here every event draws anew for each world cell, and the place of its disc from (seed, step).
namespace sahel {

/// Marks covered cells with one tick, so that a sum of ticks counts them.
struct CoveredPass {
    static constexpr PassDecl k_decl{"sim/covered", {{SimLayer::sand, 0}}, {SimLayer::surface}, 8};
    SlabView<const int32_t> sand;
    SlabView<int32_t> covered;
    int32_t threshold; ///< ticks
    SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y) const {
        covered(s, x, y) = static_cast<int32_t>(sand(s, x, y) > threshold);
    }
};

struct SupplyPass {
    static constexpr PassDecl k_decl{"sim/supply", {{SimLayer::sand, 0}}, {SimLayer::sand}, 8};
    SlabView<int32_t> sand;
    CellPlaces places;
    RandomStream random;
    float twice_mean; ///< ticks; below 0: taken away
    bool everywhere;
    int64_t centre_x, centre_y; ///< of the disc, world cells
    int64_t radius;             ///< at most 100000
    int64_t period_x, period_y; ///< 0: not periodic

    SAHEL_HD static int64_t apart(int64_t a, int64_t b, int64_t period) {
        const int64_t d = a < b ? b - a : a - b;
        return period > 0 && period - d < d ? period - d : d;
    }
    SAHEL_HD bool inside(int32_t s, int32_t x, int32_t y) const {
        if (everywhere) return true;
        const int64_t dx = apart(places.x(s, x), centre_x, period_x);
        const int64_t dy = apart(places.y(s, y), centre_y, period_y);
        return dx <= radius && dy <= radius && dx * dx + dy * dy <= radius * radius;
    }
    SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y) const {
        if (!inside(s, x, y)) return;
        const Random4 r = places.random(random, s, x, y);
        const int32_t change = stochastic_round(twice_mean * uniform(r.v[0]), r.v[1]);
        const int32_t after = sand(s, x, y) + change;
        sand(s, x, y) = after > 0 ? after : 0;
    }
};

} // namespace sahel
