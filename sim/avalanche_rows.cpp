#include "sim/avalanche_rows.h"

#include <vector>

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
// Cells that are asked together whether anything moves in them: even in blocks with avalanches most do not.
constexpr int32_t k_flow_cells = 16;

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

// Whether the block's cells, with `rim` around them, are all owned or in halos that are simulated.
bool plain(const SlideGround& g, int32_t slot, const LocalRect& r, int32_t rim) {
    const bool owned = r.x0 >= rim && r.y0 >= rim && r.x1 + rim <= g.n && r.y1 + rim <= g.n;
    return owned || (g.closed[slot] == 0 && g.walls[slot] == 0);
}

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
template <bool Even>
void load_row(const SlideGround& g, int32_t slot, int32_t y, int32_t x0, int32_t x1, bool all_give, Cells& to) {
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
    if (!Even && !all_give) close_cells(g, slot, y, x0, x1, limit);
}

// What the cells of a row of even sand may give: only asked for where something stands too steep.
void load_limits(const SlideGround& g, int32_t slot, int32_t y, int32_t x0, int32_t x1, bool all_give, Cells& to) {
    const int32_t* const loose = g.sand.row(slot, y) + x0;
    int32_t* const limit = to.limit + k_first;
    const int32_t count = x1 - x0;
    for (int32_t i = 0; i < count; ++i) limit[i] = loose[i];
    for (int32_t i = count; i < used(count) - k_first; ++i) limit[i] = 0;
    if (!all_give) close_cells(g, slot, y, x0, x1, limit);
}

// Excess of a pair: above 0 the first gives, below the second. Both slide_excess() in one.
SAHEL_HD int32_t pair_excess(int32_t drop, int32_t first, int32_t second) {
    const int32_t over = larger(drop - first, smaller(drop + second, 0));
    return larger(smaller(over, k_most_excess), -k_most_excess);
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

// Repose of a cell of a row towards what lies beside and across: of the cell, or of all even sand.
template <bool Even> struct ReposeOf {
    int32_t beside_all, across_all;
    SAHEL_HD int32_t beside(const Cells& c, int32_t i) const { return Even ? beside_all : c.repose[i]; }
    SAHEL_HD int32_t across(const Cells& c, int32_t i) const { return Even ? across_all : c.across[i]; }
};

// The pairs of row `a` with itself and with the row below, `b`; the bits of all that are not 0. `repose`: of even sand.
template <bool Even>
SAHEL_HD int32_t pair_rows(const Cells& a, const Cells& b, int32_t* e, int32_t* se, int32_t* s, int32_t* sw,
                           int32_t cells, int32_t repose = 0) {
    const ReposeOf<Even> of{repose, repose_across(repose)};
    int32_t any = 0;
    const int32_t end = k_first + whole(cells);
    SAHEL_VECTORIZE
    for (int32_t i = k_first; i < end; ++i) {
        const int32_t h = a.height[i];
        const int32_t beside = of.beside(a, i);
        const int32_t across = of.across(a, i);
        any |= set_pairs(e, se, s, sw, i, pair_excess(h - a.height[i + 1], beside, of.beside(a, i + 1)),
                         pair_excess(h - b.height[i + 1], across, of.across(b, i + 1)),
                         pair_excess(h - b.height[i], beside, of.beside(b, i)),
                         pair_excess(h - b.height[i - 1], across, of.across(b, i - 1)));
    }
    return any;
}

SAHEL_HD int32_t slid(int32_t excess, float share_first, float share_second) {
    return slide_amount(excess, det::pick(excess > 0, share_first, share_second));
}

// Excess into what slides, of the words [begin, end).
SAHEL_HD int32_t slide_rows(const float* share, const float* share_below, int32_t* e, int32_t* se, int32_t* s,
                            int32_t* sw, int32_t begin, int32_t end) {
    int32_t any = 0;
    SAHEL_VECTORIZE
    for (int32_t i = begin; i < end; ++i) {
        const float here = share[i];
        any |= set_pairs(e, se, s, sw, i, slid(e[i], here, share[i + 1]), slid(se[i], here, share_below[i + 1]),
                         slid(s[i], here, share_below[i]), slid(sw[i], here, share_below[i - 1]));
    }
    return any;
}

// Shares of the cells whose neighbours are all known; 0 of the others.
SAHEL_HD void share_row(const SlideRule& rule, const int32_t* limit, const int32_t* e, const int32_t* se,
                        const int32_t* s, const int32_t* sw, const int32_t* up_se, const int32_t* up_s,
                        const int32_t* up_sw, float* share, int32_t cells) {
    const SlideRule r = rule;
    const int32_t from = k_first + 1;
    const int32_t to = k_first + cells - 1;
    const int32_t end = from + whole(to - from);
    SAHEL_VECTORIZE
    for (int32_t i = from; i < end; ++i) {
        const int32_t a = larger(e[i], 0), b = larger(se[i], 0), c = larger(s[i], 0), d = larger(sw[i], 0);
        const int32_t w = larger(-e[i - 1], 0), nw = larger(-up_se[i - 1], 0);
        const int32_t n = larger(-up_s[i], 0), ne = larger(-up_sw[i + 1], 0);
        const int32_t sum = ((a + b) + (c + d)) + ((w + nw) + (n + ne));
        const int32_t most = larger(larger(larger(a, b), larger(c, d)), larger(larger(w, nw), larger(n, ne)));
        share[i] = slide_share(r, sum, most, limit[i]);
    }
    share[0] = share[k_first] = 0.0f;
    const int32_t last = used(cells);
    for (int32_t i = to; i < last; ++i) share[i] = 0.0f;
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

template <bool Even> void sweep_strip_of(const SlideSweep& f, const Strip& strip, Ring& ring) {
    const SlideGround& g = f.ground;
    const int32_t repose = strip.work[0].repose;
    const LocalRect rect = strip.rect();
    const int32_t slot = strip.work[0].slot;
    const int32_t w = rect.x1 - rect.x0; // cell x of the block is word x - x0 + k_first + k_rim
    const bool all_give = plain(g, slot, rect, k_rim);
    const SlabView<const int32_t> plane = g.sliding();
    const int32_t words = used(w + 2 * k_rim);
    for (int32_t i = 0; i < k_ring; ++i) { // words that pair_rows leaves and share_row looks at
        for (int32_t c = k_first + whole(w + 2 * k_rim); c < words; ++c)
            ring.e[i][c] = ring.se[i][c] = ring.s[i][c] = ring.sw[i][c] = 0;
    }
    int32_t steep[k_ring] = {}; // pairs of a row that are not 0, and then what slides in them
    // What slides from the two cells before a block on counts as the block's: it wakes the blocks around it, and all
    // that this can change lies in those.
    int32_t any[k_strip_blocks] = {};
    int32_t end[k_strip_blocks];
    for (int32_t b = 0; b < strip.count; ++b)
        end[b] = k_first + (b + 1 < strip.count ? strip.work[b].rect.x1 - rect.x0 : whole(w + 2 * k_rim));
    for (int32_t r = rect.y0 - k_rim; r < rect.y1 + k_rim; ++r) {
        const int32_t i0 = r & (k_ring - 1);
        const int32_t i1 = (r - 1) & (k_ring - 1);
        const int32_t i2 = (r - 2) & (k_ring - 1);
        const int32_t i3 = (r - 3) & (k_ring - 1);
        Cells& now = ring.cells[i0];
        load_row<Even>(g, slot, r, rect.x0 - k_rim, rect.x1 + k_rim, all_give, now);
        if (r == rect.y0 - k_rim) continue;
        Cells& up = ring.cells[i1];
        steep[i1] = pair_rows<Even>(up, now, ring.e[i1], ring.se[i1], ring.s[i1], ring.sw[i1], w + 2 * k_rim, repose);
        if (r == rect.y0 - 1) continue;
        // Shares of row r - 1, from the pairs of rows r - 2 and r - 1.
        if ((steep[i1] | steep[i2]) != 0) {
            if constexpr (Even) load_limits(g, slot, r - 1, rect.x0 - k_rim, rect.x1 + k_rim, all_give, up);
            share_row(f.rule, up.limit, ring.e[i1], ring.se[i1], ring.s[i1], ring.sw[i1], ring.se[i2], ring.s[i2],
                      ring.sw[i2], ring.share[i1], w + 2 * k_rim);
        } else {
            for (int32_t i = 0; i < words; ++i) ring.share[i1][i] = 0.0f;
        }
        if (r == rect.y0) continue; // the row above the block's rim gives nothing to it
        // What slides from row r - 2 downwards and within it: its shares and those of r - 1 are known.
        if (steep[i2] != 0) {
            steep[i2] = 0;
            for (int32_t b = 0, begin = k_first; b < strip.count; begin = end[b++]) {
                const int32_t moved = slide_rows(ring.share[i2], ring.share[i1], ring.e[i2], ring.se[i2], ring.s[i2],
                                                 ring.sw[i2], begin, end[b]);
                any[b] |= moved;
                steep[i2] |= moved;
            }
        }
        if (r - 2 < rect.y0) continue;
        const int32_t y = r - 2;
        const int32_t* const from = plane.row(slot, y) + rect.x0;
        int32_t* const out = f.out.row(slot, y) + rect.x0;
        if ((steep[i2] | steep[i3]) == 0) {
            for (int32_t i = 0; i < w; ++i) out[i] = from[i];
        } else {
            int32_t* const taken = f.taken.origin ? f.taken.row(slot, y) + rect.x0 : nullptr;
            const auto gather = [&](int32_t x, int32_t x2) {
                const int32_t i = x - rect.x0;
                const int32_t c = k_first + k_rim + i;
                if (taken)
                    gather_row<true>(ring.e[i2] + c, ring.se[i2] + c, ring.s[i2] + c, ring.sw[i2] + c, ring.se[i3] + c,
                                     ring.s[i3] + c, ring.sw[i3] + c, x2 - x, from + i, out + i, taken + i);
                else
                    gather_row<false>(ring.e[i2] + c, ring.se[i2] + c, ring.s[i2] + c, ring.sw[i2] + c, ring.se[i3] + c,
                                      ring.s[i3] + c, ring.sw[i3] + c, x2 - x, from + i, out + i, nullptr);
            };
            const auto ask = [&](int32_t x) { // what is not simulated stays as it is
                if (g.gives(slot, x, y))
                    gather(x, x + 1);
                else
                    out[x - rect.x0] = from[x - rect.x0];
            };
            if (all_give)
                gather(rect.x0, rect.x1);
            else
                split_row(g, slot, y, rect.x0, rect.x1, 0, ask, gather);
        }
    }
    if (strip.slid)
        for (int32_t b = 0; b < strip.count; ++b) strip.slid[b] = any[b] != 0;
}

void sweep_strip(const SlideSweep& f, const Strip& strip, Ring& ring) {
    if (strip.work[0].repose == k_uneven)
        sweep_strip_of<false>(f, strip, ring);
    else
        sweep_strip_of<true>(f, strip, ring);
}

bool probe_block(const SlideProbe& f, const SlideWork& work, Ring& ring) {
    const LocalRect rect = work.rect;
    const int32_t w = rect.x1 - rect.x0;
    const bool all_give = plain(f.ground, work.slot, rect, 1);
    for (int32_t r = rect.y0; r <= rect.y1; ++r) {
        Cells& now = ring.cells[r & 1];
        load_row<false>(f.ground, work.slot, r, rect.x0 - 1, rect.x1 + 1, all_give, now);
        for (int32_t i = k_first; i < k_first + w + 2; ++i) { // what gives nothing never stands too steep
            now.repose[i] = now.limit[i] > 0 ? now.repose[i] + f.start_ticks : k_no_cell;
            now.across[i] = now.limit[i] > 0 ? now.across[i] + f.start_ticks : k_no_cell;
        }
        if (r == rect.y0) continue;
        const int32_t any =
            pair_rows<false>(ring.cells[(r - 1) & 1], now, ring.e[0], ring.se[0], ring.s[0], ring.sw[0], w + 2);
        if (any != 0) return true;
    }
    return false;
}

// Not 0 where a pair that lies still starts: it stands steeper than its angle of repose by the tolerance, and holds
// something that may leave. Everywhere else slide_flow() keeps a flow of 0.
SAHEL_HD int32_t starts(int32_t drop, int32_t start, const SlideSide& i, const SlideSide& k) {
    const int32_t forth = smaller(drop - i.repose - start, i.cap);
    const int32_t back = smaller(-drop - k.repose - start, k.cap);
    return larger(larger(forth, back), 0);
}

// The flows of a row of cells, whose rim is one cell wide, to the east and to the row below: of `Count` cells, or of
// those in [begin, end).
template <int32_t Count>
SAHEL_HD int32_t flow_cells(const SlideInertia& rule, const Cells& a, const Cells& b, int32_t* e, int32_t* se,
                            int32_t* s, int32_t* sw, int32_t begin, int32_t end) {
    const SlideInertia r = rule;
    const int32_t stop = Count > 0 ? begin + Count : end;
    int32_t any = 0;
    SAHEL_VECTORIZE
    for (int32_t i = begin; i < stop; ++i) {
        const int32_t c = i + k_first + 1;
        const int32_t h = a.height[c];
        const SlideSide beside{a.repose[c], a.limit[c]};
        const SlideSide across{a.across[c], a.limit[c]};
        const int32_t to_e = slide_flow(r, e[i], h - a.height[c + 1], beside, {a.repose[c + 1], a.limit[c + 1]});
        const int32_t to_se = slide_flow(r, se[i], h - b.height[c + 1], across, {b.across[c + 1], b.limit[c + 1]});
        const int32_t to_s = slide_flow(r, s[i], h - b.height[c], beside, {b.repose[c], b.limit[c]});
        const int32_t to_sw = slide_flow(r, sw[i], h - b.height[c - 1], across, {b.across[c - 1], b.limit[c - 1]});
        any |= set_pairs(e, se, s, sw, i, to_e, to_se, to_s, to_sw);
    }
    return any;
}

// Whether anything moves or starts in k_flow_cells cells from `begin` on.
SAHEL_HD bool flows_there(const SlideInertia& rule, const Cells& a, const Cells& b, const int32_t* e, const int32_t* se,
                          const int32_t* s, const int32_t* sw, int32_t begin) {
    const int32_t start = rule.start_ticks;
    int32_t any = 0;
    SAHEL_VECTORIZE
    for (int32_t i = begin; i < begin + k_flow_cells; ++i) {
        const int32_t c = i + k_first + 1;
        const int32_t h = a.height[c];
        const SlideSide beside{a.repose[c], a.limit[c]};
        const SlideSide across{a.across[c], a.limit[c]};
        any |= (e[i] | se[i]) | (s[i] | sw[i]);
        any |= starts(h - a.height[c + 1], start, beside, {a.repose[c + 1], a.limit[c + 1]});
        any |= starts(h - b.height[c + 1], start, across, {b.across[c + 1], b.limit[c + 1]});
        any |= starts(h - b.height[c], start, beside, {b.repose[c], b.limit[c]});
        any |= starts(h - b.height[c - 1], start, across, {b.across[c - 1], b.limit[c - 1]});
    }
    return any != 0;
}

SAHEL_HD int32_t flow_rows(const SlideInertia& rule, const Cells& a, const Cells& b, int32_t* e, int32_t* se,
                           int32_t* s, int32_t* sw, int32_t begin, int32_t end) {
    int32_t any = 0;
    for (; begin + k_flow_cells <= end; begin += k_flow_cells)
        if (flows_there(rule, a, b, e, se, s, sw, begin))
            any |= flow_cells<k_flow_cells>(rule, a, b, e, se, s, sw, begin, end);
    return any | flow_cells<0>(rule, a, b, e, se, s, sw, begin, end);
}

void flow_strip(const SlideFlows& f, const Strip& strip, Ring& ring) {
    const SlideWork& work = strip.work[0];
    const LocalRect rect = strip.rect();
    const int32_t w = rect.x1 - rect.x0;
    const bool all_give = plain(f.ground, work.slot, rect, 1);
    const int32_t words = used(w + 2);
    int32_t any[k_strip_blocks] = {};
    for (int32_t r = rect.y0; r <= rect.y1; ++r) {
        Cells& now = ring.cells[r & 1];
        load_row<false>(f.ground, work.slot, r, rect.x0 - 1, rect.x1 + 1, all_give, now);
        SAHEL_VECTORIZE
        for (int32_t i = 0; i < words; ++i) now.limit[i] = slide_cap(now.limit[i]);
        if (r == rect.y0) continue;
        const Cells& up = ring.cells[(r - 1) & 1];
        const int32_t y = r - 1;
        int32_t* const e = f.e.row(work.slot, y) + rect.x0;
        int32_t* const se = f.se.row(work.slot, y) + rect.x0;
        int32_t* const s = f.s.row(work.slot, y) + rect.x0;
        int32_t* const sw = f.sw.row(work.slot, y) + rect.x0;
        if (!all_give)
            split_row(f.ground, work.slot, y, rect.x0, rect.x1, 1, [&](int32_t x) {
                const int32_t i = x - rect.x0;
                e[i] = f.ground.remembered(work.slot, x, y, x + 1, y, e[i]);
                se[i] = f.ground.remembered(work.slot, x, y, x + 1, y + 1, se[i]);
                s[i] = f.ground.remembered(work.slot, x, y, x, y + 1, s[i]);
                sw[i] = f.ground.remembered(work.slot, x, y, x - 1, y + 1, sw[i]);
            });
        for (int32_t b = 0; b < strip.count; ++b) {
            const LocalRect& own = strip.work[b].rect;
            any[b] |= flow_rows(f.rule, up, now, e, se, s, sw, own.x0 - rect.x0, own.x1 - rect.x0);
        }
        if (!all_give)
            split_row(f.ground, work.slot, y, rect.x0, rect.x1, 1, [&](int32_t x) {
                const int32_t i = x - rect.x0;
                if (f.ground.sealed(work.slot, x, y, x + 1, y)) e[i] = 0;
                if (f.ground.sealed(work.slot, x, y, x + 1, y + 1)) se[i] = 0;
                if (f.ground.sealed(work.slot, x, y, x, y + 1)) s[i] = 0;
                if (f.ground.sealed(work.slot, x, y, x - 1, y + 1)) sw[i] = 0;
            });
    }
    if (strip.slid)
        for (int32_t b = 0; b < strip.count; ++b) strip.slid[b] = any[b] != 0;
}

void apply_strip(const SlideApply& f, const Strip& strip, Ring&) {
    const SlideWork& work = strip.work[0];
    const LocalRect rect = strip.rect();
    const bool all_live = plain(f.ground, work.slot, rect, 0);
    for (int32_t y = rect.y0; y < rect.y1; ++y) {
        int32_t* const sand = f.sand.row(work.slot, y) + rect.x0;
        const int32_t* const e = f.e.row(work.slot, y) + rect.x0;
        const int32_t* const se = f.se.row(work.slot, y) + rect.x0;
        const int32_t* const s = f.s.row(work.slot, y) + rect.x0;
        const int32_t* const sw = f.sw.row(work.slot, y) + rect.x0;
        const int32_t* const up_se = f.se.row(work.slot, y - 1) + rect.x0;
        const int32_t* const up_s = f.s.row(work.slot, y - 1) + rect.x0;
        const int32_t* const up_sw = f.sw.row(work.slot, y - 1) + rect.x0;
        const auto gather = [&](int32_t x, int32_t x2) {
            const int32_t i = x - rect.x0;
            gather_row<false>(e + i, se + i, s + i, sw + i, up_se + i, up_s + i, up_sw + i, x2 - x, sand + i, sand + i,
                              nullptr);
        };
        const auto ask = [&](int32_t x) {
            if (f.ground.moves(work.slot, x, y)) gather(x, x + 1);
        };
        if (all_live)
            gather(rect.x0, rect.x1);
        else
            split_row(f.ground, work.slot, y, rect.x0, rect.x1, 0, ask, gather);
    }
    if (strip.slid)
        for (int32_t b = 0; b < strip.count; ++b) strip.slid[b] = 0;
}

void probe_strip(const SlideProbe& f, const Strip& strip, Ring& ring) {
    for (int32_t b = 0; b < strip.count; ++b) {
        const bool steep = probe_block(f, strip.work[b], ring);
        if (strip.slid) strip.slid[b] = static_cast<uint8_t>(steep);
    }
}

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

void probe_slides(const SlideLaunch& l, const SlideProbe& f) {
    run_all<SlideProbe, probe_strip>(l, f);
}
void sweep_slides(const SlideLaunch& l, const SlideSweep& f) {
    run_all<SlideSweep, sweep_strip>(l, f);
}
void flow_slides(const SlideLaunch& l, const SlideFlows& f) {
    run_all<SlideFlows, flow_strip>(l, f);
}
void apply_slides(const SlideLaunch& l, const SlideApply& f) {
    run_all<SlideApply, apply_strip>(l, f);
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
