#include "world/terrain_rows.h"
#include "world/terrain_shapes.h"

// Cell rows of the base terrain: compiled once per instruction set (see cpu_features.h).
namespace sahel::SAHEL_ISA_NAMESPACE {

namespace {

void noise_row(const Lattice& lattice, const SampleRow& row, int n, float* __restrict out) {
    const LatticeRow r = lattice_row(lattice, row);
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) out[x] = noise_value(r, lattice_point(r, x));
}

float* field(const CellRows& rows, NodeField f) {
    return rows.nodes.f[static_cast<int>(f)];
}

void strata_and_wadi(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const CellRows& rows) {
    float* __restrict h = field(rows, NodeField::height);
    const float* __restrict gx = field(rows, NodeField::slope_x);
    const float* __restrict gy = field(rows, NodeField::slope_y);
    const float* __restrict canyon = field(rows, NodeField::canyon);
    const float* __restrict strata = field(rows, NodeField::strata);
    if (rows.has_canyon) {
        const float weight = band_weight(t.fine_gully[0].size_m, spacing_m);
        float* __restrict fine = rows.scratch[0];
        if (weight > 0.0f)
            noise_row(t.fine_gully[0], row, n, fine);
        else
            for (int x = 0; x < n; ++x) fine[x] = 0.0f;
        const float* __restrict plain = field(rows, NodeField::plain4);
        const float fade = sstep(1.2f, 4.0f, k_strata_m * 2.5f / spacing_m) * 0.9f;
        const float mesa = t.p.mesa;
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x)
            h[x] = strata_height(h[x], sqrt1(gx[x] * gx[x] + gy[x] * gy[x]), canyon[x], mesa, strata[x], plain[x],
                                 fine[x], weight, fade);
    }
    if (t.p.wadi_m > 0.0f) {
        const float wadi_m = t.p.wadi_m * sstep(0.3f, 1.5f, 60.0f / spacing_m);
        const float* __restrict line = field(rows, NodeField::line0);
        const float* __restrict mountain = field(rows, NodeField::mountain);
        const float* __restrict dune = field(rows, NodeField::dune);
        const float* __restrict lake = field(rows, NodeField::lake);
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x)
            h[x] -= wadi_depth(wadi_m, line[x], strata[x], gx[x] * gx[x] + gy[x] * gy[x], mountain[x], canyon[x],
                               dune[x], lake[x]);
    }
}

void gullies_and_rock(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const CellRows& rows) {
    float* __restrict h = field(rows, NodeField::height);
    float* __restrict gx = field(rows, NodeField::slope_x);
    float* __restrict gy = field(rows, NodeField::slope_y);
    const float* __restrict mountain = field(rows, NodeField::mountain);
    const float* __restrict canyon = field(rows, NodeField::canyon);
    const float* __restrict dune = field(rows, NodeField::dune);
    const float* __restrict lake = field(rows, NodeField::lake);
    float* __restrict rough = rows.scratch[0];
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x)
        rough[x] = roughness(sqrt1(gx[x] * gx[x] + gy[x] * gy[x]), mountain[x], canyon[x], dune[x], lake[x]);
    float* __restrict c = rows.scratch[1];
    float* __restrict s = rows.scratch[2];
    for (int o = 0; o < 2 && (rows.has_mountain || rows.has_canyon); ++o) {
        const Lattice& lattice = t.fine_gully[o];
        const float wavelength = lattice.size_m * k_gully_wavelength;
        const float weight = band_weight(wavelength * 0.8f, spacing_m);
        if (weight <= 0.0f || t.p.gully <= 0.0f) continue;
        const LatticeRow r = lattice_row(lattice, row);
        const auto a = static_cast<float>(lattice.a), b = static_cast<float>(lattice.b);
        const float scale = phasor_scale(lattice, wavelength);
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) {
            const float il = 1.0f / sqrt1(gx[x] * gx[x] + gy[x] * gy[x] + 1e-8f);
            const Phasor p = phasor_at(r, lattice_point(r, x), a, b, -gy[x] * il, gx[x] * il, scale, 0.0f);
            c[x] = p.c;
            s[x] = p.s;
        }
        const float amplitude = k_fine_gully_amplitude[o] * wavelength * t.p.gully * weight;
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x)
            carve_fine_gully(amplitude, wavelength, c[x], s[x], rough[x], mountain[x], canyon[x], h[x], gx[x], gy[x]);
    }
    float* __restrict sum = rows.scratch[1];
    for (int x = 0; x < n; ++x) sum[x] = 0.0f;
    for (int o = 0; o < 6; ++o) {
        const Lattice& lattice = t.rock[o];
        const float weight = band_weight(lattice.size_m, spacing_m);
        if (weight <= 0.0f) continue;
        const float a = weight * lattice.size_m * (o < 3 ? 0.055f : 0.06f);
        const LatticeRow r = lattice_row(lattice, row);
        if (o == 1 || o == 3) { // billows turned over: cracks
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

void hummocks(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const CellRows& rows) {
    float* __restrict h = field(rows, NodeField::height);
    const float* __restrict wetland = field(rows, NodeField::wetland);
    const float* __restrict line = field(rows, NodeField::line1);
    float* __restrict sum = rows.scratch[0];
    for (int x = 0; x < n; ++x) sum[x] = 0.0f;
    constexpr float k_height_m[3] = {1.5f, 1.0f, 0.6f};
    for (int o = 0; o < 3; ++o) {
        const float weight = band_weight(t.hummock[o].size_m, spacing_m);
        if (weight <= 0.0f) continue;
        const LatticeRow r = lattice_row(t.hummock[o], row);
        const float a = k_height_m[o] * weight;
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) {
            const float v = noise_value(r, lattice_point(r, x));
            sum[x] += a * (0.25f - 1.3f * abs1(v) + 0.5f * v);
        }
    }
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) h[x] += wetland[x] * (sum[x] - 3.2f * (1.0f - sstep(6.0f, 26.0f, abs1(line[x]))));
}

void dunes(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const CellRows& rows,
           float* __restrict thickness) {
    float* __restrict fine = rows.scratch[1];
    float* __restrict wave = rows.scratch[2];
    const float fine_weight = band_weight(t.dune_fine.size_m, spacing_m);
    if (t.dune_fine.size_m >= spacing_m * 0.42f)
        noise_row(t.dune_fine, row, n, fine);
    else
        for (int x = 0; x < n; ++x) fine[x] = 0.0f;
    const float small_weight = band_weight(k_small_dune_m * 0.7f, spacing_m);
    if (small_weight > 0.0f) {
        const LatticeRow r = lattice_row(t.small, row);
        const auto a = static_cast<float>(t.small.a), b = static_cast<float>(t.small.b);
        const float scale = phasor_scale(t.small, k_small_dune_m);
        const float wx = t.wind_x, wy = t.wind_y;
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) {
            const float shift = 6.0f * fine[x];
            const Phasor p = phasor_at(r, lattice_point(r, x, shift * wx, shift * wy), a, b, wx, wy, scale, 0.45f);
            wave[x] = small_dune(p.s, p.c, small_weight);
        }
    } else {
        for (int x = 0; x < n; ++x) wave[x] = 0.0f;
    }
    const float dune_m = t.p.dune_m, mega_m = t.p.mega_dune_m;
    const DuneShape shape{dune_m,
                          mega_m,
                          t.p.sand_supply,
                          band_weight(dune_m * k_dune_wavelength * 0.5f, spacing_m),
                          band_weight(mega_m * k_mega_wavelength * 0.5f, spacing_m),
                          mega_m > 0.0f};
    const float* __restrict dune = field(rows, NodeField::dune);
    const float* __restrict supply = field(rows, NodeField::supply);
    const float* __restrict ds = field(rows, NodeField::dune_sin);
    const float* __restrict dc = field(rows, NodeField::dune_cos);
    const float* __restrict ms = field(rows, NodeField::mega_sin);
    const float* __restrict mc = field(rows, NodeField::mega_cos);
    const float* __restrict gx = field(rows, NodeField::slope_x);
    const float* __restrict gy = field(rows, NodeField::slope_y);
    const float* __restrict lake = field(rows, NodeField::lake);
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x)
        thickness[x] = shape.thickness(dune[x], supply[x], ds[x], dc[x], ms[x], mc[x], fine[x], fine_weight, wave[x],
                                       sqrt1(gx[x] * gx[x] + gy[x] * gy[x]), lake[x]);
}

} // namespace

void terrain_cell_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const CellRows& rows) {
    strata_and_wadi(t, row, n, spacing_m, rows);
    gullies_and_rock(t, row, n, spacing_m, rows);
    if (t.p.wetland > 0.0f) hummocks(t, row, n, spacing_m, rows);
    float* __restrict thickness = rows.scratch[3];
    if (rows.has_dune)
        dunes(t, row, n, spacing_m, rows, thickness);
    else
        for (int x = 0; x < n; ++x) thickness[x] = 0.0f;

    float* __restrict noise = rows.scratch[0];
    const float weight = band_weight(t.rock[0].size_m, spacing_m);
    if (weight > 0.0f)
        noise_row(t.rock[0], row, n, noise);
    else
        for (int x = 0; x < n; ++x) noise[x] = 0.0f;
    const LayerShape shape{t.p.sea != 0, t.p.wetland, t.p.wadi_m > 0.0f};
    const float* __restrict h = field(rows, NodeField::height);
    const float* __restrict gx = field(rows, NodeField::slope_x);
    const float* __restrict gy = field(rows, NodeField::slope_y);
    const float* __restrict table = field(rows, NodeField::water_table);
    const float* __restrict wet = field(rows, NodeField::wetness);
    const float* __restrict mountain = field(rows, NodeField::mountain);
    const float* __restrict dune = field(rows, NodeField::dune);
    const float* __restrict canyon = field(rows, NodeField::canyon);
    const float* __restrict lake = field(rows, NodeField::lake);
    const float* __restrict line = field(rows, NodeField::line0);
    float* __restrict rock = rows.rock;
    float* __restrict soil = rows.soil;
    float* __restrict sand = rows.sand;
    float* __restrict water = rows.water;
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) {
        const SurfaceLayers l = shape.split(h[x], sqrt1(gx[x] * gx[x] + gy[x] * gy[x]), table[x], wet[x], mountain[x],
                                            dune[x], canyon[x], lake[x], line[x], noise[x], weight, thickness[x]);
        rock[x] = l.rock;
        soil[x] = l.soil;
        sand[x] = l.sand;
        water[x] = l.water;
    }
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
