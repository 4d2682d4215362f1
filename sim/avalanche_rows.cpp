#include "sim/avalanche_strips.h"

namespace sahel::SAHEL_ISA_NAMESPACE {

namespace {

// What the cells of a row of even sand may give: only asked for where something stands too steep.
void load_limits(const SlideGround& g, int32_t slot, int32_t y, int32_t x0, int32_t x1, Cells& to) {
    const int32_t* const loose = g.sand.row(slot, y) + x0;
    int32_t* const limit = to.limit + k_first;
    const int32_t count = x1 - x0;
    for (int32_t i = 0; i < count; ++i) limit[i] = loose[i];
    for (int32_t i = count; i < used(count) - k_first; ++i) limit[i] = 0;
    close_cells(g, slot, y, x0, x1, limit);
}

// Excess of a pair: above 0 the first gives, below the second. Both slide_excess() in one.
SAHEL_HD int32_t pair_excess(int32_t drop, int32_t first, int32_t second) {
    const int32_t over = larger(drop - first, smaller(drop + second, 0));
    return larger(smaller(over, k_most_excess), -k_most_excess);
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

template <bool Even> void sweep_strip_of(const SlideSweep& f, const Strip& strip, Ring& ring) {
    const SlideGround& g = f.ground;
    const int32_t repose = strip.work[0].repose;
    const LocalRect rect = strip.rect();
    const int32_t slot = strip.work[0].slot;
    const int32_t w = rect.x1 - rect.x0; // cell x of the block is word x - x0 + k_first + k_rim
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
        load_row<Even>(g, slot, r, rect.x0 - k_rim, rect.x1 + k_rim, now);
        if (r == rect.y0 - k_rim) continue;
        Cells& up = ring.cells[i1];
        steep[i1] = pair_rows<Even>(up, now, ring.e[i1], ring.se[i1], ring.s[i1], ring.sw[i1], w + 2 * k_rim, repose);
        if (r == rect.y0 - 1) continue;
        // Shares of row r - 1, from the pairs of rows r - 2 and r - 1.
        if ((steep[i1] | steep[i2]) != 0) {
            if constexpr (Even) load_limits(g, slot, r - 1, rect.x0 - k_rim, rect.x1 + k_rim, up);
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
    for (int32_t r = rect.y0; r <= rect.y1; ++r) {
        Cells& now = ring.cells[r & 1];
        load_row<false>(f.ground, work.slot, r, rect.x0 - 1, rect.x1 + 1, now);
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

void probe_strip(const SlideProbe& f, const Strip& strip, Ring& ring) {
    for (int32_t b = 0; b < strip.count; ++b) {
        const bool steep = probe_block(f, strip.work[b], ring);
        if (strip.slid) strip.slid[b] = static_cast<uint8_t>(steep);
    }
}

} // namespace

void probe_slides(const SlideLaunch& l, const SlideProbe& f) {
    run_all<SlideProbe, probe_strip>(l, f);
}
void sweep_slides(const SlideLaunch& l, const SlideSweep& f) {
    run_all<SlideSweep, sweep_strip>(l, f);
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
