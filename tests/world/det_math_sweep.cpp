#include "det_math_sweep.h"

#include "world/det_math.h"

// Nothing but this header and plain loops: the object is linked from several instruction sets.
namespace sahel::test::SAHEL_DET_SPACE {

#define SAHEL_DET_ROW(name, expression)                                                                                \
    void row_##name(const float* x, const float* y, float* out, int n) {                                               \
        (void)y;                                                                                                       \
        SAHEL_VECTORIZE                                                                                                \
        for (int i = 0; i < n; ++i) out[i] = expression;                                                               \
    }

SAHEL_DET_ROW(exp, det::exp(x[i]))
SAHEL_DET_ROW(exp2, det::exp2(x[i]))
SAHEL_DET_ROW(log, det::log(x[i]))
SAHEL_DET_ROW(log2, det::log2(x[i]))
SAHEL_DET_ROW(pow, det::pow(x[i], y[i]))
SAHEL_DET_ROW(sin, det::sin(x[i]))
SAHEL_DET_ROW(cos, det::cos(x[i]))
SAHEL_DET_ROW(atan, det::atan(x[i]))
SAHEL_DET_ROW(atan2, det::atan2(y[i], x[i]))
SAHEL_DET_ROW(sqrt, det::sqrt(x[i]))
SAHEL_DET_ROW(floor, det::floor(x[i]))

} // namespace sahel::test::SAHEL_DET_SPACE
