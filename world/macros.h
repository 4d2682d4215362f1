#pragma once

/// Host/device markers. Kernels are plain functors marked SAHEL_HD in plain headers; a `.cpp` and a `.cu` launcher
/// include the same header, so that both machines run the same source.
#if defined(__CUDACC__)
#define SAHEL_HD __host__ __device__ __forceinline__
#define SAHEL_CONSTANT __device__ const
#else
#define SAHEL_HD inline __attribute__((always_inline))
#define SAHEL_CONSTANT
#endif

/// On the one row loop of a CPU launcher: the compiler may assume that iterations do not depend on each other.
#if defined(__clang__)
#define SAHEL_VECTORIZE _Pragma("clang loop vectorize(assume_safety) interleave(enable)")
#elif defined(__GNUC__)
#define SAHEL_VECTORIZE _Pragma("GCC ivdep")
#else
#define SAHEL_VECTORIZE
#endif
