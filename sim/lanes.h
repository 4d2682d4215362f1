#pragma once

#include "world/executor.h"
#include "world/macros.h"

#include <cstdint>

/// Several cells at once, spelled out: for the few loops whose shape the vectoriser does not see. The compiler's own
/// vector types, as wide as a register of the instruction set; each lane computes what a float would, bit for bit, so
/// that the width does not show. Only for sources that are compiled for several instruction sets.
#if defined(__AVX__)
#define SAHEL_LANE_BYTES 32
#else
#define SAHEL_LANE_BYTES 16
#endif

namespace sahel::lanes {
inline namespace SAHEL_EXECUTOR_NAMESPACE {

inline constexpr int32_t k_count = SAHEL_LANE_BYTES / 4;
typedef float Reals __attribute__((vector_size(SAHEL_LANE_BYTES)));
typedef int32_t Ints __attribute__((vector_size(SAHEL_LANE_BYTES)));
typedef int64_t Halves __attribute__((vector_size(SAHEL_LANE_BYTES)));

SAHEL_HD Reals load(const float* p) {
    Reals v;
    __builtin_memcpy(&v, p, sizeof(v));
    return v;
}
SAHEL_HD Ints load(const int32_t* p) {
    Ints v;
    __builtin_memcpy(&v, p, sizeof(v));
    return v;
}
SAHEL_HD void store(float* p, Reals v) {
    __builtin_memcpy(p, &v, sizeof(v));
}
SAHEL_HD Reals to_real(Ints v) {
    return __builtin_convertvector(v, Reals);
}
SAHEL_HD Ints floor(Reals v) {
    const Ints whole = __builtin_convertvector(v, Ints);
    return whole + (v < to_real(whole)); // a true lane is -1
}
SAHEL_HD Reals max(Reals a, Reals b) {
    return a > b ? a : b;
}
SAHEL_HD Ints max(Ints a, Ints b) {
    return a > b ? a : b;
}
SAHEL_HD Reals clamp(Reals v, float low, float high) {
    const Reals l = Reals{} + low;
    const Reals h = Reals{} + high;
    return v < l ? l : (v > h ? h : v);
}
/// Whether some bit of some lane is set; of a comparison: whether it holds in some lane.
SAHEL_HD bool any(Ints v) {
    const Halves halves = reinterpret_cast<Halves>(v);
    int64_t bits = 0;
    for (int32_t i = 0; i < k_count / 2; ++i) bits |= halves[i];
    return bits != 0;
}
/// Whether all lanes of a are equal, and all of b.
SAHEL_HD bool uniform(Ints a, Ints b) {
    return !any((a ^ a[0]) | (b ^ b[0]));
}

} // namespace SAHEL_EXECUTOR_NAMESPACE
} // namespace sahel::lanes
