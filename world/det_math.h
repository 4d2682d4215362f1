#pragma once

#include "world/macros.h"

#include <cstdint>

/// Deterministic mathematics: the same bits on every processor, compiler and instruction set, CPU or CUDA. Passes that
/// carry state take exp, log, pow, sin, cos and atan2 from here, never from <cmath>, whose results differ from library
/// to library.
///
/// Only +, -, *, / and sqrt of IEEE binary32 (all correctly rounded, contraction off, denormals kept, round to
/// nearest), comparisons with selection, and operations on the bits. No branch, no table, no double: g++ -O3
/// -fno-trapping-math turns a loop over any of them into packed instructions. What is not a number becomes the one
/// quiet NaN 0x7FC00000, because processors differ in the sign and payload of the NaN they make.
///
/// Largest error in units of the last place of the result, against double precision, over all 2^32 arguments (pow and
/// atan2: over 4e8 pairs of every size); tests/world/det_math_test.cpp holds them to it:
///
///     exp   0.99     exp2  1.05     sin, cos  0.83 for |x| <= 8192     atan   1.62     sqrt, floor  exact rounding
///     log   0.86     log2  0.91     pow       1.25                     atan2  1.85
///
/// Special values are those of C99 Annex F, apart from exceptions flags. Methods: argument reduction after Cody and
/// Waite (Software Manual for the Elementary Functions, 1980); log through atanh and the split logarithm of pow as in
/// fdlibm (Sun Microsystems, 1993); minimax polynomials found by Remez exchange, weighted for relative error.
namespace sahel::det {

SAHEL_HD constexpr uint32_t bits_of(float x) {
    return __builtin_bit_cast(uint32_t, x);
}
SAHEL_HD constexpr float float_of(uint32_t bits) {
    return __builtin_bit_cast(float, bits);
}

inline constexpr float k_nan = __builtin_bit_cast(float, 0x7FC00000u);
inline constexpr float k_inf = __builtin_bit_cast(float, 0x7F800000u);
inline constexpr float k_pi = 0x1.921fb6p+1f;

/// condition ? a : b, of values already computed. Written on the bits, because g++ otherwise sinks a long computation
/// into the branch that needs it and then cannot vectorise the loop.
SAHEL_HD float pick(bool condition, float a, float b) {
    const uint32_t mask = 0u - static_cast<uint32_t>(condition);
    return float_of((bits_of(a) & mask) | (bits_of(b) & ~mask));
}

/// Smaller and larger of two; the second if either is not a number. (fminf differs between machines.)
SAHEL_HD float min(float a, float b) {
    return a < b ? a : b;
}
SAHEL_HD float max(float a, float b) {
    return a > b ? a : b;
}
/// x within [low, high]; not-a-number stays.
SAHEL_HD float clamp(float x, float low, float high) {
    return x < low ? low : (x > high ? high : x);
}
SAHEL_HD float abs(float x) {
    return float_of(bits_of(x) & 0x7FFFFFFFu);
}
/// |magnitude| with the sign bit of `sign`.
SAHEL_HD float copysign(float magnitude, float sign) {
    return float_of((bits_of(magnitude) & 0x7FFFFFFFu) | (bits_of(sign) & 0x80000000u));
}
/// Correctly rounded.
SAHEL_HD float sqrt(float x) {
#if defined(__CUDA_ARCH__)
    const float root = __fsqrt_rn(x);
#else
    const float root = __builtin_sqrtf(x);
#endif
    return pick(root != root, k_nan, root);
}
/// Largest whole number not above x. Exact.
SAHEL_HD float floor(float x) {
    const float magnitude = abs(x);
    const bool small = magnitude < 0x1p23f; // else x is whole, infinite or not a number
    const float whole = static_cast<float>(static_cast<int32_t>(pick(small, x, 0.0f)));
    const float down = pick(whole > x, whole - 1.0f, whole);
    return pick(small, copysign(down, x), pick(x != x, k_nan, x));
}

namespace detail {

constexpr float k_round = 0x1.8p23f; // x + k_round has the nearest whole number of x (|x| < 2^22) in its low bits

/// Nearest whole number, ties to even, of |x| < 2^22; `n` is the same as an integer.
SAHEL_HD float nearest(float x, int32_t& n) {
    const float shifted = x + k_round;
    n = static_cast<int32_t>(bits_of(shifted) - bits_of(k_round));
    return shifted - k_round;
}
/// x with 12 significant bits: the product of two such is exact.
SAHEL_HD float head(float x) {
    return float_of(bits_of(x) & 0xFFFFF000u);
}
/// p * 2^n for -150 <= n <= 129 and p around 1, rounded once. (Two steps: 2^n itself may not be a normal number.)
SAHEL_HD float scale(float p, int32_t n) {
    const int32_t half = n >> 1;
    const float a = float_of(static_cast<uint32_t>(half + 127) << 23);
    const float b = float_of(static_cast<uint32_t>(n - half + 127) << 23);
    return p * a * b;
}
/// 2^r for |r| <= 0.5.
SAHEL_HD float exp2_core(float r) {
    constexpr float k_ln2_hi = 0x1.62e43p-1f;
    constexpr float k_ln2_lo = -0x1.05c61p-29f;
    float q = 0x1.fe7b0ap-17f;
    q = q * r + 0x1.4455bcp-13f;
    q = q * r + 0x1.5d89c2p-10f;
    q = q * r + 0x1.3b29fep-7f;
    q = q * r + 0x1.c6b08cp-5f;
    q = q * r + 0x1.ebfbep-3f;
    return 1.0f + (k_ln2_hi * r + (k_ln2_lo * r + r * r * q));
}

/// A positive, finite, normal or denormal x as m * 2^k with m in [sqrt(1/2), sqrt(2)).
struct Split {
    float m;
    float k;
};
SAHEL_HD Split split(float x) {
    constexpr uint32_t k_sqrt_half = 0x3F3504F3u;
    const bool denormal = x < 0x1p-126f;
    const uint32_t bits = bits_of(pick(denormal, x * 0x1p24f, x)) + (0x3F800000u - k_sqrt_half);
    const int32_t k = static_cast<int32_t>(bits >> 23) - 127 - 24 * static_cast<int32_t>(denormal);
    return {float_of((bits & 0x007FFFFFu) + k_sqrt_half), static_cast<float>(k)};
}
/// log(1 + f) - (f - f*f/2), for 1 + f in [sqrt(1/2), sqrt(2)): with s = f / (2 + f), log(1 + f) = 2 atanh(s).
SAHEL_HD float log_tail(float f, float half_square) {
    const float s = f / (2.0f + f);
    const float z = s * s;
    const float r = z * (0x1.55555p-1f + z * (0x1.999a7cp-2f + z * (0x1.2438a8p-2f + z * 0x1.e2fdd2p-3f)));
    return s * (half_square + r);
}
/// The special values of a logarithm: 0, negative, infinite, not a number.
SAHEL_HD float log_special(float x, float result) {
    result = pick(x == k_inf, k_inf, result);
    result = pick(x == 0.0f, -k_inf, result);
    return pick(x >= 0.0f, result, k_nan);
}

} // namespace detail

SAHEL_HD float exp(float x) {
    constexpr float k_log2e = 0x1.715476p+0f;
    constexpr float k_ln2_hi = 0x1.62e4p-1f; // 15 bits: n * k_ln2_hi is exact
    constexpr float k_ln2_lo = 0x1.7f7d1cp-20f;
    const float inside = clamp(x, -104.0f, 89.0f); // beyond: 0 and infinity
    int32_t n = 0;
    const float whole = detail::nearest(inside * k_log2e, n);
    const float r = (inside - whole * k_ln2_hi) - whole * k_ln2_lo;
    float q = 0x1.6a2352p-10f;
    q = q * r + 0x1.123a6cp-7f;
    q = q * r + 0x1.5558f4p-5f;
    q = q * r + 0x1.55549p-3f;
    q = q * r + 0x1.fffffcp-2f;
    const float result = detail::scale(1.0f + (r + r * r * q), n);
    return pick(x != x, k_nan, result);
}

SAHEL_HD float exp2(float x) {
    const float inside = clamp(x, -151.0f, 129.0f);
    int32_t n = 0;
    const float whole = detail::nearest(inside, n);
    const float result = detail::scale(detail::exp2_core(inside - whole), n);
    return pick(x != x, k_nan, result);
}

SAHEL_HD float log(float x) {
    constexpr float k_ln2_hi = 0x1.62e4p-1f;
    constexpr float k_ln2_lo = 0x1.7f7d1cp-20f;
    const detail::Split p = detail::split(x);
    const float f = p.m - 1.0f;
    const float half_square = 0.5f * f * f;
    const float tail = detail::log_tail(f, half_square) + p.k * k_ln2_lo;
    return detail::log_special(x, ((tail - half_square) + f) + p.k * k_ln2_hi);
}

SAHEL_HD float log2(float x) {
    constexpr float k_log2e_hi = 0x1.714p+0f; // 11 bits
    constexpr float k_log2e_lo = 0x1.47652cp-12f;
    const detail::Split p = detail::split(x);
    const float f = p.m - 1.0f;
    const float half_square = 0.5f * f * f;
    const float hi = detail::head(f - half_square);
    const float lo = ((f - hi) - half_square) + detail::log_tail(f, half_square);
    const float tail = (lo + hi) * k_log2e_lo + lo * k_log2e_hi;
    return detail::log_special(x, (tail + hi * k_log2e_hi) + p.k);
}

/// x to the power y; x < 0 with a whole y is meant, with any other y not a number. pow(x, 0) = pow(1, y) = 1 for any x,
/// y.
SAHEL_HD float pow(float x, float y) {
    using detail::head;
    // log2 |x| as t1 + t2, good to about 2^-35 of itself; t1 has 12 bits.
    constexpr float k_c = 0x1.ec709ep-1f; // 2 / (3 ln 2)
    constexpr float k_c_hi = 0x1.ec6p-1f;
    constexpr float k_c_lo = 0x1.09dc3ap-13f;
    const float ax = abs(x);
    const detail::Split p = detail::split(ax);
    const float f = p.m - 1.0f;
    const float d = p.m + 1.0f;
    const float inverse = 1.0f / d;
    const float s = f * inverse;
    const float s_hi = head(s);
    const float d_hi = head(d);
    const float d_lo = p.m - (d_hi - 1.0f);
    const float s_lo = ((f - s_hi * d_hi) - s_hi * d_lo) * inverse;
    // 3 atanh(s) = s (3 + s^2 + s^4 R(s^2))
    const float z = s * s;
    const float big_r = 0x1.333332p-1f + z * (0x1.b6dd3p-2f + z * (0x1.54c2bap-2f + z * 0x1.2b0be6p-2f));
    const float r = z * z * big_r + s_lo * (s_hi + s);
    const float square = s_hi * s_hi;
    const float w_hi = head(3.0f + square + r);
    const float w_lo = r - ((w_hi - 3.0f) - square);
    const float u = s_hi * w_hi;
    const float v = s_lo * w_hi + w_lo * s;
    const float a_hi = head(u + v);
    const float a_lo = v - (a_hi - u);
    const float b_hi = k_c_hi * a_hi;
    const float b_lo = k_c_lo * a_hi + a_lo * k_c;
    const float t1 = head((b_hi + b_lo) + p.k);
    const float t2 = b_lo - ((t1 - p.k) - b_hi);

    // y log2 |x| as e_hi + e_lo. Beyond 2^40 every |x| but 1 gives 0 or infinity anyway.
    const float yc = clamp(y, -0x1p40f, 0x1p40f);
    const float y_hi = head(yc);
    const float e_lo = (yc - y_hi) * t1 + yc * t2;
    const float e_hi = y_hi * t1;
    const float e = e_hi + e_lo;
    int32_t n = 0;
    const float whole = detail::nearest(clamp(e, -151.0f, 128.0f), n);
    const float power = detail::scale(detail::exp2_core((e_hi - whole) + e_lo), n);
    float result = pick(e > 128.0f, k_inf, pick(e < -150.0f, 0.0f, power));

    result = pick(ax == 0.0f, pick(y > 0.0f, 0.0f, k_inf), result);
    result = pick(ax == k_inf, pick(y > 0.0f, k_inf, 0.0f), result);
    // The sign, of a negative x: y is odd, even, or not whole.
    const float ay = abs(y);
    const float countable = pick(ay < 0x1p24f, ay, 0.0f); // from 2^24 on every float is an even whole number
    const int32_t whole_y = static_cast<int32_t>(countable);
    const bool is_whole = static_cast<float>(whole_y) == countable;
    const uint32_t negative = bits_of(x) & 0x80000000u;
    const uint32_t odd = (static_cast<uint32_t>(whole_y) << 31) & (0u - static_cast<uint32_t>(is_whole));
    result = float_of(bits_of(result) | (negative & odd));
    result = pick(!is_whole & (x < 0.0f) & (ax != k_inf), k_nan, result);
    result = pick((x != x) | (y != y), k_nan, result);
    return pick((y == 0.0f) | (x == 1.0f), 1.0f, result);
}

struct SinCos {
    float sin;
    float cos;
};

/// For |x| <= k_trig_accurate both are as good as said above. From there to k_trig_max the absolute error grows to
/// about |x| * 2^-23 (what a change of x in its last place does anyway); beyond it x counts as 0. Infinity: not a
/// number.
inline constexpr float k_trig_accurate = 8192.0f;
inline constexpr float k_trig_max = 0x1p21f;

SAHEL_HD SinCos sincos(float x) {
    const float ax = abs(x);
    const float inside = pick(ax <= k_trig_max, ax, 0.0f);
    int32_t n = 0;
    const float whole = detail::nearest(inside * 0x1.45f306p-1f, n);
    // pi / 2 in parts of 11 bits: whole * part is exact for whole < 2^13. The first two differences are exact; what the
    // next two round off goes to the tail, so that r + r_lo is the reduced angle to far below its last place.
    const float r2 = (inside - whole * 0x1.92p+0f) - whole * 0x1.fbp-12f;
    const float part3 = whole * 0x1.51p-22f;
    const float part4 = whole * 0x1.0bp-34f;
    const float r3 = r2 - part3;
    const float r = r3 - part4;
    const float r_lo = ((r2 - r3) - part3) + (((r3 - r) - part4) - whole * 0x1.184698p-44f);
    const float z = r * r;
    const float s_tail = z * (-0x1.555556p-3f + z * (0x1.111108p-7f + z * (-0x1.a00f6ap-13f + z * 0x1.6cccc8p-19f)));
    const float half = 0.5f * z;
    const float head = 1.0f - half;
    const float s = r + (r_lo * head + r * s_tail);
    const float c_tail = z * z * (0x1.55554ap-5f + z * (-0x1.6c0c1ep-10f + z * 0x1.99e538p-16f));
    const float c = head + (((1.0f - head) - half) + (c_tail - r * r_lo));
    const uint32_t quadrant = static_cast<uint32_t>(n);
    const bool swapped = (quadrant & 1u) != 0u;
    const uint32_t sin_bits = bits_of(pick(swapped, c, s)) ^ ((quadrant & 2u) << 30) ^ (bits_of(x) & 0x80000000u);
    const uint32_t cos_bits = bits_of(pick(swapped, s, c)) ^ (((quadrant + 1u) & 2u) << 30);
    const bool valid = ax < k_inf;
    return {pick(valid, float_of(sin_bits), k_nan), pick(valid, float_of(cos_bits), k_nan)};
}
SAHEL_HD float sin(float x) {
    return sincos(x).sin;
}
SAHEL_HD float cos(float x) {
    return sincos(x).cos;
}

/// Angle of the vector (x, y), -pi to pi; the sign of a zero counts.
SAHEL_HD float atan2(float y, float x) {
    const float ax = abs(x);
    const float ay = abs(y);
    const bool steep = ay > ax;
    const float large = pick(steep, ay, ax);
    const float small = pick(steep, ax, ay);
    // Both infinite is 45 degrees, both zero is 0; the largest are scaled so that their sum is finite.
    const float shrink = pick(large > 0x1p126f, 0.25f, 1.0f);
    const float a = pick(small == k_inf, 1.0f, pick(large == k_inf, 0.0f, small * shrink));
    const float b = pick((large == k_inf) | (large == 0.0f), 1.0f, large * shrink);
    // atan(a / b) = pi/4 + atan((a - b) / (a + b)), used from 1/2 on, where a - b is exact
    const bool upper = a > 0.5f * b;
    const float t = pick(upper, a - b, a) / pick(upper, a + b, b);
    const float z = t * t;
    float q = 0x1.3d055cp-5f;
    q = q * z - 0x1.46f5bp-4f;
    q = q * z + 0x1.c02036p-4f;
    q = q * z - 0x1.244a8ep-3f;
    q = q * z + 0x1.9996eap-3f;
    q = q * z - 0x1.555552p-2f;
    const float r = t + t * z * q;
    // The angle is eighths * pi/4 plus or minus r.
    constexpr float k_eighth_hi = 0x1.921fbp-1f; // 21 bits: times 1 to 4 is exact
    constexpr float k_eighth_lo = 0x1.5110b4p-23f;
    const bool left = (bits_of(x) >> 31) != 0u;
    const float first = pick(upper, 1.0f, 0.0f);
    const float quarter = pick(steep, 2.0f - first, first);
    const float eighths = pick(left, 4.0f - quarter, quarter);
    const float rest = pick(steep != left, -r, r);
    const float angle = eighths * k_eighth_hi + (rest + eighths * k_eighth_lo);
    return pick((x != x) | (y != y), k_nan, copysign(angle, y));
}
SAHEL_HD float atan(float x) {
    return atan2(x, 1.0f);
}

// A double would lose its precision unseen.
void exp(double) = delete;
void exp2(double) = delete;
void log(double) = delete;
void log2(double) = delete;
void sin(double) = delete;
void cos(double) = delete;
void sincos(double) = delete;
void atan(double) = delete;
void sqrt(double) = delete;
void floor(double) = delete;
void pow(double, double) = delete;
void atan2(double, double) = delete;

} // namespace sahel::det
