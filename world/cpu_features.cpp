#include "world/cpu_features.h"

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#if defined(__x86_64__)
#include <cpuid.h>
#endif

namespace sahel {

namespace {

#if defined(__x86_64__)
// The operating system saves the upper halves of the AVX registers.
bool system_saves_avx() {
    uint32_t low = 0;
    uint32_t high = 0;
    __asm__ volatile("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    return (low & 6u) == 6u;
}

// The feature list of x86-64-v3 (System V ABI for x86-64, section 3.1.1). __builtin_cpu_supports("x86-64-v3") would say
// the same, but clang before 17 does not know that name.
bool has_v3() {
    uint32_t a = 0;
    uint32_t b = 0;
    uint32_t c = 0;
    uint32_t d = 0;
    constexpr uint32_t k_leaf1 =
        (1u << 12) | (1u << 22) | (1u << 27) | (1u << 28) | (1u << 29) // FMA MOVBE OSXSAVE AVX F16C
        | (1u << 0) | (1u << 9) | (1u << 13) | (1u << 19) | (1u << 20) // SSE3 SSSE3 CX16 SSE4.1 4.2
        | (1u << 23);                                                  // POPCNT
    if (!__get_cpuid(1, &a, &b, &c, &d) || (c & k_leaf1) != k_leaf1) return false;
    if (!system_saves_avx()) return false;
    constexpr uint32_t k_leaf7 = (1u << 3) | (1u << 5) | (1u << 8); // BMI1 AVX2 BMI2
    if (!__get_cpuid_count(7, 0, &a, &b, &c, &d) || (b & k_leaf7) != k_leaf7) return false;
    constexpr uint32_t k_extended = (1u << 0) | (1u << 5); // LAHF LZCNT
    return __get_cpuid(0x80000001u, &a, &b, &c, &d) && (c & k_extended) == k_extended;
}
#else
bool has_v3() {
    return false;
}
#endif

Isa chosen_from_environment() {
    const Isa best = best_isa();
    const char* asked = std::getenv("SAHEL_ISA");
    if (!asked || !*asked) return best;
    const std::string_view name = asked;
    if (name == name_of(Isa::baseline)) return Isa::baseline;
    if (name == name_of(best)) return best;
    if (name == name_of(Isa::v3))
        std::fprintf(stderr, "SAHEL_ISA=v3: this machine has no x86-64-v3; running baseline kernels\n");
    else
        std::fprintf(stderr, "SAHEL_ISA=%s: not known (baseline, v3); running %s kernels\n", asked,
                     name_of(best).data());
    return best;
}

std::atomic<Isa>& current() {
    static std::atomic<Isa> value{chosen_from_environment()};
    return value;
}

} // namespace

Isa best_isa() {
    static const Isa best = has_v3() ? Isa::v3 : Isa::baseline;
    return best;
}

Isa isa() {
    return current().load(std::memory_order_relaxed);
}

Isa set_isa(Isa wanted) {
    const Isa possible = wanted == Isa::v3 ? best_isa() : Isa::baseline;
    current().store(possible, std::memory_order_relaxed);
    return possible;
}

} // namespace sahel
