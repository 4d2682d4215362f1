#pragma once

#include "world/terrain_ground.h"
#include "world/terrain_node_rows.h"

/// The middle pass of the base terrain, see terrain_rows.h: everything between some 30 and 100 m that is smooth.
namespace sahel::SAHEL_ISA_NAMESPACE {

SAHEL_ROW const float* node_of(const MidRow& row, NodeField f) {
    return row.node[static_cast<int>(f)];
}
SAHEL_ROW float* out_of(const MidRow& row, MidField f) {
    return row.out[static_cast<int>(f)];
}

SAHEL_ROW void rills_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const MidRow& rows,
                         const float* __restrict hold, float* __restrict gx, float* __restrict gy) {
    float* __restrict h = out_of(rows, MidField::height);
    const float* __restrict rough = out_of(rows, MidField::rough);
    const float* __restrict mountain = node_of(rows, NodeField::mountain);
    const float* __restrict dune = node_of(rows, NodeField::dune);
    const float* __restrict canyon = node_of(rows, NodeField::canyon);
    const float* __restrict wetland = node_of(rows, NodeField::wetland);
    float* __restrict fan = rows.scratch[3];
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x)
        fan[x] = fan_weight(sqrt1(gx[x] * gx[x] + gy[x] * gy[x]), mountain[x], canyon[x], dune[x], wetland[x], hold[x]);
    int32_t any = 0;
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) {
        const bool steep = sqrt1(gx[x] * gx[x] + gy[x] * gy[x]) > k_rill_slope && max2(mountain[x], canyon[x]) > 0.0f;
        any |= steep || fan[x] > 0.0f ? 1 : 0;
    }
    if (any == 0) return;
    float* __restrict c = rows.scratch[4];
    float* __restrict s = rows.scratch[5];
    for (int o = 0; o < 2; ++o) {
        const Lattice& lattice = t.fine_gully[o].lattice;
        const float wavelength = lattice.size_m * k_gully_wavelength;
        const float weight = band_weight(wavelength * 0.8f, spacing_m) * t.p.gully;
        if (weight <= 0.0f) continue;
        const LatticeRow r = lattice_row(lattice, row);
        const auto a = static_cast<float>(lattice.a), b = static_cast<float>(lattice.b);
        const float scale = phasor_scale(lattice, wavelength);
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) {
            const Slope across = stripe_direction(gx[x], gy[x]);
            const Phasor p = phasor_at(r, lattice_point(r, x), a, b, across.x, across.y, scale, 0.0f);
            c[x] = p.c;
            s[x] = p.s;
        }
        const float amplitude = t.fine_gully[o].amplitude * wavelength * weight;
        const float fan_m = (o == 0 ? 0.9f : 0.5f) * weight;
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) {
            float height = h[x], slope_x = gx[x], slope_y = gy[x];
            carve_rill(amplitude, fan_m, wavelength, Phasor{c[x], s[x]}, rough[x],
                       min2(1.0f, 8.0f * max2(mountain[x], canyon[x])), fan[x], height, slope_x, slope_y);
            h[x] = height;
            gx[x] = slope_x;
            gy[x] = slope_y;
        }
    }
}

/// Adds rough * octaves [first, last); odd octaves are billows turned over: cracks.
template <int k_first, int k_last>
SAHEL_ROW void rock_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m,
                        const float* __restrict rough, float* __restrict sum, float* __restrict h) {
    fill_row(n, 0.0f, sum);
    for (int o = k_first; o < k_last; ++o) {
        const Lattice& lattice = t.rock[o].lattice;
        const float weight = band_weight(lattice.size_m, spacing_m);
        if (weight <= 0.0f) continue;
        const float a = weight * lattice.size_m * t.rock[o].amplitude;
        const LatticeRow r = lattice_row(lattice, row);
        if (o == 1 || o == 3) {
            SAHEL_VECTORIZE
            for (int x = 0; x < n; ++x) sum[x] += a * (0.28f - 1.2f * abs1(noise_value(r, lattice_point(r, x))));
        } else {
            SAHEL_VECTORIZE
            for (int x = 0; x < n; ++x) sum[x] += a * noise_value(r, lattice_point(r, x));
        }
    }
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) h[x] += sum[x] * rough[x];
}

/// Wetland: hummocks and pools, channels.
SAHEL_ROW void hummock_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m,
                           const float* __restrict wetland, const float* __restrict line, float* __restrict sum,
                           float* __restrict h) {
    fill_row(n, 0.0f, sum);
    for (int o = 0; o < 3; ++o) {
        const float weight = band_weight(t.hummock[o].lattice.size_m, spacing_m);
        if (weight <= 0.0f) continue;
        const LatticeRow r = lattice_row(t.hummock[o].lattice, row);
        const float a = t.hummock[o].amplitude * weight;
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) {
            const float v = noise_value(r, lattice_point(r, x));
            sum[x] += a * (0.25f - 1.3f * abs1(v) + 0.5f * v);
        }
    }
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) h[x] += wetland[x] * (sum[x] - 3.2f * (1.0f - sstep(6.0f, 26.0f, abs1(line[x]))));
}

/// Amplitudes of the dunes, so that cells need only the profiles.
SAHEL_ROW void dune_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const MidRow& rows,
                        const float* __restrict hold) {
    float* __restrict fine = out_of(rows, MidField::fine);
    float* __restrict small_a = out_of(rows, MidField::small);
    float* __restrict small_sin = out_of(rows, MidField::small_sin);
    float* __restrict small_cos = out_of(rows, MidField::small_cos);
    const float* __restrict dune = node_of(rows, NodeField::dune);
    noise_row(t.dune_fine, row, n, spacing_m, fine);
    const float small_weight = band_weight(k_small_dune_m * 0.7f, spacing_m) * 1.15f;
    if (small_weight > 0.0f) {
        const LatticeRow r = lattice_row(t.small, row);
        const auto a = static_cast<float>(t.small.a), b = static_cast<float>(t.small.b);
        const float scale = phasor_scale(t.small, k_small_dune_m);
        const float wx = t.wind_x, wy = t.wind_y;
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) {
            const float shift = 6.0f * fine[x];
            const Phasor p = phasor_at(r, lattice_point(r, x, shift * wx, shift * wy), a, b, wx, wy, scale, 0.45f);
            small_sin[x] = p.s;
            small_cos[x] = p.c;
            small_a[x] = small_weight * sstep(0.1f, 0.7f, sqrt1(p.c * p.c + p.s * p.s)) * min2(dune[x] * 1.2f, 1.0f);
        }
    } else {
        fill_row(n, 0.0f, small_sin);
        fill_row(n, 1.0f, small_cos);
        fill_row(n, 0.0f, small_a);
    }
    const float* __restrict supply = node_of(rows, NodeField::supply);
    const float* __restrict ds = node_of(rows, NodeField::dune_sin);
    const float* __restrict dc = node_of(rows, NodeField::dune_cos);
    const float* __restrict ms = node_of(rows, NodeField::mega_sin);
    const float* __restrict mc = node_of(rows, NodeField::mega_cos);
    const float* __restrict slope = out_of(rows, MidField::slope);
    float* __restrict mega_a = out_of(rows, MidField::mega);
    float* __restrict dune_a = out_of(rows, MidField::dune);
    float* __restrict sand = out_of(rows, MidField::sand);
    float* __restrict factor = out_of(rows, MidField::sand_factor);
    const float sand_supply = t.p.sand_supply, dune_m = t.p.dune_m;
    // Where single crests cannot be seen amplitudes fade to their mean, too.
    constexpr float k_mean = 0.75f;
    const float dune_seen = band_weight(t.dune.size_m, spacing_m);
    const float mega_seen = band_weight(t.mega.size_m, spacing_m);
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) {
        const float in_sea = sstep(0.0f, 0.9f, dune[x]);
        const float sup = sand_supply * in_sea * (1.0f + 0.8f * supply[x]);
        const float mega = k_mean + mega_seen * (sstep(0.05f, 0.65f, sqrt1(ms[x] * ms[x] + mc[x] * mc[x])) - k_mean);
        const float small = k_mean + dune_seen * (sstep(0.08f, 0.6f, sqrt1(ds[x] * ds[x] + dc[x] * dc[x])) - k_mean);
        mega_a[x] = mega * (0.65f + 0.5f * supply[x]) * dune[x];
        dune_a[x] = max2(small * (0.62f + 0.75f * supply[x]) * min2(dune[x] * 1.2f, 1.0f), 0.0f);
        fine[x] = 0.35f * fine[x];
        sand[x] = sup * 1.6f * dune[x] - dune_m * 0.42f * (1.0f - clamp01(sup * 0.75f));
        factor[x] = sstep(0.02f, 0.35f, dune[x]) * (1.0f - sstep(0.35f, 0.7f, slope[x])) * (1.0f - hold[x]);
    }
}

SAHEL_ROW void middle_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const MidRow& rows) {
    const float* __restrict slope_x = node_of(rows, NodeField::slope_x);
    const float* __restrict slope_y = node_of(rows, NodeField::slope_y);
    const float* __restrict mountain = node_of(rows, NodeField::mountain);
    const float* __restrict dune = node_of(rows, NodeField::dune);
    const float* __restrict canyon = node_of(rows, NodeField::canyon);
    const float* __restrict wadi = node_of(rows, NodeField::wadi);
    float* __restrict h = out_of(rows, MidField::height);
    float* __restrict slope = out_of(rows, MidField::slope);
    float* __restrict rough = out_of(rows, MidField::rough);
    float* __restrict hold = rows.scratch[0];
    float* __restrict gx = rows.scratch[1];
    float* __restrict gy = rows.scratch[2];
    if (rows.has_lake) {
        const float* __restrict lake = node_of(rows, NodeField::lake);
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) hold[x] = lake_mask(lake[x]);
    } else {
        fill_row(n, 0.0f, hold);
    }
    const float wadi_m = t.p.wadi_m * wadi_seen(spacing_m);
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) {
        gx[x] = slope_x[x];
        gy[x] = slope_y[x];
        const float g = sqrt1(gx[x] * gx[x] + gy[x] * gy[x]);
        rough[x] = roughness(g, mountain[x], canyon[x], dune[x], hold[x]);
        h[x] = -wadi_depth(wadi_m, wadi[x], g, mountain[x], canyon[x], dune[x], hold[x]);
    }
    rills_row(t, row, n, spacing_m, rows, hold, gx, gy);
    rock_row<0, 2>(t, row, n, spacing_m, rough, rows.scratch[3], h);
    if (t.p.wetland > 0.0f)
        hummock_row(t, row, n, spacing_m, node_of(rows, NodeField::wetland), node_of(rows, NodeField::channel),
                    rows.scratch[3], h);

    float* __restrict noise = out_of(rows, MidField::noise);
    noise_row(t.rock[0].lattice, row, n, spacing_m, noise);
    const float* __restrict wetness = node_of(rows, NodeField::wetness);
    float* __restrict soil = out_of(rows, MidField::soil);
    float* __restrict bed = out_of(rows, MidField::bed);
    const float bed_on = t.p.wadi_m > 0.0f && t.p.wetland <= 0.0f ? wadi_seen(spacing_m) : 0.0f;
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) {
        const float g = sqrt1(gx[x] * gx[x] + gy[x] * gy[x]);
        slope[x] = g;
        soil[x] = soil_thickness(g, wetness[x], dune[x], canyon[x], hold[x], noise[x]);
        bed[x] = bed_on * wadi_sand(wadi[x], g, mountain[x], canyon[x], noise[x]);
    }
    if (rows.has_canyon) {
        float* __restrict strata = out_of(rows, MidField::strata);
        const float fade = sstep(1.2f, 4.0f, k_strata_m * 2.5f / spacing_m) * 0.9f;
        const float flat = 0.45f * t.p.mesa;
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) {
            strata[x] = fade * canyon[x] * max2(sstep(0.03f, 0.16f, slope[x]), flat);
            h[x] += canyon[x] * (1.2f + 3.8f * sstep(0.03f, 0.16f, slope[x])) * noise[x];
        }
    }
    if (rows.has_dune) dune_row(t, row, n, spacing_m, rows, hold);
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
