#include "sim/row_launch.h"
#include "sim/sand_kernels.h"

namespace sahel::SAHEL_ISA_NAMESPACE {

namespace {

// Choices that hold for a whole launch are made before the loop over cells, not in it.
struct SmoothCells {
    SmoothPass f;
    SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y) const {
        f.change(s, x, y) = f.template gains<false>(s, x, y);
    }
};

// The speed of the wind takes a root: once for a cell, kept for the three rows that ask.
struct SmoothWindRows {
    static constexpr int32_t k_chunk = 256;
    SmoothPass f;

    void operator()(int32_t s, const LocalRect& r) const {
        const SmoothPass p = f;
        alignas(64) float speed[3][k_chunk + 2];
        const auto fill = [&](int32_t y, int32_t x0, int32_t w) __attribute__((always_inline)) {
            float* row = speed[(y - r.y0 + 3) % 3];
            SAHEL_VECTORIZE
            for (int32_t j = 0; j < w + 2; ++j) row[j] = p.speed(s, x0 - 1 + j, y);
        };
        for (int32_t x0 = r.x0; x0 < r.x1; x0 += k_chunk) {
            const int32_t w = x0 + k_chunk < r.x1 ? k_chunk : r.x1 - x0;
            fill(r.y0 - 1, x0, w);
            fill(r.y0, x0, w);
            for (int32_t y = r.y0; y < r.y1; ++y) {
                fill(y + 1, x0, w);
                const float* rows[3] = {speed[(y - r.y0 + 2) % 3] + 1, speed[(y - r.y0) % 3] + 1,
                                        speed[(y - r.y0 + 1) % 3] + 1};
                SAHEL_VECTORIZE
                for (int32_t j = 0; j < w; ++j) {
                    const auto from = [&](int k) __attribute__((always_inline)) {
                        return p.gain_at(s, x0 + j, y, k, rows[1][j] + rows[1 + direction_y(k)][j + direction_x(k)]);
                    };
                    p.change(s, x0 + j, y) =
                        ((from(0) + from(1)) + (from(2) + from(3))) + ((from(4) + from(5)) + (from(6) + from(7)));
                }
            }
        }
    }
};

template <bool k_lowers> struct ReposeCells {
    ReposePass f;
    SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y) const { f.template cell<k_lowers>(s, x, y); }
};

} // namespace

void run_ground(const Launch& l, const GroundPass& f) {
    launch(l, f);
}

void run_cliff(const Launch& l, const CliffPass& f) {
    launch(l, f);
}

void run_no_echo(const Launch& l, const NoEchoPass& f) {
    launch(l, f);
}

void run_smooth(const Launch& l, const SmoothPass& f) {
    if (f.by_wind)
        launch_rows(l, 32, SmoothWindRows{f});
    else
        launch(l, SmoothCells{f});
}

void run_apply_smooth(const Launch& l, const ApplySmoothPass& f) {
    launch(l, f);
}

void run_repose(const Launch& l, const ReposePass& f) {
    if (f.lowers)
        launch(l, ReposeCells<true>{f});
    else
        launch(l, ReposeCells<false>{f});
}

void run_covered(const Launch& l, const CoveredPass& f) {
    launch(l, f);
}

void run_supply(const Launch& l, const SupplyPass& f) {
    launch(l, f);
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
