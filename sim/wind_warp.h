#pragma once

#include "sim/wind_plane.h"
#include "world/cpu_features.h"
#include "world/det_math.h"
#include "world/macros.h"

#include <cstdint>

/// Venturi scaling and warping of the coarse wind, one coarse cell at a time (Desertscape, GRAPP 2024, Section 4.1;
/// after Paris et al.: Desertscape Simulation, CGF 2019).
///
///     v   = U max(1 + k_W h, 1/2)                    h: height above the datum, as published; or
///     v   = U clamp(1 + k_W (h - mean), 1/2, 4)      above the Gaussian mean around, so that plateaus are not stormy
///     g_i = k_g grad h_i                             h_i: height smoothed by sigma_i
///     p_i = (-g_y, g_x)                              along the contour line
///     u   = v + sum_i a_i min(|g_i|, 1) (s k_i p_i - |s| v) / sum_i a_i
///     w   = |v| u / |u|
///
/// As published s is the sign of v.p. But where the wind blows straight up or down a slope that sign is noise, and
/// neighbours would turn to opposite sides: here s = s(cos(v, p)) grows smoothly from 0, where the wind keeps its way,
/// to 1 at about seven degrees off the straight way, and from there on is the published sign. h is mixed with its
/// neighbours by [1 2 1]/4 both ways before it scales the wind: a coarse wind has no waves of two cells, which neither
/// interpolation nor central differences can follow.
namespace sahel {

struct WarpScale {
    WindPlane height;              ///< smoothed, m
    float weight = 0.0f;           ///< a_i / sum of a
    float strength_m_per_s = 0.0f; ///< k_i
};

struct WarpKernel {
    static constexpr int k_scales = 4;
    static constexpr float k_least = 0.5f;
    static constexpr float k_most = 4.0f;
    static constexpr float k_steep = 8.0f; ///< 1 / cosine from which the side is certain

    WindPlane height; ///< above `base_m`, m
    WindPlane mean;   ///< the same, smoothed; without: `absolute`
    bool absolute = false;
    float base_m = 0.0f;
    float venturi_per_m = 0.0f;
    float wind_x = 0.0f, wind_y = 0.0f; ///< undisturbed, m/s
    float slope_factor = 0.0f;          ///< k_g / (2 spacing), 1/m
    int scales = 0;
    WarpScale scale[k_scales];
    WindPlane out_x, out_y;

    SAHEL_HD static float smooth_sign(float cosine) {
        const float t = det::clamp(cosine * k_steep, -1.0f, 1.0f);
        return t * (1.5f - 0.5f * (t * t));
    }
    /// Terms that a turn by 90 degrees exchanges are added first.
    SAHEL_HD static float mixed(const float* up, const float* here, const float* down, int32_t x) {
        const float sides = (here[x - 1] + here[x + 1]) + (up[x] + down[x]);
        const float corners = (up[x - 1] + down[x + 1]) + (up[x + 1] + down[x - 1]);
        return 0.25f * here[x] + 0.125f * sides + 0.0625f * corners;
    }
    SAHEL_HD float factor(float h, float mean_h) const {
        const float above = absolute ? base_m + h : h - mean_h;
        const float f = 1.0f + venturi_per_m * above;
        return absolute ? det::max(f, k_least) : det::clamp(f, k_least, k_most);
    }
};
SAHEL_ISA_DECLARE(void run_warp_wind(const WarpKernel& f))

} // namespace sahel
