#pragma once

#include "sim/pass.h"
#include "sim/slab_view.h"
#include "world/det_math.h"
#include "world/layers.h"

#include <cstdint>

/// Wind shadow: how well higher ground upwind shelters a cell (Desertscapes in CUDA, GRAPP 2024, Section 4.2, equation
/// 4; Oasis A4). The ray goes one cell at a time against the wind; of all samples the steepest rise counts:
///
///        h
///        |      ____             M = max over k of (h(p - k d) - h(p)) / (k l)
///        |  ___/    \___         shelter 0 for M <= tan(shadow_min), 1 for M >= tan(shadow_max), linear between
///        |_/            \__p     d = w / |w|, l = side of a cell
///           k l <- <- <- <-      wind ->
///
/// Positions are offsets from the own cell, so that the bits do not depend on where a tile begins. Weights are full
/// floats, samples differences of ticks. (The paper's program samples through texture units: weights of 8 bits, and no
/// shadow across the seam of its world.)
namespace sahel {

/// Unit vector of the wind; zero without wind. (Published: w / (|w| + 1e-6), a little short. Then a cliff of 10 m
/// counts as one of 9.999998 m, and its eddy ends before the cell 4 m off.)
struct WindDirection {
    float x;
    float y;
    SAHEL_HD static WindDirection of(float wx, float wy) {
        const float speed = det::max(det::sqrt(wx * wx + wy * wy), 1e-6f);
        return {wx / speed, wy / speed};
    }
};

/// Where an offset falls between cells: (x, y) is the cell below in both axes, (u, v) in [0, 1) how far beyond.
struct CellOffset {
    int32_t x;
    int32_t y;
    float u;
    float v;
    SAHEL_HD static int32_t floor(float d) { // |d| below 2^31
        const auto whole = static_cast<int32_t>(d);
        return whole - static_cast<int32_t>(d < static_cast<float>(whole));
    }
    SAHEL_HD static CellOffset bilinear(float dx, float dy) {
        const int32_t x = floor(dx);
        const int32_t y = floor(dy);
        return {x, y, dx - static_cast<float>(x), dy - static_cast<float>(y)};
    }
    /// The nearest cell, halves away from zero.
    SAHEL_HD static int32_t round(float d) { return static_cast<int32_t>(d + (d < 0.0f ? -0.5f : 0.5f)); }
    SAHEL_HD static CellOffset nearest(float dx, float dy) { return {round(dx), round(dy), 0.0f, 0.0f}; }
};

/// Between four values at (0, 0), (1, 0), (0, 1), (1, 1).
SAHEL_HD float mix_bilinear(float a, float b, float c, float d, float u, float v) {
    const float upper = a + u * (b - a);
    const float lower = c + u * (d - c);
    return upper + v * (lower - upper);
}

/// Ticks that the surface at `o` stands above `here`.
SAHEL_HD float rise_ticks(const int32_t* at, int64_t stride, int32_t here, float u, float v) {
    return mix_bilinear(static_cast<float>(at[0] - here), static_cast<float>(at[1] - here),
                        static_cast<float>(at[stride] - here), static_cast<float>(at[stride + 1] - here), u, v);
}

/// Wind at an offset from a cell: for rays along the curved wind.
struct WindSampler {
    SlabView<const float> wind_x, wind_y;
    bool bilinear_samples;
    SAHEL_HD WindDirection at(int32_t s, int32_t x, int32_t y, float dx, float dy) const {
        if (!bilinear_samples) {
            const CellOffset o = CellOffset::nearest(dx, dy);
            return WindDirection::of(wind_x(s, x + o.x, y + o.y), wind_y(s, x + o.x, y + o.y));
        }
        const CellOffset o = CellOffset::bilinear(dx, dy);
        const auto of = [&](const SlabView<const float>& w) {
            const float* p = &w(s, x + o.x, y + o.y);
            return mix_bilinear(p[0], p[1], p[w.stride], p[w.stride + 1], o.u, o.v);
        };
        return WindDirection::of(of(wind_x), of(wind_y));
    }
};

struct WindShadowPass {
    SlabView<const int32_t> surface;
    SlabView<const float> wind_x, wind_y;
    SlabView<float> shadow;
    int32_t samples; ///< floor(shadow_length / l)
    float cell_m;
    float least; ///< tan(shadow_min)
    float range; ///< tan(shadow_max) - tan(shadow_min)
    bool curved;
    bool bilinear_samples; ///< else the nearest cell

    SAHEL_HD static int32_t radius(int32_t samples) { return samples + 2; }
    static PassDecl decl(int32_t samples, bool curved) {
        const int32_t r = radius(samples);
        const int32_t w = curved ? r : 0;
        return {"sim/wind_shadow",
                {{SimLayer::surface, r}, {SimLayer::wind_x, w}, {SimLayer::wind_y, w}},
                {SimLayer::wind_shadow},
                16};
    }

    /// Slope for each tick of rise over k cells.
    SAHEL_HD float per_tick(int32_t k) const { return k_m_per_tick / (static_cast<float>(k) * cell_m); }
    SAHEL_HD float shelter(float slope) const { return det::clamp((slope - least) / range, 0.0f, 1.0f); }

    /// The sample at an offset, in ticks above the own cell.
    SAHEL_HD float rise(int32_t s, int32_t x, int32_t y, int32_t here, float dx, float dy) const {
        if (!bilinear_samples) {
            const CellOffset o = CellOffset::nearest(dx, dy);
            return static_cast<float>(surface(s, x + o.x, y + o.y) - here);
        }
        const CellOffset o = CellOffset::bilinear(dx, dy);
        return rise_ticks(&surface(s, x + o.x, y + o.y), surface.stride, here, o.u, o.v);
    }
    SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y) const {
        const int32_t here = surface(s, x, y);
        float steepest = 0.0f;
        float dx = 0.0f;
        float dy = 0.0f;
        WindDirection d = WindDirection::of(wind_x(s, x, y), wind_y(s, x, y));
        for (int32_t k = 1; k <= samples; ++k) {
            if (curved && k > 1) d = WindSampler{wind_x, wind_y, bilinear_samples}.at(s, x, y, dx, dy);
            dx -= d.x;
            dy -= d.y;
            steepest = det::max(rise(s, x, y, here, dx, dy) * per_tick(k), steepest);
        }
        shadow(s, x, y) = shelter(steepest);
    }
};

} // namespace sahel
