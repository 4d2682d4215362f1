#include "world/noise.h"

#include "world/check.h"

#include <cmath>

namespace sahel {

Lattice make_lattice(int32_t a, int32_t b, int32_t m, uint32_t salt) {
    SAHEL_CHECK_LE(4, m);
    SAHEL_CHECK_LE(m, 24); // fractions are exact floats
    Lattice lattice;
    lattice.a = a;
    lattice.b = b;
    lattice.m = m;
    lattice.salt = salt;
    const float length = std::sqrt(static_cast<float>(a * a + b * b)); // correctly rounded: the same on every machine
    lattice.size_m = static_cast<float>(int64_t{1} << m) / (2.0f * length);
    lattice.off_u = static_cast<int64_t>(lowbias32(salt) >> 29) << (m - 3);
    lattice.off_v = static_cast<int64_t>((lowbias32(salt) >> 26) & 7u) << (m - 3);
    return lattice;
}

Lattice make_lattice(uint64_t seed, uint32_t id, float wanted_m) {
    constexpr int32_t k_rotations[10][2] = {{4, 3}, {12, 5}, {7, 4}, {5, 2},  {8, 1},
                                            {9, 7}, {11, 3}, {7, 6}, {13, 8}, {6, 1}};
    const int32_t a = k_rotations[id % 10][0];
    const int32_t b = (id / 10) % 2 == 0 ? k_rotations[id % 10][1] : -k_rotations[id % 10][1];
    // m = round(log2(2 wanted length)), by comparing with powers of two times sqrt(2): no libm, no machine's rounding.
    const double target = 2.0 * static_cast<double>(wanted_m) * std::sqrt(static_cast<double>(a * a + b * b));
    int32_t m = 4;
    while (m < 24 && target > static_cast<double>(int64_t{1} << m) * 1.4142135623730951) ++m;
    return make_lattice(a, b, m, noise_salt(seed, id));
}

} // namespace sahel
