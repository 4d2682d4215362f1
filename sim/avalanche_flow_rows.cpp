#include "sim/avalanche_strips.h"

namespace sahel::SAHEL_ISA_NAMESPACE {

namespace {

// Cells that are asked together whether anything moves in them: even in blocks with avalanches most do not.
constexpr int32_t k_flow_cells = 16;

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

} // namespace

void flow_slides(const SlideLaunch& l, const SlideFlows& f) {
    run_all<SlideFlows, flow_strip>(l, f);
}
void apply_slides(const SlideLaunch& l, const SlideApply& f) {
    run_all<SlideApply, apply_strip>(l, f);
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
