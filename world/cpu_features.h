#pragma once

#include <string_view>

/// One binary for every x86-64 machine: hot kernels are compiled twice from the same source, for the baseline
/// instruction set and for x86-64-v3 (AVX2), and the copy is chosen once at run time. Both copies give the same bits,
/// because contraction to fused multiply-add is off everywhere and no kernel reorders a float sum.
///
///     // noise_rows.h                                     // noise_rows.cpp, through sahel_add_isa_sources(...)
///     SAHEL_ISA_DECLARE(void noise_rows(Rows rows))       namespace sahel::SAHEL_ISA_NAMESPACE {
///                                                         void noise_rows(Rows rows) { ... }
///     // a caller in the same namespace                   }
///     SAHEL_ISA_CALL(noise_rows, rows);
///
/// What such a source shares with other files must be always_inline (SAHEL_HD) or live in its own SAHEL_ISA_NAMESPACE:
/// of an ordinary inline function or template the linker keeps one copy for the whole program, and that may be the AVX2
/// one. So no standard containers, strings or streams in there; a test reads the symbols of every v3 object.
/// Measured: AVX-512 (x86-64-v4) is no faster on these memory-bound loops, so there is no third copy.
namespace sahel {

enum class Isa { baseline, v3 };

constexpr std::string_view name_of(Isa isa) {
    return isa == Isa::v3 ? "v3" : "baseline";
}

/// What this machine (processor and operating system) can run.
Isa best_isa();

/// What kernels run: the best one, or what the environment variable SAHEL_ISA (baseline, v3) asks for. An unknown name,
/// or v3 on a machine without it, prints one line to stderr and is ignored.
Isa isa();

/// For tests: from now on, in every thread. A request that the machine cannot meet gives baseline. Returns what is set.
Isa set_isa(Isa wanted);

} // namespace sahel

#if defined(__x86_64__)
#define SAHEL_ISA_DECLARE(...)                                                                                         \
    namespace isa_base {                                                                                               \
    __VA_ARGS__;                                                                                                       \
    }                                                                                                                  \
    namespace isa_v3 {                                                                                                 \
    __VA_ARGS__;                                                                                                       \
    }
#define SAHEL_ISA_CALL(function, ...)                                                                                  \
    (::sahel::isa() == ::sahel::Isa::v3 ? isa_v3::function(__VA_ARGS__) : isa_base::function(__VA_ARGS__))
#else
#define SAHEL_ISA_DECLARE(...)                                                                                         \
    namespace isa_base {                                                                                               \
    __VA_ARGS__;                                                                                                       \
    }
#define SAHEL_ISA_CALL(function, ...) isa_base::function(__VA_ARGS__)
#endif
