#include "sim/wind_ground.h"
#include "sim/wind_plane.h"

namespace sahel::SAHEL_ISA_NAMESPACE {

namespace {

template <int32_t s> void add_row(const int32_t* row, int64_t* out, int32_t n) {
    for (int32_t x = 0; x < n; ++x) {
        int64_t sum = 0;
        for (int32_t i = 0; i < s; ++i) sum += row[x * s + i];
        out[x] += sum;
    }
}

} // namespace

void run_ground_sums(const GroundSums& f, int32_t slots) {
    const int32_t s = 1 << f.shift;
    for_each_row("sim/wind_ground", f.layers * s * s * f.n, slots * f.n, [&](int32_t i) {
        const int32_t slot = i / f.n;
        int64_t* out = f.out + int64_t{i} * f.n;
        for (int32_t x = 0; x < f.n; ++x) out[x] = 0;
        for (int32_t l = 0; l < f.layers; ++l)
            for (int32_t j = 0; j < s; ++j) {
                const int32_t* row = f.layer[l].row(slot, (i % f.n) * s + j);
                switch (f.shift) {
                case 0:
                    add_row<1>(row, out, f.n);
                    break;
                case 1:
                    add_row<2>(row, out, f.n);
                    break;
                case 2:
                    add_row<4>(row, out, f.n);
                    break;
                default:
                    add_row<8>(row, out, f.n);
                }
            }
    });
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
