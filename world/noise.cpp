#include "world/noise.h"

#include "world/check.h"

#include <array>
#include <cmath>
#include <numeric>

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
    // Of all rotations whose lattice comes out within 3 % of the wanted size one is taken by the number, so that
    // octaves of near sizes are turned against each other. Only products and comparisons of doubles: the same
    // everywhere.
    constexpr int32_t k_largest = 16;
    constexpr double k_near = 1.03;
    struct Choice {
        int32_t a, b, m;
    };
    std::array<Choice, k_largest * k_largest> choices{};
    uint32_t count = 0;
    const double wanted = static_cast<double>(wanted_m);
    for (int32_t a = 3; a <= k_largest; ++a)
        for (int32_t b = 1; b < a; ++b) {
            const bool turned = 8 * b >= a && 10 * b <= 9 * a; // not along the axes or the diagonals
            if (!turned || std::gcd(a, b) != 1) continue;
            for (int32_t m = 4; m <= 24; ++m) {
                // size^2 = 4^m / (4 (a^2 + b^2))
                const double square =
                    static_cast<double>(int64_t{1} << (2 * m - 2)) / static_cast<double>(a * a + b * b);
                if (square <= wanted * wanted * (k_near * k_near) && square * (k_near * k_near) >= wanted * wanted)
                    choices[count++] = {a, b, m};
            }
        }
    SAHEL_CHECK_LT(0u, count); // sizes from 1 m to 500 km
    const Choice& c = choices[(id * 7u) % count];
    return make_lattice(c.a, (id / 10) % 2 == 0 ? c.b : -c.b, c.m, noise_salt(seed, id));
}

} // namespace sahel
