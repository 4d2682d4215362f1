#pragma once

#include <cstdint>

/// Rows of every function of world/det_math.h. One source is compiled by several compilers with several flags, each
/// into its own namespace; the tests compare what they compute.
#define SAHEL_DECLARE_DET_SWEEP(space)                                                                                 \
    namespace space {                                                                                                  \
    void row_exp(const float* x, const float* y, float* out, int n);                                                   \
    void row_exp2(const float* x, const float* y, float* out, int n);                                                  \
    void row_log(const float* x, const float* y, float* out, int n);                                                   \
    void row_log2(const float* x, const float* y, float* out, int n);                                                  \
    void row_pow(const float* x, const float* y, float* out, int n);                                                   \
    void row_sin(const float* x, const float* y, float* out, int n);                                                   \
    void row_cos(const float* x, const float* y, float* out, int n);                                                   \
    void row_atan(const float* x, const float* y, float* out, int n);                                                  \
    void row_atan2(const float* x, const float* y, float* out, int n);                                                 \
    void row_sqrt(const float* x, const float* y, float* out, int n);                                                  \
    void row_floor(const float* x, const float* y, float* out, int n);                                                 \
    }

namespace sahel::test {

using Row = void (*)(const float*, const float*, float*, int);
struct NamedRow {
    const char* name;
    Row row;
};
inline constexpr int k_det_rows = 11;
#define SAHEL_DET_ROWS(space)                                                                                          \
    {                                                                                                                  \
        {"exp", &space::row_exp}, {"exp2", &space::row_exp2}, {"log", &space::row_log}, {"log2", &space::row_log2},    \
            {"pow", &space::row_pow}, {"sin", &space::row_sin}, {"cos", &space::row_cos}, {"atan", &space::row_atan},  \
            {"atan2", &space::row_atan2}, {"sqrt", &space::row_sqrt}, {"floor", &space::row_floor},                    \
    }

SAHEL_DECLARE_DET_SWEEP(det_plain)
SAHEL_DECLARE_DET_SWEEP(det_base)
SAHEL_DECLARE_DET_SWEEP(det_v3)
SAHEL_DECLARE_DET_SWEEP(det_other)

} // namespace sahel::test
