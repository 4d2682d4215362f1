#pragma once

#include "world/field.h"
#include "world/terrain_ground.h"
#include "world/terrain_mid_rows.h"

/// The cell pass of the base terrain, see terrain_rows.h: what is sharp or finer than 30 m, and the layers.
namespace sahel::SAHEL_ISA_NAMESPACE {

SAHEL_ROW const float* node_of(const CellRow& row, NodeField f) {
    return row.node[static_cast<int>(f)];
}
SAHEL_ROW const float* mid_of(const CellRow& row, MidField f) {
    return row.mid[static_cast<int>(f)];
}

template <bool k_mega>
SAHEL_ROW void sand_row(const DuneShape& shape, int n, const CellRow& rows, float* __restrict thickness) {
    const float* __restrict supply = node_of(rows, NodeField::supply);
    const float* __restrict ds = node_of(rows, NodeField::dune_sin);
    const float* __restrict dc = node_of(rows, NodeField::dune_cos);
    const float* __restrict ms = k_mega ? node_of(rows, NodeField::mega_sin) : ds;
    const float* __restrict mc = k_mega ? node_of(rows, NodeField::mega_cos) : dc;
    const float* __restrict dune_a = mid_of(rows, MidField::dune);
    const float* __restrict mega_a = mid_of(rows, MidField::mega);
    const float* __restrict small_a = mid_of(rows, MidField::small);
    const float* __restrict ss = mid_of(rows, MidField::small_sin);
    const float* __restrict sc = mid_of(rows, MidField::small_cos);
    const float* __restrict fine = mid_of(rows, MidField::fine);
    const float* __restrict sand = mid_of(rows, MidField::sand);
    const float* __restrict factor = mid_of(rows, MidField::sand_factor);
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x)
        thickness[x] = shape.thickness<k_mega>(supply[x], dune_a[x], mega_a[x], small_a[x], ds[x], dc[x], ms[x], mc[x],
                                               ss[x], sc[x], fine[x], sand[x], factor[x]);
}

SAHEL_ROW void cell_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const CellRow& rows) {
    const float* __restrict large = node_of(rows, NodeField::height);
    const float* __restrict middle = mid_of(rows, MidField::height);
    const float* __restrict slope = mid_of(rows, MidField::slope);
    float* __restrict h = rows.scratch[0];
    float* __restrict lake = rows.scratch[2];
    float* __restrict table = rows.scratch[3];
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) h[x] = large[x] + middle[x];
    rock_row<2, 6>(t, row, n, spacing_m, mid_of(rows, MidField::rough), rows.scratch[1], h);
    if (rows.has_canyon) {
        const float* __restrict shift = node_of(rows, NodeField::strata);
        const float* __restrict weight = mid_of(rows, MidField::strata);
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) h[x] += weight[x] * strata_step(h[x], shift[x]);
    }
    const float datum = t.p.sea != 0 ? 0.0f : -1e6f;
    if (rows.has_lake) {
        const float* __restrict radii = node_of(rows, NodeField::lake);
        const float* __restrict level = node_of(rows, NodeField::lake_level);
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) {
            lake[x] = radii[x];
            h[x] = lake_bank(h[x], radii[x], level[x]);
            table[x] = radii[x] < k_lake_end ? level[x] : datum;
        }
    } else {
        fill_row(n, k_no_lake, lake);
        fill_row(n, datum, table);
    }
    float* __restrict thickness = rows.scratch[1];
    if (rows.has_dune) {
        const float dune_m = t.p.dune_m, mega_m = t.p.mega_dune_m;
        const DuneShape shape{dune_m, mega_m, band_weight(dune_m * k_dune_wavelength * 0.5f, spacing_m),
                              band_weight(mega_m * k_mega_wavelength * 0.5f, spacing_m)};
        if (mega_m > 0.0f)
            sand_row<true>(shape, n, rows, thickness);
        else
            sand_row<false>(shape, n, rows, thickness);
    } else {
        fill_row(n, 0.0f, thickness);
    }
    const float* __restrict bed = mid_of(rows, MidField::bed);
    const float* __restrict noise = mid_of(rows, MidField::noise);
    if (rows.has_stream) {
        const float* __restrict side = node_of(rows, NodeField::stream);
        const float* __restrict half = node_of(rows, NodeField::stream_half);
        const float* __restrict level = node_of(rows, NodeField::stream_level);
        float* __restrict loose = rows.scratch[4];
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) {
            float height = h[x], water_table = table[x], dune_sand = thickness[x], sand = bed[x];
            stream_bed(side[x], half[x], level[x], lake[x], spacing_m, noise[x], height, water_table, dune_sand, sand);
            h[x] = height;
            table[x] = water_table;
            thickness[x] = dune_sand;
            loose[x] = sand;
        }
    }

    const bool sea = t.p.sea != 0;
    const LayerShape shape{sea ? 2.2f * (1.0f - 0.92f * t.p.wetland) : 0.0f, sea ? 0.0f : 0.8f, sea ? 1.0f : 0.0f,
                           sea ? 1.0f : 2.2f};
    const float* __restrict soil = mid_of(rows, MidField::soil);
    const float* __restrict loose = rows.has_stream ? rows.scratch[4] : bed;
    float* __restrict rock = rows.rock;
    float* __restrict soil_out = rows.soil;
    float* __restrict sand_out = rows.sand;
    float* __restrict water = rows.water;
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) {
        const SurfaceLayers l =
            shape.split(h[x], slope[x], table[x], lake[x], soil[x], loose[x], noise[x], thickness[x]);
        rock[x] = l.rock;
        soil_out[x] = l.soil;
        sand_out[x] = l.sand;
        water[x] = l.water;
    }
}

SAHEL_ROW void ticks_row(const float* metres, float stretch, int n, int32_t* ticks) {
    const float* __restrict from = metres;
    int32_t* __restrict to = ticks;
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) to[x] = ticks_of_metres(from[x] * stretch);
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
