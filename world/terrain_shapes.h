#pragma once

#include "world/terrain_tables.h"

/// The shapes of the base terrain at one sample, as plain functions of a few floats: what the row kernels and the CUDA
/// kernels both call. Constants are those of the method; heights in m.
namespace sahel {

inline constexpr float k_no_water_table_m = -1000.0f;
inline constexpr float k_lake_reach = 3.0f; ///< radii beyond which a lake changes nothing

SAHEL_HD float phasor_scale(const Lattice& lattice, float wavelength_m) {
    const auto n2 = static_cast<float>(lattice.a * lattice.a + lattice.b * lattice.b);
    return static_cast<float>(int64_t{1} << lattice.m) / (2.0f * n2 * wavelength_m);
}

/// Signed distance to the zero line of a noise: value over slope, m.
SAHEL_HD float zero_line_distance(float value, float gx, float gy, float floor_slope, float limit_m) {
    const float slope = sqrt1(gx * gx + gy * gy) + floor_slope;
    return min2(max2(value / slope, -limit_m), limit_m);
}

// --- massif: few low octaves, each held back where the coarser ones are steep already (gradient attenuation, Quilez)
// ---
SAHEL_HD void massif_base(float weight, float n, float gx, float gy, float& massif, float& slope_x, float& slope_y) {
    const float s = sqrt1(n * n + 0.006f);
    massif += 0.75f * weight * (1.0f - s * 1.9f);
    const float k = -0.75f * weight * 1.9f * n / s;
    slope_x += k * gx * k_massif_slope_m;
    slope_y += k * gy * k_massif_slope_m;
}
SAHEL_HD void massif_octave(float a, float n, float gx, float gy, float& massif, float& slope_x, float& slope_y) {
    slope_x += a * gx * k_massif_slope_m;
    slope_y += a * gy * k_massif_slope_m;
    massif += a * n / (1.0f + 0.55f * (slope_x * slope_x + slope_y * slope_y));
}
SAHEL_HD void massif_ridged_octave(float a, float n, float gx, float gy, float& massif, float& slope_x,
                                   float& slope_y) {
    const float s = sqrt1(n * n + 0.02f);
    const float k = -n / s * 1.6f;
    massif_octave(a, 0.45f - s * 1.6f, gx * k, gy * k, massif, slope_x, slope_y);
}

/// Height of the land before lakes and gullies.
struct HeightShape {
    BaseTerrainParams p;

    SAHEL_HD float height(float plain, float relief, float mountain, float dune, float canyon, float continent,
                          float massif, float line_m) const {
        const float land = p.base_m + p.rise_m * sstep(-0.35f, 0.62f, relief) + canyon * p.canyon_m * 0.55f;
        const float mount = p.mountain_m * mountain * max2(massif * 0.62f + 0.30f, -0.05f);
        if (p.sea != 0) {
            const float c = continent;
            const float shelf = c >= 0.0f ? 26.0f * c : -10.0f * clamp01(-9.0f * c) - 220.0f * sstep(0.10f, 0.80f, -c);
            const float dry = shelf + sstep(-0.02f, 0.30f, c) * (plain + land) + mount * sstep(-0.06f, 0.22f, c);
            const float wet = (c < 0.0f ? 0.6f * shelf : 3.0f * c) + 0.16f * plain +
                              (land - p.base_m) * sstep(0.05f, 0.40f, c) * mountain + mount * sstep(0.0f, 0.35f, c) -
                              0.55f;
            return p.wetland > 0.0f ? wet : dry;
        }
        const float d = abs1(line_m);
        float wide = 1.0f - clamp01((d - 60.0f) * (1.0f / 1250.0f));
        float narrow = 1.0f - clamp01((d - 25.0f) * (1.0f / 400.0f));
        wide = wide * wide * (3.0f - 2.0f * wide);
        narrow = narrow * narrow * (3.0f - 2.0f * narrow);
        return land + plain * (1.0f - 0.55f * dune) + mount - canyon * p.canyon_m * (0.50f * wide + 0.50f * narrow);
    }
};

/// One lake at (dx, dy) from its site: bowl, rim, water table, and the mask in which nothing else carves.
SAHEL_HD void lake_shape(const LakeSite& site, float dx, float dy, float coarse, float fine, float sea, float& height,
                         float& water_table, float& lake) {
    const float r0 = sqrt1(dx * dx + dy * dy) / site.radius_m;
    const float r = r0 * (1.0f + 0.40f * coarse * sstep(0.1f, 0.6f, r0) + 0.10f * fine);
    const float r2 = r * r;
    const float bowl = site.level_m - site.depth_m * (1.0f - r2 * r2);
    const float rim = site.level_m + 0.05f * site.radius_m * (r - 1.0f) * r;
    const float profile = r < 1.0f ? bowl : rim;
    const bool inside = r <= 2.2f;
    height = inside ? mix1(profile, height, sstep(0.95f, 2.2f, r)) : height;
    const float mask = 1.0f - sstep(1.3f, 2.0f, r);
    lake = inside ? max2(lake, mask) : lake;
    const float table = site.level_m - 8.0f * sstep(1.06f, 1.22f, r);
    const float held = sea > 0.0f ? max2(table, 0.0f) : table;
    water_table = r < 1.4f ? held : water_table;
}

/// One octave of gullies on nodes: stripes down the slope that all coarser octaves left behind, sharp ridges between
/// them; then the slope of the stripes joins the slope.
SAHEL_HD void carve_gully(float amplitude, float wavelength_m, float c, float s, float canyon, float dune, float lake,
                          float& height, float& gx, float& gy) {
    const float slope = sqrt1(gx * gx + gy * gy);
    const float il = 1.0f / sqrt1(gx * gx + gy * gy + 1e-8f);
    const float sx = -gy * il, sy = gx * il;
    const float norm = 1.0f / max2(sqrt1(c * c + s * s), 0.5f);
    const float cc = c * norm, ss = s * norm;
    const float a = amplitude * min2(slope, 0.8f) * sstep(0.05f, 0.30f, slope) * (1.0f + 0.1f * canyon) *
                    (1.0f - dune) * (1.0f - lake);
    const float root = sqrt1((1.0f - cc) * 0.5f + 0.02f);
    height += a * (0.45f * cc + 0.55f * (1.0f - 2.0f * root) - 0.1f);
    const float turn = -a * ss * (0.45f + 0.55f * 0.5f / root) * 6.2831853f / wavelength_m;
    gx += turn * sx;
    gy += turn * sy;
}

// --- cells
// --------------------------------------------------------------------------------------------------------------

/// A cliff and a ledge every 44 m, along the contours.
SAHEL_HD float strata_height(float h, float slope, float canyon, float mesa, float strata, float plain, float fine,
                             float fine_weight, float fade) {
    const float wavy = h + canyon * (5.0f * fine_weight * fine);
    const float z = (wavy + 18.0f * strata + 0.02f * (plain * 100.0f)) * (1.0f / k_strata_m);
    const float f = z - floor1(z);
    const float step = sstep(0.34f, 0.58f, f) * 0.80f + 0.20f * f;
    return wavy + (step - f) * k_strata_m * fade * canyon * max2(sstep(0.03f, 0.16f, slope), 0.45f * mesa);
}

SAHEL_HD float wadi_depth(float wadi_m, float line_m, float strata, float slope2, float mountain, float canyon,
                          float dune, float lake) {
    const float d = abs1(line_m + 72.0f * strata);
    return wadi_m * (1.0f - sstep(10.0f, 75.0f, d)) * (1.0f - mountain) * (1.0f - canyon) * sstep(0.12f, 0.035f, dune) *
           sstep(0.004f, 0.02f, 30.0f * slope2) * (1.0f - lake);
}

SAHEL_HD float roughness(float slope, float mountain, float canyon, float dune, float lake) {
    return (0.12f + 0.88f * sstep(0.08f, 0.55f, slope) * (0.30f + 0.70f * max2(mountain, 0.30f * canyon))) *
           (1.0f - 0.9f * dune) * (1.0f - 0.85f * lake);
}

SAHEL_HD void carve_fine_gully(float amplitude, float wavelength_m, float c, float s, float rough, float mountain,
                               float canyon, float& height, float& gx, float& gy) {
    const float slope = sqrt1(gx * gx + gy * gy);
    const float il = 1.0f / sqrt1(gx * gx + gy * gy + 1e-8f);
    const float sx = -gy * il, sy = gx * il;
    const float norm = 1.0f / max2(sqrt1(c * c + s * s), 0.45f);
    const float a =
        amplitude * min2(slope, 0.9f) * sstep(0.1f, 0.4f, slope) * rough * min2(1.0f, 8.0f * max2(mountain, canyon));
    height += a * (c * norm - 0.35f);
    const float turn = -a * s * norm * 6.2831853f / wavelength_m;
    gx += turn * sx;
    gy += turn * sy;
}

/// Where on the stoss or the lee of a wave a phase lies.
struct DunePhase {
    float psi, stoss, lee;
    bool on_stoss;
};
/// `height_m` of the wave there; the slip face keeps tan 31 degrees whatever it is.
SAHEL_HD DunePhase dune_phase(float s, float c, float lee_factor, float height_m, float wavelength_m, float lee_min) {
    DunePhase d;
    d.psi = atan2_turns(s, c);
    d.psi = d.psi - floor1(d.psi);
    const float lee = max2(lee_factor * height_m / (0.60f * wavelength_m), lee_min);
    const float brink = 1.0f - lee;
    d.stoss = d.psi / brink;
    d.lee = clamp01((1.0f - d.psi) / lee);
    d.on_stoss = d.psi < brink;
    return d;
}

struct DuneShape {
    float dune_m, mega_m, supply;
    float dune_weight, mega_weight; ///< band weights; profiles fade to their mean
    bool mega;

    /// Thickness of sand, m, on ground of `slope`.
    SAHEL_HD float thickness(float dune, float noise_supply, float ds, float dc, float ms, float mc, float fine,
                             float fine_weight, float small_wave, float slope, float lake) const {
        const float sup = supply * sstep(0.0f, 0.9f, dune) * (1.0f + 0.8f * noise_supply);
        float base = 0.0f, mask = 1.0f;
        if (mega) {
            const float a =
                sstep(0.05f, 0.65f, sqrt1(ms * ms + mc * mc)) * (0.65f + 0.5f * noise_supply) * min2(dune, 1.0f);
            const DunePhase d = dune_phase(ms, mc, 0.9f, a * mega_m, mega_m * k_mega_wavelength + 1.0f, 0.04f);
            const float stoss = d.stoss * (0.25f + d.stoss * (1.35f - 0.60f * d.stoss));
            const float lee = d.lee * (0.75f + 0.25f * d.lee);
            mask = d.on_stoss ? 1.0f : 0.6f * (1.0f - sstep(0.1f, 0.5f, 1.0f - abs1(2.0f * d.lee - 1.0f)));
            const float position = 0.36f + mega_weight * ((d.on_stoss ? stoss : lee) - 0.36f);
            base = a * mega_m * position;
        }
        const float a = max2(sstep(0.08f, 0.6f, sqrt1(ds * ds + dc * dc)) * (0.62f + 0.75f * noise_supply) *
                                 min2(dune * 1.2f, 1.0f) * (0.55f + 0.45f * mask),
                             0.0f);
        const DunePhase d = dune_phase(ds, dc, 0.95f, a * dune_m, dune_m * k_dune_wavelength, 0.05f);
        const float stoss = d.stoss * (0.30f + d.stoss * (1.5f - 0.80f * d.stoss));
        const float lee = d.lee * (0.8f + 0.2f * d.lee);
        const float position = 0.40f + dune_weight * ((d.on_stoss ? stoss : lee) - 0.40f);
        const float on_stoss = d.on_stoss ? 1.0f : 0.0f;
        const float waves = a * dune_m * position + fine_weight * 0.35f * fine * position * a +
                            small_wave * clamp01(0.25f + 0.9f * noise_supply + 0.5f * position) * on_stoss *
                                (0.35f + 0.52f * d.stoss * (2.0f - d.stoss)) * mask * min2(dune * 1.2f, 1.0f);
        const float bared = dune_m * 0.42f * (1.0f - clamp01(sup * 0.75f));
        const float t = (sup * 1.6f * dune + base + waves - bared) * sstep(0.02f, 0.35f, dune) *
                        (1.0f - sstep(0.35f, 0.7f, slope)) * (1.0f - 0.97f * lake);
        return max2(t, 0.0f);
    }
};

/// Profile of the smallest dunes, 0..1.
SAHEL_HD float small_dune(float s, float c, float weight) {
    float psi = atan2_turns(s, c);
    psi = psi - floor1(psi);
    const float stoss = psi * 1.25f;
    const float profile = min2(stoss * (0.5f + 0.5f * stoss), (1.0f - psi) * 5.0f);
    return weight * 1.15f * sstep(0.1f, 0.7f, sqrt1(s * s + c * c)) * profile;
}

struct SurfaceLayers {
    float rock, soil, sand, water;
};

/// Splits the height into rock, soil and sand, and fills water up to the table.
struct LayerShape {
    bool sea;
    float wetland;
    bool wadi;

    SAHEL_HD SurfaceLayers split(float h, float slope, float table_m, float wetness, float mountain, float dune,
                                 float canyon, float lake, float line_m, float noise, float noise_weight,
                                 float dune_sand) const {
        float soil = (1.0f - sstep(0.22f, 0.75f, slope + 0.12f * noise_weight * noise)) *
                     (0.25f + 1.6f * sstep(-0.5f, 0.5f, wetness) + 0.5f * lake) * (1.0f - 0.85f * dune) *
                     (1.0f - 0.6f * canyon);
        soil = max2(soil - 0.05f, 0.0f);
        const float above = h - table_m;
        const float shore =
            (1.0f - sstep(1.2f, 3.2f, above + 0.8f * noise_weight * noise)) * sstep(-9.0f, -2.5f, above);
        const float beach = (sea ? shore * 2.2f * (1.0f - 0.92f * wetland) : (lake > 0.0f ? shore * 0.8f : 0.0f)) *
                            (1.0f - sstep(0.25f, 0.6f, slope));
        const float dry = wadi && wetland <= 0.0f ? 1.0f : 0.0f;
        const float bed = clamp01(1.2f - abs1(line_m) * 0.018f - 0.9f * abs1(noise)) *
                          sstep(0.004f, 0.02f, slope * slope * 30.0f) * dry * (1.0f - mountain) * (1.0f - canyon) *
                          0.8f * (sea ? sstep(0.0f, 3.0f, h) : 1.0f);
        const float loose = max2(beach, bed);
        soil *= 1.0f - clamp01(loose);
        soil = above < -0.3f ? soil * 0.5f : soil;
        const float deep = max2(table_m - (h + dune_sand), 0.0f);
        return {h - soil - loose, soil, loose + dune_sand, deep};
    }
};

} // namespace sahel
