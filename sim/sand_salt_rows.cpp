#include "sim/row_launch.h"
#include "sim/sand_kernels.h"

namespace sahel::SAHEL_ISA_NAMESPACE {

namespace {

// Lift and deposit in pieces of a row: first what is wished for, then, only where some cell of the piece needs them,
// random numbers, then the move. Over open sand no cell does, and ten rounds of multiplication are saved.
constexpr int32_t k_wide = 32;
constexpr int32_t k_rows_per_block = 16;
constexpr int32_t k_few = 4;

struct Words {
    alignas(64) uint32_t a[k_wide];
    alignas(64) uint32_t b[k_wide];

    alignas(64) int32_t drawn[k_wide]; // 1 where the outcome depends on them

    inline __attribute__((always_inline)) void set(const CellPlaces& places, const RandomStream& random, int32_t s,
                                                   int32_t x, int32_t y, int32_t w) {
        int32_t count = 0;
        for (int32_t j = 0; j < w; ++j) count += drawn[j];
        if (count <= k_few)
            for (int32_t j = 0; j < w; ++j) a[j] = b[j] = 0;
        if (count == 0) return;
        const int64_t wy = places.y(s, y);
        const auto draw = [&](int32_t j) __attribute__((always_inline)) {
            const Random4 r = random.at(places.x(s, x + j), wy);
            a[j] = r.v[0];
            b[j] = r.v[1];
        };
        if (count <= k_few) {
            for (int32_t j = 0; j < w; ++j)
                if (drawn[j] != 0) draw(j);
        } else { // all at once cost little more than a few one by one
            for (int32_t j = 0; j < w; ++j) draw(j);
        }
    }
};

// f(x, w) for pieces of a row, each cell once.
template <class F> inline __attribute__((always_inline)) void each_piece(const LocalRect& r, const F& f) {
    for (int32_t y = r.y0; y < r.y1; ++y) {
        int32_t x = r.x0;
        for (; x + k_wide <= r.x1; x += k_wide) f(x, y, k_wide);
        if (x < r.x1) f(x, y, r.x1 - x);
    }
}

template <bool k_echoes> struct LiftRows {
    LiftPass f;
    void operator()(int32_t s, const LocalRect& r) const {
        const LiftPass p = f; // a copy of its own: no store of a cell changes it
        Words words;
        alignas(64) float ticks[k_wide];
        each_piece(
            r, [&](int32_t x, int32_t y, int32_t w) __attribute__((always_inline)) {
                SAHEL_VECTORIZE
                for (int32_t j = 0; j < w; ++j) {
                    ticks[j] = p.template wanted<k_echoes>(s, x + j, y);
                    words.drawn[j] =
                        static_cast<int32_t>(p.draws(ticks[j], p.sand(s, x + j, y), p.airborne(s, x + j, y)));
                }
                words.set(p.places, p.random, s, x, y, w);
                SAHEL_VECTORIZE
                for (int32_t j = 0; j < w; ++j) p.move(s, x + j, y, ticks[j], words.a[j], words.b[j]);
            });
    }
};

template <bool k_echoes> struct DepositRows {
    DepositPass f;
    void operator()(int32_t s, const LocalRect& r) const {
        const DepositPass p = f;
        Words words;
        alignas(64) float settles[k_wide];
        each_piece(
            r, [&](int32_t x, int32_t y, int32_t w) __attribute__((always_inline)) {
                SAHEL_VECTORIZE
                for (int32_t j = 0; j < w; ++j) {
                    settles[j] = static_cast<float>(p.arrived(s, x + j, y)) *
                                 p.template settling<k_echoes>(s, x + j, y, p.ground(s, x + j, y));
                    words.drawn[j] = static_cast<int32_t>(p.draws(settles[j]));
                }
                words.set(p.places, p.random, s, x, y, w);
                SAHEL_VECTORIZE
                for (int32_t j = 0; j < w; ++j) p.move(s, x + j, y, p.ground(s, x + j, y), settles[j], words.a[j]);
            });
    }
};

template <bool k_echoes> struct WearRows {
    DepositPass f;
    void operator()(int32_t s, const LocalRect& r) const {
        const DepositPass p = f;
        Words words;
        Words wear;
        alignas(64) float settles[k_wide];
        alignas(64) float scale[k_wide];
        alignas(64) float moisture[k_wide]; // before soil is worn, as for a single cell
        alignas(64) int32_t loosened[k_wide];
        each_piece(
            r, [&](int32_t x, int32_t y, int32_t w) __attribute__((always_inline)) {
                SAHEL_VECTORIZE
                for (int32_t j = 0; j < w; ++j) {
                    const DepositPass::Ground g = p.ground(s, x + j, y);
                    const int32_t here = p.arrived(s, x + j, y);
                    settles[j] = static_cast<float>(here) * p.template settling<k_echoes>(s, x + j, y, g);
                    moisture[j] = g.moisture;
                    scale[j] = p.wear_scale(s, x + j, y, g, settles[j], here);
                    words.drawn[j] = static_cast<int32_t>(p.draws(settles[j]));
                    wear.drawn[j] = static_cast<int32_t>(p.can_wear(g, scale[j]));
                }
                words.set(p.places, p.random, s, x, y, w);
                wear.set(p.places, p.random_wear, s, x, y, w);
                SAHEL_VECTORIZE
                for (int32_t j = 0; j < w; ++j)
                    loosened[j] = p.worn(s, x + j, y, p.ground(s, x + j, y), scale[j], wear.a[j], wear.b[j]);
                SAHEL_VECTORIZE
                for (int32_t j = 0; j < w; ++j) {
                    DepositPass::Ground g = p.ground(s, x + j, y);
                    g.sand += loosened[j];
                    g.moisture = moisture[j];
                    p.move(s, x + j, y, g, settles[j], words.a[j]);
                }
            });
    }
};

} // namespace

void run_lift(const Launch& l, const LiftPass& f) {
    if (f.echoes)
        launch_rows(l, k_rows_per_block, LiftRows<true>{f});
    else
        launch_rows(l, k_rows_per_block, LiftRows<false>{f});
}

void run_deposit(const Launch& l, const DepositPass& f) {
    if (f.wears && f.echoes)
        launch_rows(l, k_rows_per_block, WearRows<true>{f});
    else if (f.wears)
        launch_rows(l, k_rows_per_block, WearRows<false>{f});
    else if (f.echoes)
        launch_rows(l, k_rows_per_block, DepositRows<true>{f});
    else
        launch_rows(l, k_rows_per_block, DepositRows<false>{f});
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
