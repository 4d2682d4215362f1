#pragma once

#include "world/macros.h"

#include <cstdint>

/// Lattice noise for the base terrain: hashes, gradient noise with its analytic derivative, and phasors.
///
/// Coordinates are integers in half metres, so that a place 8 million kilometres away is as exact as the origin. Every
/// octave has its own rotated integer lattice (a, b, m): u = a X + b Y + off_u, v = -b X + a Y + off_v, node u >> m.
/// The fractions are exact floats for m <= 24. Only + - * / sqrt and floor are used, in the order written, so that
/// every compiler, instruction set and CUDA give the same bits.
///
/// Gradient noise with analytic derivatives after Quilez; phasors with a free profile after Tricard et al., "Procedural
/// Phasor Noise", TOG 38(4), 2019; the integer finaliser is lowbias32 of Wellons' hash-prospector.
namespace sahel {

SAHEL_HD uint32_t lowbias32(uint32_t x) {
    x ^= x >> 16;
    x *= 0x7FEB352Du;
    x ^= x >> 15;
    x *= 0x846CA68Bu;
    x ^= x >> 16;
    return x;
}
/// Salt of the lattice or purpose number `id` of a seed.
SAHEL_HD uint32_t noise_salt(uint64_t seed, uint32_t id) {
    return lowbias32(static_cast<uint32_t>(seed) ^
                     lowbias32(static_cast<uint32_t>(seed >> 32) + 0x9E3779B9u * (id + 1u)));
}
/// A column of nodes, shared by the two rows of a lattice cell, then the node itself.
SAHEL_HD uint32_t column_hash(uint32_t i, uint32_t salt) {
    return lowbias32(i + salt);
}
SAHEL_HD uint32_t node_hash(uint32_t column, uint32_t j) {
    return lowbias32(column + j * 0x9E3779B1u);
}

SAHEL_HD float min2(float a, float b) {
    return b < a ? b : a;
}
SAHEL_HD float max2(float a, float b) {
    return a < b ? b : a;
}
SAHEL_HD float clamp01(float x) {
    return min2(max2(x, 0.0f), 1.0f);
}
SAHEL_HD float mix1(float a, float b, float t) {
    return a + (b - a) * t;
}
/// Smooth step from a to b; a > b gives a falling edge.
SAHEL_HD float sstep(float a, float b, float x) {
    const float t = clamp01((x - a) * (1.0f / (b - a)));
    return t * t * (3.0f - 2.0f * t);
}
SAHEL_HD float abs1(float x) {
    return __builtin_fabsf(x);
}
SAHEL_HD float floor1(float x) {
    return __builtin_floorf(x);
}
SAHEL_HD float sqrt1(float x) {
    return __builtin_sqrtf(x);
}

/// sin and cos of x turns, by a polynomial: error 0.001, enough for shapes.
SAHEL_HD float sin_turns(float x) {
    x -= floor1(x + 0.5f);
    const float y = x * (8.0f - 16.0f * abs1(x));
    return y * (0.775f + 0.225f * abs1(y));
}
SAHEL_HD float cos_turns(float x) {
    return sin_turns(x + 0.25f);
}
/// Angle of (x, y) in turns, (-0.5, 0.5].
SAHEL_HD float atan2_turns(float y, float x) {
    const float ax = abs1(x);
    const float ay = abs1(y);
    const float r = min2(ax, ay) / (max2(ax, ay) + 1e-20f);
    const float s = r * r;
    float p = r * (0.15914526f + s * (-0.05254415f + s * (0.02985776f + s * (-0.01455583f + s * 0.00310033f))));
    p = ay > ax ? 0.25f - p : p;
    p = x < 0.0f ? 0.5f - p : p;
    return y < 0.0f ? -p : p;
}

/// Weight of an octave of size `size_m` at sample spacing `spacing_m`: the regression of the box mean on the centre
/// sample. 0 means that the octave cannot be seen and is skipped.
SAHEL_HD float band_weight(float size_m, float spacing_m) {
    const float r = size_m / spacing_m;
    return r >= 1.5f ? 1.0f - 0.62f / (r * r) : clamp01((r - 0.42f) * 0.67f);
}

/// A rotated integer lattice.
struct Lattice {
    int32_t a = 4;
    int32_t b = 3;
    int32_t m = 16; ///< one lattice cell is 2^m units
    uint32_t salt = 0;
    float size_m = 0.0f; ///< side of a lattice cell, m
    int64_t off_u = 0;   ///< eighth-cell shifts, so that the nodes of different lattices do not meet at the origin
    int64_t off_v = 0;
};

/// A row of samples: sample i is at half-metre coordinates (x0 + i step, y).
struct SampleRow {
    int64_t x0 = 0;
    int64_t y = 0;
    int64_t step = 2;
    int32_t zero_bits = 0; ///< x0, y and step are multiples of 2^zero_bits
};

/// Where a row starts in a lattice. Remainders advance in int32: rows up to 2048 samples at any level.
struct LatticeRow {
    int32_t i0, j0; ///< node of the first sample
    int32_t u0, v0; ///< remainder in the cell, 0 .. 2^m - 1
    int32_t du, dv; ///< per sample
    int32_t m, mask;
    float inverse;        ///< 2^-m
    float warp_a, warp_b; ///< lattice fractions per metre of warp
    uint32_t salt;
};

SAHEL_HD LatticeRow lattice_row(const Lattice& lattice, const SampleRow& row) {
    // Trailing zero bits are dropped at coarse levels, so that remainders stay in 31 bits.
    int32_t shift = row.zero_bits - 8;
    shift = shift < 0 ? 0 : shift;
    shift = shift > lattice.m - 3 ? lattice.m - 3 : shift;
    const int64_t u = (lattice.a * row.x0 + lattice.b * row.y + lattice.off_u) >> shift;
    const int64_t v = (-lattice.b * row.x0 + lattice.a * row.y + lattice.off_v) >> shift;
    LatticeRow r;
    r.m = lattice.m - shift;
    r.mask = static_cast<int32_t>((int64_t{1} << r.m) - 1);
    r.i0 = static_cast<int32_t>(static_cast<uint32_t>(static_cast<uint64_t>(u >> r.m)));
    r.j0 = static_cast<int32_t>(static_cast<uint32_t>(static_cast<uint64_t>(v >> r.m)));
    r.u0 = static_cast<int32_t>(u & r.mask);
    r.v0 = static_cast<int32_t>(v & r.mask);
    r.du = static_cast<int32_t>(lattice.a * (row.step >> shift));
    r.dv = static_cast<int32_t>(-lattice.b * (row.step >> shift));
    r.inverse = 1.0f / static_cast<float>(int64_t{1} << r.m);
    const float c = 2.0f / static_cast<float>(int64_t{1} << lattice.m);
    r.warp_a = static_cast<float>(lattice.a) * c;
    r.warp_b = static_cast<float>(lattice.b) * c;
    r.salt = lattice.salt;
    return r;
}

/// A sample's place in its lattice: node (i, j) and fractions.
struct LatticePoint {
    int32_t i, j;
    float fu, fv;
};

SAHEL_HD LatticePoint lattice_point(const LatticeRow& r, int32_t index) {
    const int32_t u = r.u0 + r.du * index;
    const int32_t v = r.v0 + r.dv * index;
    return {static_cast<int32_t>(static_cast<uint32_t>(r.i0) + static_cast<uint32_t>(u >> r.m)),
            static_cast<int32_t>(static_cast<uint32_t>(r.j0) + static_cast<uint32_t>(v >> r.m)),
            static_cast<float>(u & r.mask) * r.inverse, static_cast<float>(v & r.mask) * r.inverse};
}
/// The same, displaced by a warp in metres.
SAHEL_HD LatticePoint lattice_point(const LatticeRow& r, int32_t index, float warp_x, float warp_y) {
    LatticePoint p = lattice_point(r, index);
    p.fu += r.warp_a * warp_x + r.warp_b * warp_y;
    p.fv += r.warp_a * warp_y - r.warp_b * warp_x;
    const float eu = floor1(p.fu);
    const float ev = floor1(p.fv);
    p.fu -= eu;
    p.fv -= ev;
    p.i += static_cast<int32_t>(eu);
    p.j += static_cast<int32_t>(ev);
    return p;
}

SAHEL_HD float quintic(float f) {
    return f * f * f * (f * (f * 6.0f - 15.0f) + 10.0f);
}
SAHEL_HD float quintic_slope(float f) {
    return 30.0f * f * f * (f * (f - 2.0f) + 1.0f);
}
SAHEL_HD float low_half(uint32_t h) {
    return static_cast<float>(static_cast<int32_t>(h << 16) >> 16);
}
SAHEL_HD float high_half(uint32_t h) {
    return static_cast<float>(static_cast<int32_t>(h) >> 16);
}
inline constexpr float k_noise_scale = 1.6f / 32768.0f;

/// Gradient noise, mean 0, standard deviation 0.28, range about +-1.3.
SAHEL_HD float noise_value(const LatticeRow& r, const LatticePoint& p) {
    const uint32_t c0 = column_hash(static_cast<uint32_t>(p.i), r.salt);
    const uint32_t c1 = column_hash(static_cast<uint32_t>(p.i) + 1u, r.salt);
    const auto j = static_cast<uint32_t>(p.j);
    const uint32_t h00 = node_hash(c0, j), h10 = node_hash(c1, j);
    const uint32_t h01 = node_hash(c0, j + 1u), h11 = node_hash(c1, j + 1u);
    const float fu = p.fu, fv = p.fv;
    const float va = low_half(h00) * fu + high_half(h00) * fv;
    const float vb = low_half(h10) * (fu - 1.0f) + high_half(h10) * fv;
    const float vc = low_half(h01) * fu + high_half(h01) * (fv - 1.0f);
    const float vd = low_half(h11) * (fu - 1.0f) + high_half(h11) * (fv - 1.0f);
    const float qu = quintic(fu), qv = quintic(fv);
    const float e = va + qu * (vb - va);
    const float g = vc + qu * (vd - vc);
    return (e + qv * (g - e)) * k_noise_scale;
}

struct NoiseGradient {
    float value, dx, dy; ///< derivatives per metre
};

/// Gradient noise with its derivative in world axes.
SAHEL_HD NoiseGradient noise_gradient(const LatticeRow& r, const LatticePoint& p) {
    const uint32_t c0 = column_hash(static_cast<uint32_t>(p.i), r.salt);
    const uint32_t c1 = column_hash(static_cast<uint32_t>(p.i) + 1u, r.salt);
    const auto j = static_cast<uint32_t>(p.j);
    const uint32_t h00 = node_hash(c0, j), h10 = node_hash(c1, j);
    const uint32_t h01 = node_hash(c0, j + 1u), h11 = node_hash(c1, j + 1u);
    const float fu = p.fu, fv = p.fv;
    const float ax = low_half(h00), ay = high_half(h00), bx = low_half(h10), by = high_half(h10);
    const float cx = low_half(h01), cy = high_half(h01), dx = low_half(h11), dy = high_half(h11);
    const float va = ax * fu + ay * fv, vb = bx * (fu - 1.0f) + by * fv;
    const float vc = cx * fu + cy * (fv - 1.0f), vd = dx * (fu - 1.0f) + dy * (fv - 1.0f);
    const float qu = quintic(fu), qv = quintic(fv);
    const float e = va + qu * (vb - va);
    const float g = vc + qu * (vd - vc);
    const float su = quintic_slope(fu), sv = quintic_slope(fv);
    const float gu0 = ax + qu * (bx - ax), gu1 = cx + qu * (dx - cx);
    const float gu = gu0 + qv * (gu1 - gu0) + su * ((vb - va) + qv * ((vd - vc) - (vb - va)));
    const float gv0 = ay + qu * (by - ay), gv1 = cy + qu * (dy - cy);
    const float gv = gv0 + qv * (gv1 - gv0) + sv * (g - e);
    return {(e + qv * (g - e)) * k_noise_scale, (r.warp_a * gu - r.warp_b * gv) * k_noise_scale,
            (r.warp_b * gu + r.warp_a * gv) * k_noise_scale};
}

struct Phasor {
    float c, s; ///< cosine and sine part; the length drops to 0 where stripes end or join
};

/// Stripes of the unit direction (sx, sy) of increasing phase; `scale` = 2^m / (2 (a^2 + b^2) wavelength). Each lattice
/// corner has a random phase of its own, and with `jitter` > 0 a direction turned by up to atan(jitter).
SAHEL_HD Phasor phasor_at(const LatticeRow& r, const LatticePoint& p, float a, float b, float sx, float sy, float scale,
                          float jitter) {
    const float su = (a * sx + b * sy) * scale;
    const float sv = (a * sy - b * sx) * scale;
    const uint32_t c0 = column_hash(static_cast<uint32_t>(p.i), r.salt);
    const uint32_t c1 = column_hash(static_cast<uint32_t>(p.i) + 1u, r.salt);
    const auto j = static_cast<uint32_t>(p.j);
    const uint32_t h00 = node_hash(c0, j), h10 = node_hash(c1, j);
    const uint32_t h01 = node_hash(c0, j + 1u), h11 = node_hash(c1, j + 1u);
    const float fu = p.fu, fv = p.fv;
    constexpr float q = 1.0f / 4294967296.0f;
    const float jq = jitter * (1.0f / 32768.0f);
    const auto turns = [&](uint32_t h, float u, float v) {
        const float straight = su * u + sv * v;
        return straight + low_half(h) * jq * (su * v - sv * u) + static_cast<float>(static_cast<int32_t>(h)) * q;
    };
    const float t00 = turns(h00, fu, fv), t10 = turns(h10, fu - 1.0f, fv);
    const float t01 = turns(h01, fu, fv - 1.0f), t11 = turns(h11, fu - 1.0f, fv - 1.0f);
    const float qu = quintic(fu), qv = quintic(fv);
    const float w11 = qu * qv, w10 = qu - w11, w01 = qv - w11, w00 = 1.0f - qu - w01;
    return {w00 * cos_turns(t00) + w10 * cos_turns(t10) + w01 * cos_turns(t01) + w11 * cos_turns(t11),
            w00 * sin_turns(t00) + w10 * sin_turns(t10) + w01 * sin_turns(t01) + w11 * sin_turns(t11)};
}

/// Lattice number `id` of a seed with a cell side within 3 % of `wanted_m`, 1 m to 500 km. Host only.
Lattice make_lattice(uint64_t seed, uint32_t id, float wanted_m);
/// The same with (a, b, m) given.
Lattice make_lattice(int32_t a, int32_t b, int32_t m, uint32_t salt);

} // namespace sahel
