#pragma once

#include "world/terrain_tables.h"

/// The large shapes of the base terrain at one sample, as plain functions of a few floats: massifs, the height of the
/// land, lakes, gullies. Heights in m. Constants are chosen by eye unless a source is named.
namespace sahel {

SAHEL_HD float phasor_scale(const Lattice& lattice, float wavelength_m) {
    const auto n2 = static_cast<float>(lattice.a * lattice.a + lattice.b * lattice.b);
    return static_cast<float>(int64_t{1} << lattice.m) / (2.0f * n2 * wavelength_m);
}

inline constexpr float k_mountain_relief = 0.10f; ///< mountains begin above
inline constexpr float k_canyon_sum = -0.1f;      ///< canyons begin above
/// Share of wadis that cells of a size show: they are 60 m wide.
SAHEL_HD float wadi_seen(float spacing_m) {
    return sstep(0.3f, 1.5f, 60.0f / spacing_m);
}

/// Signed distance to the zero line of a noise: value over slope, m.
SAHEL_HD float zero_line_distance(float value, float gx, float gy, float floor_slope, float limit_m) {
    const float slope = sqrt1(gx * gx + gy * gy) + floor_slope;
    return min2(max2(value / slope, -limit_m), limit_m);
}

// --- massif: few low octaves, each held back where the coarser ones are steep already (gradient attenuation, Quilez)
// ---

struct Massif {
    float height, slope_x, slope_y; ///< in units of the mountain height; slopes times k_massif_slope_m
};
SAHEL_HD void massif_base(float a, float n, float gx, float gy, Massif& m) {
    const float s = sqrt1(n * n + 0.006f);
    m.height += a * (1.0f - s * 1.9f);
    const float k = -a * 1.9f * n / s;
    m.slope_x += k * gx * k_massif_slope_m;
    m.slope_y += k * gy * k_massif_slope_m;
}
SAHEL_HD void massif_octave(float a, float n, float gx, float gy, Massif& m) {
    m.slope_x += a * gx * k_massif_slope_m;
    m.slope_y += a * gy * k_massif_slope_m;
    m.height += a * n / (1.0f + 0.55f * (m.slope_x * m.slope_x + m.slope_y * m.slope_y));
}
SAHEL_HD void massif_ridged_octave(float a, float n, float gx, float gy, Massif& m) {
    const float s = sqrt1(n * n + 0.02f);
    const float k = -n / s * 1.6f;
    massif_octave(a, 0.45f - s * 1.6f, gx * k, gy * k, m);
}

// --- height of the land before lakes and gullies ---

struct LandSample {
    float plain, relief, mountain, dune, canyon, continent, massif, line_m;
};

SAHEL_HD float land_m(const BaseTerrainParams& p, const LandSample& s) {
    return p.base_m + p.rise_m * sstep(-0.35f, 0.62f, s.relief) + s.canyon * p.canyon_m * 0.55f;
}
SAHEL_HD float mount_m(const BaseTerrainParams& p, const LandSample& s) {
    return p.mountain_m * s.mountain * max2(s.massif * 0.62f + 0.30f, -0.05f);
}
SAHEL_HD float inland_height(const BaseTerrainParams& p, const LandSample& s) {
    const float d = abs1(s.line_m);
    float wide = 1.0f - clamp01((d - 60.0f) * (1.0f / 1250.0f));
    float narrow = 1.0f - clamp01((d - 25.0f) * (1.0f / 400.0f));
    wide = wide * wide * (3.0f - 2.0f * wide);
    narrow = narrow * narrow * (3.0f - 2.0f * narrow);
    return land_m(p, s) + s.plain * (1.0f - 0.55f * s.dune) + mount_m(p, s) -
           s.canyon * p.canyon_m * (0.50f * wide + 0.50f * narrow);
}
SAHEL_HD float shelf_m(float c) {
    return c >= 0.0f ? 26.0f * c : -10.0f * clamp01(-9.0f * c) - 220.0f * sstep(0.10f, 0.80f, -c);
}
SAHEL_HD float island_height(const BaseTerrainParams& p, const LandSample& s) {
    const float c = s.continent;
    return shelf_m(c) + sstep(-0.02f, 0.30f, c) * (s.plain + land_m(p, s)) + mount_m(p, s) * sstep(-0.06f, 0.22f, c);
}
SAHEL_HD float wetland_height(const BaseTerrainParams& p, const LandSample& s) {
    const float c = s.continent;
    return (c < 0.0f ? 0.6f * shelf_m(c) : 3.0f * c) + 0.16f * s.plain +
           (land_m(p, s) - p.base_m) * sstep(0.05f, 0.40f, c) * s.mountain + mount_m(p, s) * sstep(0.0f, 0.35f, c) -
           0.55f;
}

// --- lakes ---

inline constexpr float k_watered = 0.42f;     ///< mean wetness beside water
inline constexpr float k_lake_shrink = 0.75f; ///< so beyond 3 radii `lake` is 2.25 at least: what reads it ends there

/// One lake at (dx, dy) from its site: bowl and rim, the distance in radii, its level.
SAHEL_HD void lake_shape(const LakeSite& site, float dx, float dy, float coarse, float fine, float coves, float& height,
                         float& lake, float& level) {
    const float r0 = sqrt1(dx * dx + dy * dy) / site.radius_m;
    const float r =
        r0 * max2(1.0f + 0.40f * coarse * sstep(0.1f, 0.6f, r0) + 0.17f * fine + 0.09f * coves, k_lake_shrink);
    const float r2 = r * r;
    const float bowl = site.level_m - site.depth_m * (1.0f - r2);
    const float rim = site.level_m + 0.05f * site.radius_m * (r - 1.0f) * r;
    const float profile = r < 1.0f ? bowl : rim;
    height = r <= 2.2f ? mix1(profile, height, sstep(0.95f, 2.2f, r)) : height;
    level = r < lake ? site.level_m : level;
    lake = min2(r, lake);
}
/// Ground water near lakes and streams makes the land as wet as a wet climate does, in patches. `near`: share, 0 to 1;
/// `patches`: noise.
SAHEL_HD float watered(float wetness, float near, float patches) {
    return wetness + near * max2(k_watered + 0.8f * patches - wetness, 0.0f);
}
SAHEL_HD float lake_waters(float lake, float coarse, float fine) {
    return (1.0f - sstep(1.05f, 2.2f, lake + 0.9f * coarse + 0.6f * fine)) *
           (1.0f - sstep(1.6f, k_no_lake * k_lake_shrink, lake));
}

/// Share of a lake in what happens at `lake` radii: nothing carves its bowl.
SAHEL_HD float lake_mask(float lake) {
    return 1.0f - sstep(1.7f, 2.2f, lake);
}

// --- streams ---

inline constexpr float k_least_half_m = 1.6f; ///< narrower than that they are dry

/// Share of their valleys that samples of a spacing show.
SAHEL_HD float stream_seen(float spacing_m) {
    return sstep(64.0f, 24.0f, spacing_m);
}

/// The nearest place of the streams near a sample.
struct StreamNear {
    float distance_m = k_stream_reach_m;
    float side_m = k_stream_reach_m; ///< from the line through the piece, signed: left of the way or right of it
    float half_m = 0.0f, level_m = 0.0f;
};
/// (dx, dy): the sample from the beginning of the piece, m.
SAHEL_HD void stream_piece(const StreamPiece& p, float dx, float dy, StreamNear& near) {
    const float length2 = p.dx_m * p.dx_m + p.dy_m * p.dy_m + 1e-6f;
    const float t = clamp01((dx * p.dx_m + dy * p.dy_m) / length2);
    const float qx = dx - t * p.dx_m, qy = dy - t * p.dy_m;
    const float d = sqrt1(qx * qx + qy * qy);
    const bool nearer = d < near.distance_m;
    const float side = (dy * p.dx_m - dx * p.dy_m) / sqrt1(length2); // straight on beyond the ends
    near.half_m = nearer ? mix1(p.half_m, p.half_end_m, t) : near.half_m;
    near.level_m = nearer ? mix1(p.level_m, p.level_end_m, t) : near.level_m;
    near.side_m = nearer ? side : near.side_m;
    near.distance_m = nearer ? d : near.distance_m;
}
/// Share of a stream in what happens around it: it ends gently.
SAHEL_HD float stream_share(float half_m) {
    return sstep(0.0f, 0.5f * k_least_half_m, half_m);
}
/// Valley of a stream: a floor just above the water that rises to the land. Nothing fills the bowl of a lake.
SAHEL_HD float stream_valley(float height, float distance_m, float half_m, float level_m, float lake, float seen) {
    const float edge = half_m + 14.0f;
    const float floor_m = level_m + 0.35f + 0.012f * max2(distance_m - half_m, 0.0f);
    const float w = (1.0f - sstep(edge, k_stream_reach_m, distance_m)) * stream_share(half_m) * sstep(1.0f, 1.3f, lake);
    return mix1(height, floor_m, w * seen);
}
/// Width that is still carried at a distance: so far from the middle line nothing is wet, even where the sign of the
/// distance changes between two streams.
SAHEL_HD float stream_width(float half_m, float distance_m) {
    return half_m * (1.0f - sstep(45.0f, 65.0f, distance_m));
}
/// Around streams, as at lakes, nothing carves and no dune stands: `lake` in radii as lake_mask takes it.
SAHEL_HD float stream_hold(float distance_m, float half_m) {
    const float share = stream_share(half_m) * (1.0f - sstep(half_m + 30.0f, k_stream_reach_m, distance_m));
    return k_no_lake - 1.4f * share; // at least k_lake_end
}

SAHEL_HD float stream_waters(float distance_m, float half_m, float patches) {
    return stream_share(half_m) * (1.0f - sstep(20.0f, 120.0f, distance_m + 70.0f * patches)) *
           (1.0f - sstep(120.0f, k_stream_reach_m, distance_m));
}

/// Bed, banks and water of a stream at a cell; `table_m` is the height of the water table so far, `dune_sand` m of sand
/// that blew there: streams carry it away, and leave `sand` on bars beside them. `noise` of some 70 m.
SAHEL_HD void stream_bed(float side_m, float half_m, float level_m, float lake, float spacing_m, float noise,
                         float& height, float& table_m, float& dune_sand, float& sand) {
    const float wide = max2(half_m * max2(1.0f + 0.8f * noise, 0.7f), 0.55f * spacing_m);
    const float a = abs1(side_m), u = a / wide;
    const float share = stream_share(half_m);
    const float dig = sstep(k_least_half_m, 2.8f, half_m); // no bed deeper than the water that fills it
    const float u2 = u * u;
    const float bed = level_m - (0.25f + 0.10f * half_m) * (1.0f - u2 * u2);
    const float bank = level_m + 0.10f + 0.10f * max2(a - wide, 0.0f);
    const float to_bank = (1.0f - sstep(wide + 1.0f, wide + 14.0f, a)) * share * sstep(1.0f, 1.15f, lake);
    const bool wet = u < 1.0f && half_m > k_least_half_m;
    const float outside = mix1(height, bank, to_bank);
    const float inside = mix1(height, min2(height, bed), dig);
    height = wet ? inside : outside;
    table_m = wet ? max2(table_m, level_m) : table_m;
    dune_sand *= 1.0f - share * (1.0f - sstep(wide + 2.0f, wide + 16.0f, a));
    // Bars lie now on this bank, now on that one.
    const float bar = wide - 2.0f + 34.0f * max2((side_m < 0.0f ? noise : -noise) + 0.02f, 0.0f);
    sand = max2(sand, share * (1.0f - sstep(bar, bar + 3.0f, a)));
}

// --- gullies: stripes down the slope that all coarser octaves left behind, sharp ridges between them; then the slope
// of
//     the stripes joins the slope. After Clay John (2018), Westin (2023) and Skovbo Johansen (2026). ---

inline constexpr float k_gully_slope = 0.05f; ///< gentler slopes have none

struct Slope {
    float x, y;
};
/// Direction of the stripes' phase: across the slope.
SAHEL_HD Slope stripe_direction(float gx, float gy) {
    const float il = 1.0f / sqrt1(gx * gx + gy * gy + 1e-8f);
    return {-gy * il, gx * il};
}
/// Amplitude is proportional to slope and wavelength, so flats and crests stay whole. `hold` is 1 where nothing carves.
SAHEL_HD void carve_gully(float amplitude, float wavelength_m, const Phasor& p, float canyon, float dune, float hold,
                          float& height, float& gx, float& gy) {
    const float slope = sqrt1(gx * gx + gy * gy);
    const Slope across = stripe_direction(gx, gy);
    const float norm = 1.0f / max2(sqrt1(p.c * p.c + p.s * p.s), 0.5f);
    const float c = p.c * norm, s = p.s * norm;
    const float a = amplitude * min2(slope, 0.8f) * sstep(k_gully_slope, 0.30f, slope) * (1.0f + 0.1f * canyon) *
                    (1.0f - dune) * (1.0f - hold);
    const float root = sqrt1((1.0f - c) * 0.5f + 0.02f);
    height += a * (0.45f * c + 0.55f * (1.0f - 2.0f * root) - 0.1f);
    const float turn = -a * s * (0.45f + 0.55f * 0.5f / root) * 6.2831853f / wavelength_m;
    gx += turn * across.x;
    gy += turn * across.y;
}

} // namespace sahel
