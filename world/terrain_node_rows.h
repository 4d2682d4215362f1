#pragma once

#include "world/terrain_rows.h"
#include "world/terrain_shapes.h"

/// The node passes of the base terrain, see terrain_rows.h.
namespace sahel::SAHEL_ISA_NAMESPACE {

SAHEL_ROW float* field_of(const BaseRow& row, NodeField f) {
    return row.field[static_cast<int>(f)];
}

SAHEL_ROW float* sum_of(const BaseRow& row, SumField f) {
    return row.sum[static_cast<int>(f)];
}

SAHEL_ROW void fill_row(int n, float value, float* __restrict out) {
    for (int x = 0; x < n; ++x) out[x] = value;
}

/// Calls body(x0, x1) for the parts of a row, in chunks of whole vectors, for which active(x0, x1) says that a term is
/// not zero all over; neighbouring chunks come together. What is left out must be exactly zero: chunks lie elsewhere in
/// another rectangle.
template <class Active, class Body> SAHEL_ROW void for_active_runs(int n, const Active& active, const Body& body) {
    constexpr int k_chunk = 16;
    int begin = -1;
    for (int x0 = 0; x0 < n; x0 += k_chunk) {
        const bool on = active(x0, x0 + k_chunk < n ? x0 + k_chunk : n);
        if (on && begin < 0) begin = x0;
        if (!on && begin >= 0) {
            body(begin, x0);
            begin = -1;
        }
    }
    if (begin >= 0) body(begin, n);
}

/// Noise times its band weight, in [begin, end).
SAHEL_ROW void noise_row(const Lattice& lattice, const SampleRow& row, int begin, int end, float spacing_m,
                         float* __restrict out) {
    const float weight = band_weight(lattice.size_m, spacing_m);
    if (weight <= 0.0f) {
        fill_row(end - begin, 0.0f, out + begin);
        return;
    }
    const LatticeRow r = lattice_row(lattice, row);
    SAHEL_VECTORIZE
    for (int x = begin; x < end; ++x) out[x] = weight * noise_value(r, lattice_point(r, x));
}
SAHEL_ROW void noise_row(const Lattice& lattice, const SampleRow& row, int n, float spacing_m, float* __restrict out) {
    noise_row(lattice, row, 0, n, spacing_m, out);
}

/// sum += octaves of the range at the warped place.
template <int k_count>
SAHEL_ROW void add_octaves(const Octave (&octaves)[k_count], float scale, const SumRange& range, const SampleRow& row,
                           int n, float spacing_m, const float* __restrict wx, const float* __restrict wy,
                           float* __restrict sum) {
    for (int o = 0; o < k_count; ++o) {
        const Octave& octave = octaves[o];
        const float weight = band_weight(octave.lattice.size_m, spacing_m);
        if (weight <= 0.0f || !range.smooth.has(octave.lattice.size_m)) continue;
        const float a = octave.amplitude * scale * weight;
        const LatticeRow r = lattice_row(octave.lattice, row);
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) sum[x] += a * noise_value(r, lattice_point(r, x, wx[x], wy[x]));
    }
}

/// Signed distance to the zero line of a noise, m, in [begin, end).
SAHEL_ROW void line_row(const Lattice& lattice, const SampleRow& row, int begin, int end, float spacing_m,
                        const float* __restrict wx, const float* __restrict wy, float floor_slope, float limit_m,
                        float* __restrict out) {
    if (lattice.size_m < spacing_m) {
        fill_row(end - begin, limit_m, out + begin);
        return;
    }
    const LatticeRow r = lattice_row(lattice, row);
    SAHEL_VECTORIZE
    for (int x = begin; x < end; ++x) {
        const NoiseGradient g = noise_gradient(r, lattice_point(r, x, wx[x], wy[x]));
        out[x] = zero_line_distance(g.value, g.dx, g.dy, floor_slope, limit_m);
    }
}

/// sum += octaves of the range, m.
SAHEL_ROW void add_warp(const Octave (&octaves)[2], const OctaveRange& range, const SampleRow& row, int n,
                        float spacing_m, float* __restrict sum) {
    for (const Octave& octave : octaves) {
        const float weight = band_weight(octave.lattice.size_m, spacing_m) * octave.amplitude;
        if (weight <= 0.0f || !range.has(octave.lattice.size_m)) continue;
        const LatticeRow r = lattice_row(octave.lattice, row);
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) sum[x] += weight * noise_value(r, lattice_point(r, x));
    }
}

SAHEL_ROW void massif_row(const TerrainTables& t, const SumRange& range, const SampleRow& row, int begin, int end,
                          float spacing_m, const float* __restrict wx, const float* __restrict wy,
                          float* __restrict height, float* __restrict slope_x, float* __restrict slope_y) {
    const float base = band_weight(t.massif_base.lattice.size_m, spacing_m) * t.massif_base.amplitude;
    if (base > 0.0f && range.ridged.has(t.massif_base.lattice.size_m)) {
        const LatticeRow r = lattice_row(t.massif_base.lattice, row);
        SAHEL_VECTORIZE
        for (int x = begin; x < end; ++x) {
            const NoiseGradient g = noise_gradient(r, lattice_point(r, x, wx[x], wy[x]));
            Massif m{height[x], slope_x[x], slope_y[x]};
            massif_base(base, g.value, g.dx, g.dy, m);
            height[x] = m.height;
            slope_x[x] = m.slope_x;
            slope_y[x] = m.slope_y;
        }
    }
    for (int o = 0; o < 6; ++o) {
        const float weight = band_weight(t.massif[o].lattice.size_m, spacing_m);
        if (weight <= 0.0f || !range.ridged.has(t.massif[o].lattice.size_m)) continue;
        const float a = t.massif[o].amplitude * weight;
        const LatticeRow r = lattice_row(t.massif[o].lattice, row);
        if (o < 2) {
            SAHEL_VECTORIZE
            for (int x = begin; x < end; ++x) {
                const NoiseGradient g = noise_gradient(r, lattice_point(r, x, wx[x], wy[x]));
                Massif m{height[x], slope_x[x], slope_y[x]};
                massif_ridged_octave(a, g.value, g.dx, g.dy, m);
                height[x] = m.height;
                slope_x[x] = m.slope_x;
                slope_y[x] = m.slope_y;
            }
        } else {
            SAHEL_VECTORIZE
            for (int x = begin; x < end; ++x) {
                const NoiseGradient g = noise_gradient(r, lattice_point(r, x, wx[x], wy[x]));
                Massif m{height[x], slope_x[x], slope_y[x]};
                massif_octave(a, g.value, g.dx, g.dy, m);
                height[x] = m.height;
                slope_x[x] = m.slope_x;
                slope_y[x] = m.slope_y;
            }
        }
    }
}

SAHEL_ROW void sum_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const SumRange& range,
                       const BaseRow& out) {
    float* __restrict relief = sum_of(out, SumField::relief);
    float* __restrict wetness = sum_of(out, SumField::wetness);
    float* __restrict continent = sum_of(out, SumField::continent);
    float* __restrict canyon = sum_of(out, SumField::canyon);
    float* __restrict plain = sum_of(out, SumField::plain);
    float* __restrict massif = sum_of(out, SumField::massif);
    float* __restrict massif_x = sum_of(out, SumField::massif_x);
    float* __restrict massif_y = sum_of(out, SumField::massif_y);
    float* __restrict line = sum_of(out, SumField::line);
    float* warp_x = sum_of(out, SumField::warp_x);
    float* warp_y = sum_of(out, SumField::warp_y);
    if (range.start) {
        fill_row(n, 0.0f, warp_x);
        fill_row(n, 0.0f, warp_y);
    }
    add_warp(t.warp_x, range.warp, row, n, spacing_m, warp_x);
    add_warp(t.warp_y, range.warp, row, n, spacing_m, warp_y);
    if (range.start && range.warp.min_m > 0.0f) { // the finer octaves move places, but are added at the nodes
        for (int x = 0; x < n; ++x) out.scratch[0][x] = warp_x[x];
        for (int x = 0; x < n; ++x) out.scratch[1][x] = warp_y[x];
        warp_x = out.scratch[0];
        warp_y = out.scratch[1];
        const OctaveRange finer{0.0f, range.warp.min_m};
        add_warp(t.warp_x, finer, row, n, spacing_m, warp_x);
        add_warp(t.warp_y, finer, row, n, spacing_m, warp_y);
    }
    const float* __restrict wx = warp_x;
    const float* __restrict wy = warp_y;
    if (range.start) {
        fill_row(n, t.p.relief_bias, relief);
        fill_row(n, t.p.wetness_bias, wetness);
        fill_row(n, t.p.continent_bias, continent);
        fill_row(n, t.p.canyon_bias, canyon);
        fill_row(n, 0.0f, plain);
        fill_row(n, 0.0f, massif);
        fill_row(n, 0.0f, massif_x);
        fill_row(n, 0.0f, massif_y);
        fill_row(n, k_line_limit_m, line);
    }
    add_octaves(t.relief, t.p.relief_scale, range, row, n, spacing_m, wx, wy, relief);
    add_octaves(t.wet, t.p.wetness_scale, range, row, n, spacing_m, wx, wy, wetness);
    if (sum_needed(t, SumField::continent))
        add_octaves(t.continent, t.p.continent_scale, range, row, n, spacing_m, wx, wy, continent);
    if (sum_needed(t, SumField::canyon)) add_octaves(t.canyon, 1.0f, range, row, n, spacing_m, wx, wy, canyon);
    add_octaves(t.plain, t.p.plain_m, range, row, n, spacing_m, wx, wy, plain);
    // At the nodes themselves all sums are whole: what has no mountain needs no massif, and what has neither wadi nor
    // canyon no line.
    const bool whole = range.ridged.min_m <= 0.0f;
    if (sum_needed(t, SumField::massif)) {
        const auto has_mountain = [&](int x0, int x1) {
            if (!whole) return true;
            int32_t found = 0;
            SAHEL_VECTORIZE
            for (int x = x0; x < x1; ++x) found |= relief[x] > k_mountain_relief ? 1 : 0;
            return found != 0;
        };
        for_active_runs(n, has_mountain, [&](int x0, int x1) {
            massif_row(t, range, row, x0, x1, spacing_m, wx, wy, massif, massif_x, massif_y);
        });
    }
    if (sum_needed(t, SumField::line) && range.ridged.has(t.canyon_line.size_m)) {
        const bool canyons = sum_needed(t, SumField::canyon), wadis = wadi_seen(spacing_m) > 0.0f;
        const auto has_line = [&](int x0, int x1) {
            if (!whole || wadis || !canyons) return wadis || canyons;
            int32_t found = 0;
            SAHEL_VECTORIZE
            for (int x = x0; x < x1; ++x) found |= canyon[x] > k_canyon_sum ? 1 : 0;
            return found != 0;
        };
        for_active_runs(n, has_line, [&](int x0, int x1) {
            line_row(t.canyon_line, row, x0, x1, spacing_m, wx, wy, 4e-5f, k_line_limit_m, line);
        });
    }
}

SAHEL_ROW void base_row(const TerrainTables& t, const SampleRow&, int n, float, const BaseRow& out) {
    const float* __restrict relief = sum_of(out, SumField::relief);
    const float* __restrict wet = sum_of(out, SumField::wetness);
    const float* __restrict canyon_sum = sum_of(out, SumField::canyon);
    float* __restrict mountain = field_of(out, NodeField::mountain);
    float* __restrict dune = field_of(out, NodeField::dune);
    float* __restrict canyon = field_of(out, NodeField::canyon);
    float* __restrict wetness = field_of(out, NodeField::wetness);
    float* __restrict wetland = field_of(out, NodeField::wetland);
    const float canyon_on = sum_needed(t, SumField::canyon) ? 1.0f : 0.0f;
    const float dune_on = t.p.dune_m > 0.0f ? 1.0f : 0.0f;
    const float wetland_on = t.p.wetland;
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) {
        const float m = sstep(k_mountain_relief, 0.55f, relief[x]);
        const float k = sstep(k_canyon_sum, 0.25f, canyon_sum[x]) * (1.0f - m) * canyon_on;
        const float d = sstep(-0.02f, -0.26f, relief[x]) * (1.0f - sstep(0.05f, 0.40f, wet[x])) * dune_on * (1.0f - k);
        mountain[x] = m;
        canyon[x] = k;
        dune[x] = d;
        wetness[x] = wet[x];
        wetland[x] = wetland_on * (1.0f - m) * (1.0f - d);
    }

    float* __restrict h = out.height;
    const float* __restrict plain = sum_of(out, SumField::plain);
    const float* __restrict continent = sum_of(out, SumField::continent);
    const float* __restrict massif = sum_of(out, SumField::massif);
    const float* __restrict line = sum_of(out, SumField::line);
    const BaseTerrainParams& p = t.p;
    const auto sample = [&](int x) {
        return LandSample{plain[x], relief[x], mountain[x], dune[x], canyon[x], continent[x], massif[x], line[x]};
    };
    if (p.sea == 0) {
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) h[x] = inland_height(p, sample(x));
    } else if (p.wetland <= 0.0f) {
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) h[x] = island_height(p, sample(x));
    } else {
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) h[x] = wetland_height(p, sample(x));
    }
}

SAHEL_ROW void gully_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const float* above,
                         const float* below, const BaseRow& out) {
    const float* __restrict north = above;
    const float* __restrict here = out.height;
    const float* __restrict south = below;
    float* __restrict h = field_of(out, NodeField::height);
    float* __restrict gx = field_of(out, NodeField::slope_x);
    float* __restrict gy = field_of(out, NodeField::slope_y);
    const float span = 2.0f * spacing_m;
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) {
        gx[x] = (here[x + 1] - here[x - 1]) / span;
        gy[x] = (south[x] - north[x]) / span;
        h[x] = here[x];
    }
    if (t.p.gully <= 0.0f) return;
    const float* __restrict canyon = field_of(out, NodeField::canyon);
    const float* __restrict dune = field_of(out, NodeField::dune);
    const float* __restrict lake = field_of(out, NodeField::lake);
    float* __restrict c = out.scratch[0];
    float* __restrict s = out.scratch[1];
    const auto is_carved = [&](int x0, int x1) { // flats and dunes are not
        int32_t any = 0;
        SAHEL_VECTORIZE
        for (int x = x0; x < x1; ++x)
            any |= sqrt1(gx[x] * gx[x] + gy[x] * gy[x]) > k_gully_slope && dune[x] < 1.0f ? 1 : 0;
        return any != 0;
    };
    for_active_runs(n, is_carved, [&](int x0, int x1) {
        for (int o = 0; o < 5; ++o) {
            const Lattice& lattice = t.gully[o].lattice;
            const float wavelength = lattice.size_m * k_gully_wavelength;
            const float weight = band_weight(wavelength * 0.8f, spacing_m);
            if (weight <= 0.0f) continue;
            const LatticeRow r = lattice_row(lattice, row);
            const auto a = static_cast<float>(lattice.a), b = static_cast<float>(lattice.b);
            const float scale = phasor_scale(lattice, wavelength);
            SAHEL_VECTORIZE
            for (int x = x0; x < x1; ++x) {
                const Slope across = stripe_direction(gx[x], gy[x]);
                const Phasor p = phasor_at(r, lattice_point(r, x), a, b, across.x, across.y, scale, 0.0f);
                c[x] = p.c;
                s[x] = p.s;
            }
            const float amplitude = weight * t.p.gully * t.gully[o].amplitude * wavelength;
            SAHEL_VECTORIZE
            for (int x = x0; x < x1; ++x) {
                float height = h[x], slope_x = gx[x], slope_y = gy[x];
                carve_gully(amplitude, wavelength, Phasor{c[x], s[x]}, canyon[x], dune[x], lake_mask(lake[x]), height,
                            slope_x, slope_y);
                h[x] = height;
                gx[x] = slope_x;
                gy[x] = slope_y;
            }
        }
    });
}

/// Phases of the dunes in [begin, end).
SAHEL_ROW void dune_phase_row(const TerrainTables& t, const SampleRow& row, int begin, int end, float spacing_m,
                              const BaseRow& out) {
    noise_row(t.supply, row, begin, end, spacing_m, field_of(out, NodeField::supply));
    float* __restrict wave = out.scratch[0];
    float* __restrict wide = out.scratch[1];
    float* __restrict sx = out.scratch[2];
    float* __restrict sy = out.scratch[3];
    float* __restrict turn = out.scratch[4];
    const bool is_dune = band_weight(t.dune.size_m, spacing_m) > 0.0f;
    const bool is_mega = t.p.mega_dune_m > 0.0f && band_weight(t.mega.size_m, spacing_m) > 0.0f;
    if (is_dune || is_mega) {
        noise_row(t.wind_turn, row, begin, end, spacing_m, turn);
        noise_row(t.dune_warp, row, begin, end, spacing_m, wave);
        noise_row(t.lake_shape[0], row, begin, end, spacing_m, wide);
        const float wind_x = t.wind_x, wind_y = t.wind_y;
        SAHEL_VECTORIZE
        for (int x = begin; x < end; ++x) {
            const float turned = 0.55f * turn[x];
            const float ux = wind_x - wind_y * turned, uy = wind_y + wind_x * turned;
            const float il = 1.0f / sqrt1(ux * ux + uy * uy);
            sx[x] = ux * il;
            sy[x] = uy * il;
        }
    }
    const auto phases = [&](const Lattice& lattice, float wavelength_m, float wave_m, float wide_m, float jitter,
                            float* __restrict sin_out, float* __restrict cos_out) {
        const LatticeRow r = lattice_row(lattice, row);
        const auto a = static_cast<float>(lattice.a), b = static_cast<float>(lattice.b);
        const float scale = phasor_scale(lattice, wavelength_m);
        SAHEL_VECTORIZE
        for (int x = begin; x < end; ++x) {
            const float shift = wave_m * wave[x] + wide_m * wide[x];
            const Phasor p =
                phasor_at(r, lattice_point(r, x, shift * sx[x], shift * sy[x]), a, b, sx[x], sy[x], scale, jitter);
            cos_out[x] = p.c;
            sin_out[x] = p.s;
        }
    };
    const auto phases_or_none = [&](const Lattice& lattice, bool on, float wavelength_m, float wide_m, float jitter,
                                    NodeField sin_field, NodeField cos_field) {
        if (on) {
            phases(lattice, wavelength_m, 26.0f, wide_m, jitter, field_of(out, sin_field), field_of(out, cos_field));
        } else {
            fill_row(end - begin, 0.0f, field_of(out, sin_field) + begin);
            fill_row(end - begin, 0.0f, field_of(out, cos_field) + begin);
        }
    };
    phases_or_none(t.dune, is_dune, t.p.dune_m * k_dune_wavelength, 0.0f, 0.30f, NodeField::dune_sin,
                   NodeField::dune_cos);
    phases_or_none(t.mega, is_mega, t.p.mega_dune_m * k_mega_wavelength, 190.0f, 0.45f, NodeField::mega_sin,
                   NodeField::mega_cos);
}

SAHEL_ROW void detail_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const float* above,
                          const float* below, bool dunes, bool canyons, bool blended, const BaseRow& out) {
    gully_row(t, row, n, spacing_m, above, below, out);
    float* __restrict strata = field_of(out, NodeField::strata);
    float* __restrict wadi = field_of(out, NodeField::wadi);
    const bool wadis = t.p.wadi_m > 0.0f && wadi_seen(spacing_m) > 0.0f;
    if (wadis || canyons) noise_row(t.strata, row, n, spacing_m, strata);
    if (wadis) {
        const float* __restrict line = sum_of(out, SumField::line);
        float* __restrict bend = out.scratch[0];
        noise_row(t.lake_shape[1], row, n, spacing_m, bend);
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) wadi[x] = line[x] + 150.0f * strata[x] + 45.0f * bend[x];
    } else {
        fill_row(n, k_line_limit_m, wadi);
    }
    if (canyons) {
        float* __restrict tilt = out.scratch[0];
        float* __restrict fold = out.scratch[1];
        noise_row(t.tilt, row, n, spacing_m, tilt);
        noise_row(t.plain[4].lattice, row, n, spacing_m, fold);
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) strata[x] = 18.0f * strata[x] + 2.0f * fold[x] + 110.0f * tilt[x];
    }
    if (t.p.wetland > 0.0f)
        line_row(t.channel_line, row, 0, n, spacing_m, sum_of(out, SumField::warp_x), sum_of(out, SumField::warp_y),
                 1.2e-4f, 1500.0f, field_of(out, NodeField::channel));
    if (!dunes) return;
    for (const NodeField f :
         {NodeField::supply, NodeField::dune_sin, NodeField::dune_cos, NodeField::mega_sin, NodeField::mega_cos})
        fill_row(n, 0.0f, field_of(out, f));
    const float* __restrict dune = field_of(out, NodeField::dune);
    const auto has_dune = [&](int x0, int x1) {
        if (blended) return true;
        int32_t any = 0;
        SAHEL_VECTORIZE
        for (int x = x0; x < x1; ++x) any |= dune[x] > 0.0f ? 1 : 0;
        return any != 0;
    };
    for_active_runs(n, has_dune, [&](int x0, int x1) { dune_phase_row(t, row, x0, x1, spacing_m, out); });
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
