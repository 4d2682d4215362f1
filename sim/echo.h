#pragma once

#include "sim/pass.h"
#include "sim/slab_view.h"
#include "sim/wind_shadow.h"
#include "world/det_math.h"
#include "world/layers.h"

#include <cstdint>

/// Echo dunes: where wind meets a cliff, an eddy at its foot carries sand away, and before it lies a calm strip where
/// sand stays (Desertscapes in CUDA, GRAPP 2024, Section 4.3). Two passes:
///
///                      calm            eddy  |#####     cliff: the rise over one cell downwind, if steeper than
///     wind ->   ...............  - - - - - - |#####     echo_cliff; H = that rise, at most echo_max_cliff
///               0.1 ......... 1   -rate      |#####
///               |<----- echo_sticky_range H ---->|      Each cell looks downwind by itself (no marks are left in
///                                |<- echo_    -->|      others, so nothing races); erosion goes before calm, and of
///                                   erosion_range H     several cliffs the calmest counts.
///
/// Cliffs are sampled bilinearly, so that walls at a grazing wind have no gaps; classes look at the nearest cells.
namespace sahel {

struct CliffPass {
    static constexpr PassDecl k_decl{
        "sim/cliff", {{SimLayer::surface, 2}, {SimLayer::wind_x, 0}, {SimLayer::wind_y, 0}}, {SimLayer::cliff}, 16};
    SlabView<const int32_t> surface;
    SlabView<const float> wind_x, wind_y;
    SlabView<float> cliff;
    float least_m; ///< a rise over one cell that makes a cliff
    bool bilinear_samples;

    SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y) const {
        const WindDirection d = WindDirection::of(wind_x(s, x, y), wind_y(s, x, y));
        const CellOffset o = bilinear_samples ? CellOffset::bilinear(-d.x, -d.y) : CellOffset::nearest(-d.x, -d.y);
        const int32_t here = surface(s, x, y);
        const int32_t* at = &surface(s, x + o.x, y + o.y);
        const float rise_m = bilinear_samples ? -rise_ticks(at, surface.stride, here, o.u, o.v) * k_m_per_tick
                                              : static_cast<float>(here - *at) * k_m_per_tick;
        cliff(s, x, y) = rise_m >= least_m ? rise_m : 0.0f;
    }
};

struct EchoPass {
    SlabView<const float> cliff;
    SlabView<const float> wind_x, wind_y;
    SlabView<float> echo;
    int32_t steps; ///< floor(echo_sticky_range * echo_max_cliff / l)
    float cell_m;
    float rate; ///< m/s
    float erosion_range, sticky_range;
    float max_cliff_m;
    bool curved;
    bool bilinear_samples;

    SAHEL_HD static int32_t radius(int32_t steps) { return steps + 1; }
    static PassDecl decl(int32_t steps, bool curved) {
        const int32_t r = radius(steps);
        const int32_t w = curved ? r : 0;
        return {"sim/echo", {{SimLayer::cliff, r}, {SimLayer::wind_x, w}, {SimLayer::wind_y, w}}, {SimLayer::echo}, 16};
    }

    SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y) const {
        float found = 0.0f;
        float dx = 0.0f;
        float dy = 0.0f;
        WindDirection d = WindDirection::of(wind_x(s, x, y), wind_y(s, x, y));
        for (int32_t k = 1; k <= steps; ++k) {
            if (curved && k > 1) d = WindSampler{wind_x, wind_y, bilinear_samples}.at(s, x, y, dx, dy);
            dx += d.x;
            dy += d.y;
            const int32_t cx = CellOffset::round(dx);
            const int32_t cy = CellOffset::round(dy);
            const float c = cliff(s, x + cx, y + cy);
            if (!(c > 0.0f)) continue;
            const float height = det::min(c, max_cliff_m);
            const float eroded = erosion_range * height;
            const float sticky = sticky_range * height;
            const float distance = cell_m * det::sqrt(static_cast<float>(cx * cx + cy * cy));
            if (distance <= eroded) {
                found = -rate;
                break;
            }
            if (distance <= sticky)
                found = det::max(found, det::min(1.0f, 1.1f - (distance - eroded) / (sticky - eroded)));
        }
        echo(s, x, y) = found;
    }
};

/// Without echo dunes no class is left over from before.
struct NoEchoPass {
    static constexpr PassDecl k_decl{"sim/no_echo", {}, {SimLayer::echo}, 4};
    SlabView<float> echo;
    SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y) const { echo(s, x, y) = 0.0f; }
};

} // namespace sahel
