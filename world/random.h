#pragma once

#include "world/macros.h"

#include <Random123/philox.h>

#include <cstdint>

/// Random numbers without a state: a pure function of (world seed, world cell, step, purpose), so that neither tile,
/// thread, machine nor order of calls can change them. Philox4x32 with 10 rounds (Salmon, Moraes, Dror, Shaw: Parallel
/// random numbers: as easy as 1, 2, 3, SC 2011) from Random123; host and device run the same source.
///
///     RandomStream stream(seed, step, Purpose::rain);      one Philox, once per pass
///     uint32_t u = stream.at(x, y).v[0];                   one Philox per cell: four independent words
///
/// The 128-bit counter of a cell is (x, y), whole int64 each. The 64-bit key of a stream is the first half of
/// Philox(counter = (step, purpose, index), key = seed): two streams share a key with probability 2^-64.
namespace sahel {

/// What a number is drawn for. The values are part of what a world becomes: add at the end, never reuse one.
enum class Purpose : uint32_t {
    test = 0,
    base_terrain = 1,
    seeding = 2,
    wind = 3,
    saltation = 4,
    abrasion = 5,
    reptation = 6,
    avalanche = 7,
    rain = 8,
    hydraulic_erosion = 9,
    seepage = 10,
    evaporation = 11,
    humus = 12,
    plant_spawn = 13,
    plant_growth = 14,
    plant_death = 15,
    supply = 16,
};

/// Four words of 32 uniform bits.
struct Random4 {
    uint32_t v[4];
};

/// The bare function, for the known answers and for other layouts of the counter.
SAHEL_HD Random4 philox(uint32_t c0, uint32_t c1, uint32_t c2, uint32_t c3, uint32_t k0, uint32_t k1) {
    // The C interface: its functions are static, so no kernel shares a copy with another instruction set's.
    const philox4x32_ctr_t counter = {{c0, c1, c2, c3}};
    const philox4x32_key_t key = {{k0, k1}};
    const philox4x32_ctr_t r = philox4x32_R(10, counter, key);
    return {{r.v[0], r.v[1], r.v[2], r.v[3]}};
}

struct RandomStream {
    uint32_t k0 = 0;
    uint32_t k1 = 0;

    SAHEL_HD RandomStream() {}
    /// `index` tells apart several streams of one purpose and step (sweeps, species).
    SAHEL_HD RandomStream(uint64_t seed, int64_t step, Purpose purpose, uint32_t index = 0) {
        const auto s = static_cast<uint64_t>(step);
        const Random4 key =
            philox(static_cast<uint32_t>(s), static_cast<uint32_t>(s >> 32), static_cast<uint32_t>(purpose), index,
                   static_cast<uint32_t>(seed), static_cast<uint32_t>(seed >> 32));
        k0 = key.v[0];
        k1 = key.v[1];
    }

    /// The numbers of world cell (x, y).
    SAHEL_HD Random4 at(int64_t x, int64_t y) const {
        const auto ux = static_cast<uint64_t>(x);
        const auto uy = static_cast<uint64_t>(y);
        return philox(static_cast<uint32_t>(ux), static_cast<uint32_t>(ux >> 32), static_cast<uint32_t>(uy),
                      static_cast<uint32_t>(uy >> 32), k0, k1);
    }
};

/// Uniform in [0, 1): a multiple of 2^-24.
SAHEL_HD float uniform(uint32_t bits) {
    return static_cast<float>(static_cast<int32_t>(bits >> 8)) * 0x1p-24f;
}

/// A whole number of ticks whose mean over `bits` is `ticks` (to 2^-31 of a tick), for |ticks| < 2^31: the part below
/// one tick is the probability of one tick more. For processes slower than a tick per step. Odd in `ticks`, so that
/// what one cell gives is what the other takes.
SAHEL_HD int32_t stochastic_round(float ticks, uint32_t bits) {
    const uint32_t sign = __builtin_bit_cast(uint32_t, ticks) & 0x80000000u;
    const float magnitude = __builtin_bit_cast(float, __builtin_bit_cast(uint32_t, ticks) ^ sign);
    const int32_t whole = static_cast<int32_t>(magnitude);
    const float part = magnitude - static_cast<float>(whole); // exact
    const int32_t threshold = static_cast<int32_t>(part * 0x1p31f);
    const int32_t more = static_cast<int32_t>(static_cast<int32_t>(bits >> 1) < threshold);
    const int32_t flip = -static_cast<int32_t>(sign >> 31); // 0, or all bits of a negative amount; no branch
    return ((whole + more) ^ flip) - flip;
}

} // namespace sahel
