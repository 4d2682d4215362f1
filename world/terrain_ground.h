#pragma once

#include "world/terrain_shapes.h"

/// The fine shapes of the base terrain at one sample: wadis, rills, strata, dunes, and the split into layers.
namespace sahel {

/// Wadis run over sloping ground, neither over flats nor across mountain sides.
SAHEL_HD float wadi_slope(float slope) {
    return sstep(0.004f, 0.02f, 30.0f * slope * slope) * sstep(0.30f, 0.12f, slope);
}
SAHEL_HD float wadi_depth(float wadi_m, float line_m, float slope, float mountain, float canyon, float dune,
                          float hold) {
    return wadi_m * (1.0f - sstep(10.0f, 75.0f, abs1(line_m))) * (1.0f - mountain) * (1.0f - canyon) *
           sstep(0.12f, 0.035f, dune) * wadi_slope(slope) * (1.0f - hold);
}

SAHEL_HD float roughness(float slope, float mountain, float canyon, float dune, float hold) {
    return (0.12f + 0.88f * sstep(0.08f, 0.55f, slope) * (0.30f + 0.70f * max2(mountain, 0.30f * canyon))) *
           (1.0f - 0.9f * dune) * (1.0f - 0.85f * hold);
}

inline constexpr float k_rill_slope = 0.1f; ///< gentler slopes have none but on fans

/// Gullies of some ten metres on steep ground; on the fans in front of ranges, shallow braided channels.
SAHEL_HD void carve_rill(float amplitude, float fan_m, float wavelength_m, const Phasor& p, float rough, float region,
                         float fan, float& height, float& gx, float& gy) {
    const float slope = sqrt1(gx * gx + gy * gy);
    const Slope across = stripe_direction(gx, gy);
    const float norm = 1.0f / max2(sqrt1(p.c * p.c + p.s * p.s), 0.45f);
    const float c = p.c * norm;
    const float a = amplitude * min2(slope, 0.9f) * sstep(k_rill_slope, 0.4f, slope) * rough * region;
    height += a * (c - 0.35f) - fan_m * fan * (sstep(0.1f, 0.95f, c) - 0.25f);
    const float turn = -a * p.s * norm * 6.2831853f / wavelength_m;
    gx += turn * across.x;
    gy += turn * across.y;
}
/// Where fans are: gentle steady slopes of bare plains.
SAHEL_HD float fan_weight(float slope, float mountain, float canyon, float dune, float wetland, float hold) {
    return sstep(0.006f, 0.02f, slope) * (1.0f - sstep(0.07f, 0.16f, slope)) * (1.0f - mountain) * (1.0f - canyon) *
           (1.0f - dune) * (1.0f - wetland) * (1.0f - hold);
}

/// A cliff and a ledge every 44 m, along the contours; `shift_m` tilts and folds the layers.
SAHEL_HD float strata_step(float height, float shift_m) {
    const float z = (height + shift_m) * (1.0f / k_strata_m);
    const float f = z - floor1(z);
    return (sstep(0.34f, 0.58f, f) * 0.80f + 0.20f * f - f) * k_strata_m;
}

// --- dunes: profiles of a phase that grows downwind (Tsoar 2001 for the shape, slip faces at 31 degrees) ---

/// Where on the stoss or the lee of a wave a phase lies.
struct DunePhase {
    float stoss, lee; ///< 0 to 1 along each
    float psi, brink; ///< on the stoss where psi < brink
};
/// `height_m` of the wave there; the slip face keeps its angle whatever it is.
SAHEL_HD DunePhase dune_phase(float s, float c, float lee_factor, float height_m, float wavelength_m, float lee_min) {
    float psi = atan2_turns(s, c);
    psi = psi - floor1(psi);
    const float lee = max2(lee_factor * height_m / (0.60f * wavelength_m), lee_min);
    const float brink = 1.0f - lee;
    return {psi / brink, clamp01((1.0f - psi) / lee), psi, brink};
}

/// Profile of the smallest dunes, 0..1.
SAHEL_HD float small_dune(float s, float c) {
    float psi = atan2_turns(s, c);
    psi = psi - floor1(psi);
    const float stoss = psi * 1.25f;
    return min2(stoss * (0.5f + 0.5f * stoss), (1.0f - psi) * 5.0f);
}

struct DuneShape {
    float dune_m, mega_m;
    float dune_weight, mega_weight; ///< band weights; profiles fade to their mean

    /// Thickness of sand, m: large dunes carry the small ones on their stoss, those the smallest.
    /// Phasors as (sin, cos); amplitudes `_a`. Loose floats, because g++ vectorises no struct of that many.
    template <bool k_mega>
    SAHEL_HD float thickness(float supply, float dune_a, float mega_a, float small_a, float dune_sin, float dune_cos,
                             float mega_sin, float mega_cos, float small_sin, float small_cos, float fine, float sand,
                             float sand_factor) const {
        float base = 0.0f, mask = 1.0f;
        if constexpr (k_mega) {
            const DunePhase m =
                dune_phase(mega_sin, mega_cos, 0.9f, mega_a * mega_m, mega_m * k_mega_wavelength + 1.0f, 0.04f);
            const float stoss = m.stoss * (0.25f + m.stoss * (1.35f - 0.60f * m.stoss));
            const float lee = m.lee * (0.75f + 0.25f * m.lee);
            const float sheltered = 0.6f * (1.0f - sstep(0.1f, 0.5f, 1.0f - abs1(2.0f * m.lee - 1.0f)));
            mask = m.psi < m.brink ? 1.0f : sheltered;
            const float profile = m.psi < m.brink ? stoss : lee;
            base = mega_a * mega_m * (0.36f + mega_weight * (profile - 0.36f));
        }
        const float a = dune_a * (0.55f + 0.45f * mask);
        const DunePhase m = dune_phase(dune_sin, dune_cos, 0.95f, a * dune_m, dune_m * k_dune_wavelength, 0.05f);
        const float stoss = m.stoss * (0.30f + m.stoss * (1.5f - 0.80f * m.stoss));
        const float lee = m.lee * (0.8f + 0.2f * m.lee);
        const float profile = m.psi < m.brink ? stoss : lee;
        const float position = 0.40f + dune_weight * (profile - 0.40f);
        const float on_stoss = m.psi < m.brink ? mask : 0.0f;
        const float smallest = small_a * small_dune(small_sin, small_cos) *
                               clamp01(0.25f + 0.9f * supply + 0.5f * position) * on_stoss *
                               (0.35f + 0.52f * m.stoss * (2.0f - m.stoss));
        const float waves = a * dune_m * position + fine * position * a + smallest;
        return max2((sand + base + waves) * sand_factor, 0.0f);
    }
};

// --- layers ---

SAHEL_HD float soil_thickness(float slope, float wetness, float dune, float canyon, float hold, float noise) {
    const float soil = (1.0f - sstep(0.22f, 0.75f, slope + 0.12f * noise)) *
                       (0.25f + 1.6f * sstep(-0.5f, 0.5f, wetness) + 0.5f * hold) *
                       (1.0f - 0.85f * dune * (1.0f - hold)) * (1.0f - 0.6f * canyon);
    return max2(soil - 0.05f, 0.0f);
}
/// Sand on the floor of a wadi.
SAHEL_HD float wadi_sand(float line_m, float slope, float mountain, float canyon, float noise) {
    return clamp01(1.2f - abs1(line_m) * 0.018f - 0.9f * abs1(noise)) * wadi_slope(slope) * (1.0f - mountain) *
           (1.0f - canyon) * 0.8f;
}

/// Lakes end at this many radii; up to there their ground is at least a low bank around them, so that no water stands
/// above dry ground. The bank goes on under the water, steeper than the bowls of lakes: where nodes cut a cove
/// short it ends in a beach and not in a step, which would draw the shore as a staircase of cells.
inline constexpr float k_lake_end = 1.35f;
inline constexpr float k_lake_bank_m = 0.3f;
SAHEL_HD float lake_bank(float height, float lake, float level) {
    const float bank = level + min2((lake - 1.0f) * (lake < 1.0f ? 60.0f : 4.0f), k_lake_bank_m);
    return lake < k_lake_end ? max2(height, bank) : height;
}

struct SurfaceLayers {
    float rock, soil, sand, water;
};
struct LayerShape {
    float sea_beach_m, lake_beach_m; ///< sand on shores
    float sea;                       ///< 1: datum is sea level
    float narrower;                  ///< beaches of lakes than those of a sea, times

    /// `table_m`: height of the water table, far below the ground where there is none.
    SAHEL_HD SurfaceLayers split(float h, float slope, float table_m, float lake, float soil, float bed, float noise,
                                 float dune_sand) const {
        const float above = h - table_m;
        const float shore = (1.0f - sstep(1.2f, 3.2f, narrower * above + 0.8f * noise)) * sstep(-9.0f, -2.5f, above);
        const float beach = shore * (lake < k_lake_end ? max2(lake_beach_m, sea_beach_m) : sea_beach_m) *
                            (1.0f - sstep(0.25f, 0.6f, slope));
        const float loose = max2(beach, bed * (1.0f - sea * sstep(3.0f, 0.0f, h)));
        const float left = soil * (1.0f - clamp01(loose)) * (above < -0.3f ? 0.5f : 1.0f);
        return {h - left - loose, left, loose + dune_sand, max2(table_m - (h + dune_sand), 0.0f)};
    }
};

} // namespace sahel
