#include "sim/avalanche_strips.h"

namespace sahel::SAHEL_ISA_NAMESPACE {

namespace {

// Cells that are asked together whether anything moves in them: even in blocks with avalanches most do not.
constexpr int32_t k_flow_cells = 16;

// A row of flows of each direction.
struct FlowRows {
    int32_t *e, *se, *s, *sw;
};

// Not 0 where a pair that lies still starts: it stands steeper than its angle of repose by the tolerance, and holds
// something that may leave. Everywhere else slide_flow() keeps a flow of 0.
SAHEL_HD int32_t starts(int32_t drop, int32_t start, const SlideSide& i, const SlideSide& k) {
    const int32_t forth = smaller(drop - i.repose - start, i.cap);
    const int32_t back = smaller(-drop - k.repose - start, k.cap);
    return larger(larger(forth, back), 0);
}

// The four pairs of cell i of a row, whose rim is one cell wide, to the east and to the row below:
// visit(flows of the pair's direction, drop, side of the cell, side of the other).
template <class Visit>
SAHEL_HD void each_pair(const Cells& a, const Cells& b, const FlowRows& f, int32_t i, const Visit& visit) {
    const int32_t c = i + k_first + 1;
    const int32_t h = a.height[c];
    const SlideSide beside{a.repose[c], a.limit[c]};
    const SlideSide across{a.across[c], a.limit[c]};
    visit(f.e, h - a.height[c + 1], beside, SlideSide{a.repose[c + 1], a.limit[c + 1]});
    visit(f.se, h - b.height[c + 1], across, SlideSide{b.across[c + 1], b.limit[c + 1]});
    visit(f.s, h - b.height[c], beside, SlideSide{b.repose[c], b.limit[c]});
    visit(f.sw, h - b.height[c - 1], across, SlideSide{b.across[c - 1], b.limit[c - 1]});
}

// The flows of the cells [begin, end), or of `Count` from `begin` on; the bits of all that are not 0.
template <int32_t Count>
SAHEL_HD int32_t flow_cells(const SlideInertia& rule, const Cells& a, const Cells& b, const FlowRows& f, int32_t begin,
                            int32_t end) {
    const SlideInertia r = rule;
    const FlowRows rows = f;
    const int32_t stop = Count > 0 ? begin + Count : end;
    int32_t any = 0;
    SAHEL_VECTORIZE
    for (int32_t i = begin; i < stop; ++i)
        each_pair(a, b, rows, i, [&](int32_t* flow, int32_t drop, const SlideSide& here, const SlideSide& there) {
            flow[i] = slide_flow(r, flow[i], drop, here, there);
            any |= flow[i];
        });
    return any;
}

// Whether anything moves or starts in k_flow_cells cells from `begin` on.
SAHEL_HD bool flows_there(const SlideInertia& rule, const Cells& a, const Cells& b, const FlowRows& f, int32_t begin) {
    const int32_t start = rule.start_ticks;
    const FlowRows rows = f;
    int32_t any = 0;
    SAHEL_VECTORIZE
    for (int32_t i = begin; i < begin + k_flow_cells; ++i)
        each_pair(a, b, rows, i, [&](const int32_t* flow, int32_t drop, const SlideSide& here, const SlideSide& there) {
            any |= flow[i] | starts(drop, start, here, there);
        });
    return any != 0;
}

SAHEL_HD int32_t flow_rows(const SlideInertia& rule, const Cells& a, const Cells& b, const FlowRows& f, int32_t begin,
                           int32_t end) {
    int32_t any = 0;
    for (; begin + k_flow_cells <= end; begin += k_flow_cells)
        if (flows_there(rule, a, b, f, begin)) any |= flow_cells<k_flow_cells>(rule, a, b, f, begin, end);
    return any | flow_cells<0>(rule, a, b, f, begin, end);
}

void flow_strip(const SlideFlows& f, const Strip& strip, Ring& ring) {
    const SlideWork& work = strip.work[0];
    const LocalRect rect = strip.rect();
    const int32_t w = rect.x1 - rect.x0;
    const int32_t words = used(w + 2);
    int32_t any[k_strip_blocks] = {};
    for (int32_t r = rect.y0; r <= rect.y1; ++r) {
        Cells& now = ring.cells[r & 1];
        load_row<false>(f.ground, work.slot, r, rect.x0 - 1, rect.x1 + 1, now);
        SAHEL_VECTORIZE
        for (int32_t i = 0; i < words; ++i) now.limit[i] = slide_cap(now.limit[i]);
        if (r == rect.y0) continue;
        const Cells& up = ring.cells[(r - 1) & 1];
        const int32_t y = r - 1;
        int32_t* const e = f.e.row(work.slot, y) + rect.x0;
        int32_t* const se = f.se.row(work.slot, y) + rect.x0;
        int32_t* const s = f.s.row(work.slot, y) + rect.x0;
        int32_t* const sw = f.sw.row(work.slot, y) + rect.x0;
        split_row(f.ground, work.slot, y, rect.x0, rect.x1, 1, [&](int32_t x) {
            const int32_t i = x - rect.x0;
            e[i] = f.ground.remembered(work.slot, x, y, x + 1, y, e[i]);
            se[i] = f.ground.remembered(work.slot, x, y, x + 1, y + 1, se[i]);
            s[i] = f.ground.remembered(work.slot, x, y, x, y + 1, s[i]);
            sw[i] = f.ground.remembered(work.slot, x, y, x - 1, y + 1, sw[i]);
        });
        for (int32_t b = 0; b < strip.count; ++b) {
            const LocalRect& own = strip.work[b].rect;
            any[b] |= flow_rows(f.rule, up, now, {e, se, s, sw}, own.x0 - rect.x0, own.x1 - rect.x0);
        }
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
