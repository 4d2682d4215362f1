#pragma once

#include "world/terrain_node_rows.h"
#include "world/terrain_rows.h"
#include "world/terrain_shapes.h"

/// Lakes and streams at the nodes of the base terrain, see terrain_rows.h: after the base, before the details.
namespace sahel::SAHEL_ISA_NAMESPACE {

SAHEL_ROW void lake_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m, const LakeSite* sites,
                        int site_count, const BaseRow& out) {
    float* __restrict lake = field_of(out, NodeField::lake);
    float* __restrict level = field_of(out, NodeField::lake_level);
    float* __restrict h = out.height;
    fill_row(n, k_no_lake, lake);
    fill_row(n, 0.0f, level);
    float* __restrict coarse = out.scratch[0];
    float* __restrict fine = out.scratch[1];
    float* __restrict coves = out.scratch[2];
    bool ready = false;
    for (int i = 0; i < site_count; ++i) {
        const LakeSite site = sites[i];
        const float dy = static_cast<float>(row.y - site.y_half_m) * 0.5f;
        if (abs1(dy) >= site.radius_m * k_no_lake) continue;
        if (!ready) {
            noise_row(t.lake_shape[0], row, n, spacing_m, coarse);
            noise_row(t.lake_shape[1], row, n, spacing_m, fine);
            noise_row(t.lake_shape[2], row, n, spacing_m, coves);
            ready = true;
        }
        const float x0 = static_cast<float>(row.x0 - site.x_half_m) * 0.5f;
        const float step = static_cast<float>(row.step) * 0.5f;
        const float sea_level = t.p.sea != 0 ? 0.0f : -1e9f;
        SAHEL_VECTORIZE
        for (int x = 0; x < n; ++x) {
            float height = h[x], r = lake[x], z = level[x];
            lake_shape(site, x0 + step * static_cast<float>(x), dy, coarse[x], fine[x], coves[x], height, r, z);
            h[x] = height;
            lake[x] = r;
            level[x] = max2(z, sea_level);
        }
    }
    if (!ready) return;
    float* __restrict wetness = field_of(out, NodeField::wetness);
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x)
        wetness[x] = watered(wetness[x], lake_waters(lake[x], coarse[x], fine[x]), 0.5f * coarse[x] + fine[x]);
}

SAHEL_ROW void stream_row(const TerrainTables& t, const SampleRow& row, int n, float spacing_m,
                          const StreamPiece* pieces, int piece_count, const BaseRow& out) {
    float* __restrict side = field_of(out, NodeField::stream);
    float* __restrict half = field_of(out, NodeField::stream_half);
    float* __restrict level = field_of(out, NodeField::stream_level);
    float* __restrict distance = out.scratch[0];
    fill_row(n, k_stream_reach_m, side);
    fill_row(n, 0.0f, half);
    fill_row(n, 0.0f, level);
    bool any = false;
    const float step = static_cast<float>(row.step) * 0.5f;
    for (int i = 0; i < piece_count; ++i) {
        const StreamPiece piece = pieces[i];
        const float x0 = static_cast<float>(row.x0 - piece.x_half_m) * 0.5f;
        const float dy = static_cast<float>(row.y - piece.y_half_m) * 0.5f;
        if (dy > max2(piece.dy_m, 0.0f) + k_stream_reach_m || dy < min2(piece.dy_m, 0.0f) - k_stream_reach_m) continue;
        // Samples within reach, and at most one more on each side.
        const float first = floor1((min2(piece.dx_m, 0.0f) - k_stream_reach_m - x0) / step);
        const float last = floor1((max2(piece.dx_m, 0.0f) + k_stream_reach_m - x0) / step) + 2.0f;
        const auto count = static_cast<float>(n);
        const int begin = static_cast<int>(min2(max2(first, 0.0f), count));
        const int end = static_cast<int>(min2(max2(last, 0.0f), count));
        if (begin >= end) continue;
        if (!any) fill_row(n, k_stream_reach_m, distance);
        any = true;
        SAHEL_VECTORIZE
        for (int x = begin; x < end; ++x) {
            StreamNear near{distance[x], side[x], half[x], level[x]};
            stream_piece(piece, x0 + step * static_cast<float>(x), dy, near);
            distance[x] = near.distance_m;
            side[x] = near.side_m;
            half[x] = near.half_m;
            level[x] = near.level_m;
        }
    }
    if (!any) return;
    float* __restrict h = out.height;
    float* __restrict lake = field_of(out, NodeField::lake);
    float* __restrict wetness = field_of(out, NodeField::wetness);
    float* __restrict patches = out.scratch[1];
    noise_row(t.lake_shape[1], row, n, spacing_m, patches);
    const float seen = stream_seen(spacing_m);
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) {
        const float d = distance[x];
        h[x] = stream_valley(h[x], d, half[x], level[x], lake[x], seen);
        lake[x] = min2(lake[x], stream_hold(d, half[x]));
        wetness[x] = watered(wetness[x], stream_waters(d, half[x], patches[x]) * seen, 1.3f * patches[x]);
        half[x] = stream_width(half[x], d) * seen;
    }
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
