#pragma once

#include "world/terrain_rows.h"

/// Uniform cubic B-spline from a coarse lattice to a finer one.
namespace sahel {

SAHEL_HD void spline_weights(float f, float out[4]) {
    out[0] = (1.0f - f) * (1.0f - f) * (1.0f - f) / 6.0f;
    out[1] = (3.0f * f * f * f - 6.0f * f * f + 4.0f) / 6.0f;
    out[2] = (-3.0f * f * f * f + 3.0f * f * f + 3.0f * f + 1.0f) / 6.0f;
    out[3] = f * f * f / 6.0f;
}
SAHEL_HD float spline_mix(const float weights[4], float a, float b, float c, float d) {
    return weights[0] * a + weights[1] * b + weights[2] * c + weights[3] * d;
}
SAHEL_HD float spline_value(float f, float a0, float a1, float a2, float a3) {
    const float k0 = (a0 + 4.0f * a1 + a2) * (1.0f / 6.0f);
    const float k1 = (a2 - a0) * 0.5f;
    const float k2 = (a0 - 2.0f * a1 + a2) * 0.5f;
    const float k3 = (a3 - a0 + 3.0f * (a1 - a2)) * (1.0f / 6.0f);
    return k0 + f * (k1 + f * (k2 + f * k3));
}
/// Coefficient whose spline passes close by the values (quasi-interpolation, exact for cubics).
SAHEL_HD float sharpened(float left, float above, float here, float below, float right) {
    return here - ((left - 2.0f * here + right) + (above - 2.0f * here + below)) * (1.0f / 6.0f);
}

namespace SAHEL_ISA_NAMESPACE {

template <int k_per_interval>
SAHEL_ROW void spline_expand(const float* __restrict v, int count, float offset, float* __restrict out) {
    constexpr float k_step = 1.0f / static_cast<float>(k_per_interval);
    const auto f = [&](int e) { return (static_cast<float>(e) + offset) * k_step; };
    if constexpr (k_per_interval >= 8) {
        for (int i = 0; i < count; ++i) {
            float* __restrict to = out + i * k_per_interval;
            const float a0 = v[i], a1 = v[i + 1], a2 = v[i + 2], a3 = v[i + 3];
            SAHEL_VECTORIZE
            for (int e = 0; e < k_per_interval; ++e) to[e] = spline_value(f(e), a0, a1, a2, a3);
        }
    } else if constexpr (k_per_interval == 4) { // few samples each: vectors run over intervals
        const float f0 = f(0), f1 = f(1), f2 = f(2), f3 = f(3);
        SAHEL_VECTORIZE
        for (int i = 0; i < count; ++i) {
            const float a0 = v[i], a1 = v[i + 1], a2 = v[i + 2], a3 = v[i + 3];
            out[4 * i] = spline_value(f0, a0, a1, a2, a3);
            out[4 * i + 1] = spline_value(f1, a0, a1, a2, a3);
            out[4 * i + 2] = spline_value(f2, a0, a1, a2, a3);
            out[4 * i + 3] = spline_value(f3, a0, a1, a2, a3);
        }
    } else {
        const float f0 = f(0), f1 = f(1);
        SAHEL_VECTORIZE
        for (int i = 0; i < count; ++i) {
            const float a0 = v[i], a1 = v[i + 1], a2 = v[i + 2], a3 = v[i + 3];
            out[2 * i] = spline_value(f0, a0, a1, a2, a3);
            out[2 * i + 1] = spline_value(f1, a0, a1, a2, a3);
        }
    }
}

SAHEL_ROW void spline_row(const float* const rows[4], const float weights[4], int count, int per_interval, float offset,
                          float* mixed, float* out) {
    const float* __restrict r0 = rows[0];
    const float* __restrict r1 = rows[1];
    const float* __restrict r2 = rows[2];
    const float* __restrict r3 = rows[3];
    const float w[4] = {weights[0], weights[1], weights[2], weights[3]};
    float* __restrict v = mixed;
    SAHEL_VECTORIZE
    for (int x = 0; x < count + 3; ++x) v[x] = spline_mix(w, r0[x], r1[x], r2[x], r3[x]);
    if (per_interval == 16)
        spline_expand<16>(v, count, offset, out);
    else if (per_interval == 8)
        spline_expand<8>(v, count, offset, out);
    else if (per_interval == 4)
        spline_expand<4>(v, count, offset, out);
    else
        spline_expand<2>(v, count, offset, out);
}

SAHEL_ROW void sharpen_row(const float* above, const float* here, const float* below, int n, float* out) {
    const float* __restrict a = above;
    const float* __restrict h = here;
    const float* __restrict b = below;
    float* __restrict to = out;
    SAHEL_VECTORIZE
    for (int x = 0; x < n; ++x) to[x] = sharpened(h[x - 1], a[x], h[x], b[x], h[x + 1]);
}

} // namespace SAHEL_ISA_NAMESPACE
} // namespace sahel
