#include "world/terrain_rows.h"
#include "world/terrain_shapes.h"

// Node rows of the base terrain: compiled once per instruction set (see cpu_features.h).
namespace sahel::SAHEL_ISA_NAMESPACE {

namespace {

void noise_row(const Lattice& lattice, const SampleRow& row, int n, float* __restrict out) {
    const LatticeRow r = lattice_row(lattice, row);
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) out[x] = noise_value(r, lattice_point(r, x));
}

void add_noise_row(const Lattice& lattice, const SampleRow& row, int n, float spacing_m, const float* __restrict wx,
                   const float* __restrict wy, float amplitude, float* __restrict sum) {
    const float weight = band_weight(lattice.size_m, spacing_m);
    if (weight <= 0.0f) return;
    const float a = amplitude * weight;
    const LatticeRow r = lattice_row(lattice, row);
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) sum[x] += a * noise_value(r, lattice_point(r, x, wx[x], wy[x]));
}

void noise_gradient_row(const Lattice& lattice, const SampleRow& row, int n, const float* __restrict wx,
                        const float* __restrict wy, float* __restrict value, float* __restrict gx,
                        float* __restrict gy) {
    const LatticeRow r = lattice_row(lattice, row);
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) {
        const NoiseGradient g = noise_gradient(r, lattice_point(r, x, wx[x], wy[x]));
        value[x] = g.value;
        gx[x] = g.dx;
        gy[x] = g.dy;
    }
}

void fill_row(int n, float value, float* out) {
    for (int x = 0; x < n; ++x) out[x] = value;
}

/// Signed distance to the zero line of a noise, m.
void line_row(const Lattice& lattice, const SampleRow& row, int n, const float* wx, const float* wy, float floor_slope,
              float limit_m, float* __restrict out, const NodeScratch& s) {
    noise_gradient_row(lattice, row, n, wx, wy, s.v[0], s.v[1], s.v[2]);
    const float* __restrict v = s.v[0];
    const float* __restrict gx = s.v[1];
    const float* __restrict gy = s.v[2];
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) out[x] = zero_line_distance(v[x], gx[x], gy[x], floor_slope, limit_m);
}

void massif_rows(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const float* wx, const float* wy,
                 float* __restrict massif, const NodeScratch& s) {
    float* __restrict value = s.v[0];
    float* __restrict gx = s.v[1];
    float* __restrict gy = s.v[2];
    float* __restrict slope_x = s.v[3];
    float* __restrict slope_y = s.v[4];
    fill_row(n, 0.0f, massif);
    fill_row(n, 0.0f, slope_x);
    fill_row(n, 0.0f, slope_y);
    if (const float weight = band_weight(t.massif[6].size_m, spacing_m); weight > 0.0f) {
        noise_gradient_row(t.massif[6], row, n, wx, wy, value, gx, gy);
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) massif_base(weight, value[x], gx[x], gy[x], massif[x], slope_x[x], slope_y[x]);
    }
    for (int o = 0; o < 6; ++o) {
        const float weight = band_weight(t.massif[o].size_m, spacing_m);
        if (weight <= 0.0f) continue;
        noise_gradient_row(t.massif[o], row, n, wx, wy, value, gx, gy);
        const float a = k_massif_amplitude[o] * weight;
        if (o < 2) {
            SAHEL_VECTORIZE
            for (int x = 0; x < n; ++x)
                massif_ridged_octave(a, value[x], gx[x], gy[x], massif[x], slope_x[x], slope_y[x]);
        } else {
            SAHEL_VECTORIZE
            for (int x = 0; x < n; ++x) massif_octave(a, value[x], gx[x], gy[x], massif[x], slope_x[x], slope_y[x]);
        }
    }
}

} // namespace

void terrain_height_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const NodeRows& out,
                        const NodeScratch& s) {
    float* __restrict wx = out.warp_x;
    float* __restrict wy = out.warp_y;
    fill_row(n, 0.0f, wx);
    fill_row(n, 0.0f, wy);
    constexpr float k_warp_m[2] = {1700.0f, 420.0f};
    for (int o = 0; o < 2; ++o) {
        const float weight = o == 0 ? 1.0f : band_weight(t.warp_x[o].size_m, spacing_m);
        if (weight <= 0.0f || t.warp_y[o].size_m < spacing_m) continue;
        noise_row(t.warp_x[o], row, n, s.v[0]);
        noise_row(t.warp_y[o], row, n, s.v[1]);
        const float* __restrict a = s.v[0];
        const float* __restrict b = s.v[1];
        const float metres = weight * k_warp_m[o];
        for (int x = 0; x < n; ++x) {
            wx[x] += metres * a[x];
            wy[x] += metres * b[x];
        }
    }
    fill_row(n, t.p.relief_bias, out.relief);
    fill_row(n, t.p.wetness_bias, out.wetness);
    fill_row(n, t.p.continent_bias, out.continent);
    float* __restrict canyon = out.canyon;
    fill_row(n, t.p.canyon_bias, canyon);
    for (int o = 0; o < 4; ++o)
        add_noise_row(t.relief[o], row, n, spacing_m, wx, wy, k_relief_amplitude[o] * t.p.relief_scale, out.relief);
    for (int o = 0; o < 3; ++o)
        add_noise_row(t.wet[o], row, n, spacing_m, wx, wy, k_wet_amplitude[o] * t.p.wetness_scale, out.wetness);
    if (t.p.canyon_m > 0.0f)
        for (int o = 0; o < 2; ++o)
            add_noise_row(t.canyon[o], row, n, spacing_m, wx, wy, k_canyon_amplitude[o], canyon);
    if (t.p.sea != 0)
        for (int o = 0; o < 6; ++o)
            add_noise_row(t.continent[o], row, n, spacing_m, wx, wy, k_continent_amplitude[o] * t.p.continent_scale,
                          out.continent);
    {
        const float* __restrict relief = out.relief;
        const float* __restrict wet = out.wetness;
        float* __restrict mountain = out.mountain;
        float* __restrict dune = out.dune;
        float* __restrict wetland = out.wetland;
        const float has_canyon = t.p.canyon_m > 0.0f ? 1.0f : 0.0f;
        const float has_dune = t.p.dune_m > 0.0f ? 1.0f : 0.0f;
        const float wetness = t.p.wetland;
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) {
            const float m = sstep(0.10f, 0.55f, relief[x]);
            const float k = sstep(-0.1f, 0.25f, canyon[x]) * (1.0f - m) * has_canyon;
            const float d =
                sstep(-0.02f, -0.26f, relief[x]) * (1.0f - sstep(0.05f, 0.40f, wet[x])) * has_dune * (1.0f - k);
            mountain[x] = m;
            canyon[x] = k;
            dune[x] = d;
            wetland[x] = wetness * (1.0f - m) * (1.0f - d);
        }
    }
    float* __restrict h = out.height;
    fill_row(n, 0.0f, h);
    for (int o = 0; o < 5; ++o)
        add_noise_row(t.plain[o], row, n, spacing_m, wx, wy, k_plain_amplitude[o] * t.p.plain_m, h);

    float* __restrict massif = s.v[5];
    bool any_mountain = false; // the massif is multiplied by the weight, so a row without it needs none
    for (int x = 0; x < n; ++x) any_mountain |= out.mountain[x] > 0.0f;
    if (any_mountain)
        massif_rows(t, row, n, spacing_m, wx, wy, massif, s);
    else
        fill_row(n, 0.0f, massif);
    float* __restrict line = s.v[6];
    if (t.p.canyon_m > 0.0f && t.line[0].size_m >= spacing_m)
        line_row(t.line[0], row, n, wx, wy, 4e-5f, 3000.0f, line, s);
    else
        fill_row(n, 3000.0f, line);
    {
        const float* __restrict relief = out.relief;
        const float* __restrict mountain = out.mountain;
        const float* __restrict dune = out.dune;
        const float* __restrict continent = out.continent;
        const HeightShape shape{t.p};
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x)
            h[x] = shape.height(h[x], relief[x], mountain[x], dune[x], canyon[x], continent[x], massif[x], line[x]);
    }
}

void terrain_lake_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const LakeSite* sites,
                      int site_count, float* height, float* water_table, float* lake, const NodeScratch& s) {
    fill_row(n, t.p.sea != 0 ? 0.0f : k_no_water_table_m, water_table);
    fill_row(n, 0.0f, lake);
    bool any = false;
    for (int i = 0; i < site_count; ++i) {
        const float dy = static_cast<float>(row.y - sites[i].y_half_m) * 0.5f;
        any |= abs1(dy) < sites[i].radius_m * k_lake_reach;
    }
    if (!any) return;
    for (int o = 0; o < 2; ++o) {
        if (t.lake_shape[o].size_m >= spacing_m)
            noise_row(t.lake_shape[o], row, n, s.v[o]);
        else
            fill_row(n, 0.0f, s.v[o]);
    }
    const float* __restrict coarse = s.v[0];
    const float* __restrict fine = s.v[1];
    float* __restrict h = height;
    float* __restrict w = water_table;
    float* __restrict k = lake;
    const float sea = t.p.sea != 0 ? 1.0f : 0.0f;
    for (int i = 0; i < site_count; ++i) {
        const LakeSite site = sites[i];
        const float dy = static_cast<float>(row.y - site.y_half_m) * 0.5f;
        if (abs1(dy) >= site.radius_m * k_lake_reach) continue;
        const float x0 = static_cast<float>(row.x0 - site.x_half_m) * 0.5f;
        const float step = static_cast<float>(row.step) * 0.5f;
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x)
            lake_shape(site, x0 + step * static_cast<float>(x), dy, coarse[x], fine[x], sea, h[x], w[x], k[x]);
    }
}

void terrain_gully_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const GullyRows& rows,
                       const NodeScratch& s) {
    const float* __restrict above = rows.above;
    const float* __restrict here = rows.here;
    const float* __restrict below = rows.below;
    float* __restrict h = rows.height;
    float* __restrict gx = rows.slope_x;
    float* __restrict gy = rows.slope_y;
    const float span = 2.0f * spacing_m;
    for (int x = 0; x < n; ++x) {
        const int left = x > 0 ? x - 1 : 0; // the outermost nodes are margin and are never used
        const int right = x + 1 < n ? x + 1 : n - 1;
        gx[x] = (here[right] - here[left]) / span;
        gy[x] = (below[x] - above[x]) / span;
        h[x] = here[x];
    }
    if (t.p.gully <= 0.0f) return;
    const float* __restrict canyon = rows.canyon;
    const float* __restrict dune = rows.dune;
    const float* __restrict lake = rows.lake;
    float* __restrict c = s.v[0];
    float* __restrict sn = s.v[1];
    for (int o = 0; o < 5; ++o) {
        const Lattice& lattice = t.gully[o];
        const float wavelength = lattice.size_m * k_gully_wavelength;
        const float weight = band_weight(wavelength * 0.8f, spacing_m);
        if (weight <= 0.0f) continue;
        const LatticeRow r = lattice_row(lattice, row);
        const auto a = static_cast<float>(lattice.a);
        const auto b = static_cast<float>(lattice.b);
        const float scale = phasor_scale(lattice, wavelength);
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) {
            const float il = 1.0f / sqrt1(gx[x] * gx[x] + gy[x] * gy[x] + 1e-8f);
            const Phasor p = phasor_at(r, lattice_point(r, x), a, b, -gy[x] * il, gx[x] * il, scale, 0.0f);
            c[x] = p.c;
            sn[x] = p.s;
        }
        const float amplitude = weight * t.p.gully * k_gully_amplitude[o] * wavelength;
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x)
            carve_gully(amplitude, wavelength, c[x], sn[x], canyon[x], dune[x], lake[x], h[x], gx[x], gy[x]);
    }
}

void terrain_carried_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const float* warp_x,
                         const float* warp_y, bool dunes, const CarriedRows& out, const NodeScratch& s) {
    if (t.line[0].size_m >= spacing_m)
        line_row(t.line[0], row, n, warp_x, warp_y, 4e-5f, 3000.0f, out.line0, s);
    else
        fill_row(n, 3000.0f, out.line0);
    if (t.p.wetland > 0.0f && t.line[1].size_m >= spacing_m)
        line_row(t.line[1], row, n, warp_x, warp_y, 1.2e-4f, 1500.0f, out.line1, s);
    else
        fill_row(n, 1500.0f, out.line1);
    const auto plain_noise = [&](const Lattice& lattice, float* to) {
        if (lattice.size_m >= spacing_m)
            noise_row(lattice, row, n, to);
        else
            fill_row(n, 0.0f, to);
    };
    plain_noise(t.strata, out.strata);
    if (t.p.canyon_m > 0.0f)
        plain_noise(t.plain[4], out.plain4);
    else
        fill_row(n, 0.0f, out.plain4);
    if (!dunes) return;
    plain_noise(t.supply, out.supply);
    plain_noise(t.wind_turn, s.v[0]);
    plain_noise(t.dune_warp, s.v[1]);
    plain_noise(t.lake_shape[0], s.v[2]);
    const float* __restrict turn = s.v[0];
    const float* __restrict wave = s.v[1];
    const float* __restrict wide = s.v[2];
    float* __restrict dune_c = out.dune_cos;
    float* __restrict dune_s = out.dune_sin;
    float* __restrict mega_c = out.mega_cos;
    float* __restrict mega_s = out.mega_sin;
    const LatticeRow rd = lattice_row(t.dune, row);
    const LatticeRow rm = lattice_row(t.mega, row);
    const float scale_d = phasor_scale(t.dune, t.p.dune_m * k_dune_wavelength);
    const float scale_m = phasor_scale(t.mega, max2(t.p.mega_dune_m, 1.0f) * k_mega_wavelength);
    const auto ad = static_cast<float>(t.dune.a), bd = static_cast<float>(t.dune.b);
    const auto am = static_cast<float>(t.mega.a), bm = static_cast<float>(t.mega.b);
    const float wind_x = t.wind_x, wind_y = t.wind_y;
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) {
        const float turned = 0.55f * turn[x];
        const float ux = wind_x - wind_y * turned, uy = wind_y + wind_x * turned;
        const float il = 1.0f / sqrt1(ux * ux + uy * uy);
        const float sx = ux * il, sy = uy * il;
        const float shift = 26.0f * wave[x];
        const Phasor p = phasor_at(rd, lattice_point(rd, x, shift * sx, shift * sy), ad, bd, sx, sy, scale_d, 0.30f);
        dune_c[x] = p.c;
        dune_s[x] = p.s;
    }
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) {
        const float turned = 0.55f * turn[x];
        const float ux = wind_x - wind_y * turned, uy = wind_y + wind_x * turned;
        const float il = 1.0f / sqrt1(ux * ux + uy * uy);
        const float sx = ux * il, sy = uy * il;
        const float shift = 26.0f * wave[x] + 190.0f * wide[x];
        const Phasor p = phasor_at(rm, lattice_point(rm, x, shift * sx, shift * sy), am, bm, sx, sy, scale_m, 0.45f);
        mega_c[x] = p.c;
        mega_s[x] = p.s;
    }
}

void terrain_spline_row(const float* const rows[4], const float weights[4], int node_count, int cells_per_node,
                        int skip, int cells, float* mixed, float* out) {
    const float* __restrict r0 = rows[0];
    const float* __restrict r1 = rows[1];
    const float* __restrict r2 = rows[2];
    const float* __restrict r3 = rows[3];
    const float w0 = weights[0], w1 = weights[1], w2 = weights[2], w3 = weights[3];
    float* __restrict v = mixed;
    SAHEL_VECTORIZE
    for (int x = 0; x < node_count; ++x) v[x] = w0 * r0[x] + w1 * r1[x] + w2 * r2[x] + w3 * r3[x];
    const float inverse = 1.0f / static_cast<float>(cells_per_node);
    float* __restrict to = out;
    int written = 0;
    for (int i = 0; written < cells; ++i) {
        const float a0 = v[i + 1], a1 = v[i + 2], a2 = v[i + 3], a3 = v[i + 4];
        const float k0 = (a0 + 4.0f * a1 + a2) * (1.0f / 6.0f);
        const float k1 = (a2 - a0) * 0.5f;
        const float k2 = (a0 - 2.0f * a1 + a2) * 0.5f;
        const float k3 = (a3 - a0 + 3.0f * (a1 - a2)) * (1.0f / 6.0f);
        const int first = i == 0 ? skip : 0;
        const int count = cells_per_node - first < cells - written ? cells_per_node - first : cells - written;
        for (int e = 0; e < count; ++e) {
            const float f = (static_cast<float>(first + e) + 0.5f) * inverse;
            to[written + e] = k0 + f * (k1 + f * (k2 + f * k3));
        }
        written += count;
    }
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
