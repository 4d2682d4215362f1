#pragma once

#include "sim/avalanche_rows.h"

#include <vector>

/// What the row kernels of avalanches share, compiled for each instruction set: rows of cells with what the kernels
/// know of them, cells at borders, and strips of blocks.
namespace sahel::SAHEL_ISA_NAMESPACE {

namespace {

constexpr int32_t k_rim = 2;
constexpr int32_t k_first = 1; // word of a row's first cell; before it and behind the last are words that never slide
// Blocks that lie side by side are worked out together: the longer the rows, the less of them is rim, the longer ago a
// word was written that a loop reads between two vectors (a processor waits for such words), and the longer the runs
// of memory that it reads ahead.
constexpr int32_t k_strip_blocks = 32;
constexpr int32_t k_width = k_first + k_strip_blocks * k_slide_block_x + 2 * k_rim;
constexpr int32_t k_lanes = 8;
// Words of a row: the cells, a few that never slide, and so many that the rows of a short strip lie side by side in the
// first cache (17 lines of 64 bytes further on in each page) and not on top of each other.
constexpr int32_t k_row = k_strip_blocks * k_slide_block_x + 17 * 16;
static_assert(k_row >= k_width + k_lanes + 1 && k_strip_blocks * k_slide_block_x % 1024 == 0);
constexpr int32_t k_no_cell = 1 << 29; // their height where repose is read: they stand at any slope
constexpr int32_t k_ring = 4;          // rows; a power of two
using Row = int32_t[k_row];
using RealRow = float[k_row];

SAHEL_HD int32_t larger(int32_t a, int32_t b) {
    return a > b ? a : b;
}
SAHEL_HD int32_t smaller(int32_t a, int32_t b) {
    return a < b ? a : b;
}

// Loops over a row end at a whole number of vectors: what they work out beyond has no share in anything.
SAHEL_HD int32_t whole(int32_t count) {
    return (count + k_lanes - 1) / k_lanes * k_lanes;
}

// Words of a row of so many cells that some loop looks at.
SAHEL_HD int32_t used(int32_t cells) {
    return smaller(k_first + whole(cells) + k_lanes + 1, k_row);
}

// What the kernels know of a row of cells.
struct alignas(64) Cells {
    Row height, limit, repose, across;
};

// Whether a halo in one of these directions is closed or a wall.
bool special(const SlideGround& g, int32_t slot, int32_t dx0, int32_t dx1, int32_t dy0, int32_t dy1) {
    const int32_t bits = g.closed[slot] | g.walls[slot];
    for (int32_t dy = dy0; dy <= dy1; ++dy)
        for (int32_t dx = dx0; dx <= dx1; ++dx) {
            const int k = direction_of(dx, dy);
            if (k >= 0 && (bits >> k & 1) != 0) return true;
        }
    return false;
}

// -1: before the owned cells, 0: among them, 1: behind.
int32_t side_of(int32_t x, int32_t n) {
    return x < 0 ? -1 : static_cast<int32_t>(x >= n);
}

// Cells [x0, x1) of row y: `ask(x)` for those that have, within `rim` cells, a halo that is closed or a wall;
// `rest(x, x2)` for runs of others. Asking is slow.
template <class Ask, class Rest>
void split_row(const SlideGround& g, int32_t slot, int32_t y, int32_t x0, int32_t x1, int32_t rim, const Ask& ask,
               const Rest& rest) {
    if ((g.closed[slot] | g.walls[slot]) == 0) return rest(x0, x1);
    const int32_t dy0 = side_of(y - rim, g.n);
    const int32_t dy1 = side_of(y + rim, g.n);
    const auto run = [&](int32_t from, int32_t to, int32_t dx0, int32_t dx1) {
        if (from >= to) return;
        if (!special(g, slot, dx0, dx1, dy0, dy1)) return rest(from, to);
        for (int32_t x = from; x < to; ++x) ask(x);
    };
    const int32_t from = smaller(larger(x0, rim), x1);
    const int32_t to = larger(smaller(x1, g.n - rim), from);
    run(x0, from, -1, 0);
    run(from, to, 0, 0);
    run(to, x1, 0, 1);
}
template <class Ask>
void split_row(const SlideGround& g, int32_t slot, int32_t y, int32_t x0, int32_t x1, int32_t rim, const Ask& ask) {
    split_row(g, slot, y, x0, x1, rim, ask, [](int32_t, int32_t) {});
}

// Cells [x0, x1) of row y that are closed give nothing.
void close_cells(const SlideGround& g, int32_t slot, int32_t y, int32_t x0, int32_t x1, int32_t* limit) {
    split_row(g, slot, y, x0, x1, 0, [&](int32_t x) {
        if (!g.gives(slot, x, y)) limit[x - x0] = 0;
    });
}

// Cells [x0, x1) of row y; what is closed gives nothing. `Even`: of sand that has one angle of repose, which is not
// read; words beyond the cells then stand level with the last one.
template <bool Even> void load_row(const SlideGround& g, int32_t slot, int32_t y, int32_t x0, int32_t x1, Cells& to) {
    // A few cells more, where the slab has them, so that no loop ends within a vector.
    const int32_t there = g.bedrock.last - x0;
    const int32_t count = smaller(whole(x1 - x0), there);
    int32_t* const height = to.height + k_first;
    int32_t* const limit = to.limit + k_first;
    int32_t* const repose = to.repose + k_first;
    int32_t* const across = to.across + k_first;
    const int32_t* const rock = g.bedrock.row(slot, y) + x0;
    if constexpr (Even) {
        const int32_t* const earth = g.soil.row(slot, y) + x0;
        const int32_t* const loose = g.sand.row(slot, y) + x0;
        SAHEL_VECTORIZE
        for (int32_t i = 0; i < count; ++i) height[i] = rock[i] + earth[i] + loose[i];
    } else if (g.kind == AvalancheKind::sand) {
        const int32_t* const earth = g.soil.row(slot, y) + x0;
        const int32_t* const loose = g.sand.row(slot, y) + x0;
        const float* const tangent = g.repose.row(slot, y) + x0;
        const float scale = g.ticks_per_tangent;
        SAHEL_VECTORIZE
        for (int32_t i = 0; i < count; ++i) {
            height[i] = rock[i] + earth[i] + loose[i];
            limit[i] = loose[i];
            repose[i] = repose_ticks(tangent[i], scale);
            across[i] = repose_across(repose[i]);
        }
    } else if (g.kind == AvalancheKind::bedrock && !g.object.origin) {
        const int32_t steep = repose_ticks(g.tangent, g.ticks_per_tangent);
        const int32_t steep_across = repose_across(steep);
        SAHEL_VECTORIZE
        for (int32_t i = 0; i < count; ++i) {
            height[i] = rock[i];
            limit[i] = k_slides_without_limit;
            repose[i] = steep;
            across[i] = steep_across;
        }
    } else {
        for (int32_t i = 0; i < count; ++i) {
            const SlideCell c = g(slot, x0 + i, y);
            height[i] = c.height;
            limit[i] = c.limit;
            repose[i] = c.repose;
            across[i] = repose_across(c.repose);
        }
    }
    const int32_t last = k_first + x1 - x0 - 1;
    const auto no_cell = [&to, last ](int32_t i) __attribute__((always_inline)) {
        if constexpr (Even) {
            to.height[i] = to.height[i < k_first ? k_first : last];
            return;
        }
        to.limit[i] = 0;
        to.height[i] = k_no_cell;
        to.repose[i] = 2 * k_no_cell;
        to.across[i] = 2 * k_no_cell;
    };
    no_cell(0);
    const int32_t end = used(x1 - x0);
    for (int32_t i = k_first + x1 - x0; i < end; ++i) no_cell(i);
    if constexpr (!Even) close_cells(g, slot, y, x0, x1, limit);
}

// Sets word i of the four pairs of a row; the bits of all that are not 0.
SAHEL_HD int32_t set_pairs(int32_t* e, int32_t* se, int32_t* s, int32_t* sw, int32_t i, int32_t to_e, int32_t to_se,
                           int32_t to_s, int32_t to_sw) {
    e[i] = to_e;
    se[i] = to_se;
    s[i] = to_s;
    sw[i] = to_sw;
    return (to_e | to_se) | (to_s | to_sw);
}

// The ring of rows of one block. Pairs are overwritten by what slides between them.
struct Ring {
    Cells cells[k_ring];
    alignas(64) Row e[k_ring], se[k_ring], s[k_ring], sw[k_ring];
    alignas(64) RealRow share[k_ring];
};

// The sum of what a row of cells gets, into `net`; or apart, what it gives and what it gets.
template <bool Apart>
SAHEL_HD void gather_row(const int32_t* e, const int32_t* se, const int32_t* s, const int32_t* sw, const int32_t* up_se,
                         const int32_t* up_s, const int32_t* up_sw, int32_t count, const int32_t* now, int32_t* out,
                         int32_t* taken) {
    SAHEL_VECTORIZE
    for (int32_t i = 0; i < count; ++i) {
        if constexpr (Apart) {
            const int32_t given =
                ((larger(e[i], 0) + larger(se[i], 0)) + (larger(s[i], 0) + larger(sw[i], 0))) +
                ((larger(-e[i - 1], 0) + larger(-up_se[i - 1], 0)) + (larger(-up_s[i], 0) + larger(-up_sw[i + 1], 0)));
            const int32_t got =
                ((larger(-e[i], 0) + larger(-se[i], 0)) + (larger(-s[i], 0) + larger(-sw[i], 0))) +
                ((larger(e[i - 1], 0) + larger(up_se[i - 1], 0)) + (larger(up_s[i], 0) + larger(up_sw[i + 1], 0)));
            out[i] = now[i] - given;
            taken[i] += got;
        } else {
            out[i] =
                now[i] + (((e[i - 1] - e[i]) + (up_se[i - 1] - se[i])) + ((up_s[i] - s[i]) + (up_sw[i + 1] - sw[i])));
        }
    }
}

// Blocks side by side: the same slot, the same rows, one repose or none.
struct Strip {
    const SlideWork* work;
    int32_t count;
    uint8_t* slid; // null: not wanted
    [[nodiscard]] LocalRect rect() const {
        return {work[0].rect.x0, work[0].rect.y0, work[count - 1].rect.x1, work[0].rect.y1};
    }
};

std::vector<Strip> strips_of(const SlideLaunch& l) {
    std::vector<Strip> strips;
    for (int32_t i = 0; i < l.count; ++i) {
        const SlideWork& w = l.work[i];
        if (!strips.empty() && strips.back().count < k_strip_blocks) {
            Strip& last = strips.back();
            const SlideWork& before = last.work[last.count - 1];
            if (before.slot == w.slot && before.rect.y0 == w.rect.y0 && before.rect.y1 == w.rect.y1 &&
                before.rect.x1 == w.rect.x0 && before.repose == w.repose) {
                ++last.count;
                continue;
            }
        }
        strips.push_back({&w, 1, l.slid ? l.slid + i : nullptr});
    }
    return strips;
}

template <class F, void (*Work)(const F&, const Strip&, Ring&)> struct Job {
    const std::vector<Strip>* strips;
    bool backward;
    const F* pass;
    static void run(const void* context, int64_t index) {
        const Job& job = *static_cast<const Job*>(context);
        const auto i = static_cast<size_t>(index);
        Ring ring;
        Work(*job.pass, (*job.strips)[job.backward ? job.strips->size() - 1 - i : i], ring);
    }
};

template <class F, void (*Work)(const F&, const Strip&, Ring&)> void run_all(const SlideLaunch& l, const F& pass) {
    if (l.count == 0) return;
    const std::vector<Strip> strips = strips_of(l);
    const Job<F, Work> job{&strips, l.backward, &pass};
    detail::run_blocks(l.name, l.cells, static_cast<int64_t>(strips.size()), &Job<F, Work>::run, &job);
}

} // namespace

} // namespace sahel::SAHEL_ISA_NAMESPACE
