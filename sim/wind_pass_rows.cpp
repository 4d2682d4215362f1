#include "sim/wind_pass.h"

namespace sahel::SAHEL_ISA_NAMESPACE {

namespace {

constexpr int32_t k_columns = 256; // coarse columns mixed at once
constexpr int32_t k_rows_per_block = 16;

// Cells of whole coarse columns: `count` of them from column 0 of the mixed row on.
template <int32_t shift> void fill_columns(const float* mixed, int32_t count, float* out) {
    constexpr int32_t s = 1 << shift;
    for (int32_t i = 0; i < count; ++i) {
        const float base = mixed[i];
        const float step = mixed[i + 1] - mixed[i];
        for (int32_t k = 0; k < s; ++k) {
            const float part = static_cast<float>(shift == 0 ? 0 : 2 * k + 1) * (0.5f / static_cast<float>(s));
            out[i * s + k] = base + part * step;
        }
    }
}

void fill_columns(int32_t shift, const float* mixed, int32_t count, float* out) {
    switch (shift) {
    case 0:
        return fill_columns<0>(mixed, count, out);
    case 1:
        return fill_columns<1>(mixed, count, out);
    case 2:
        return fill_columns<2>(mixed, count, out);
    default:
        return fill_columns<3>(mixed, count, out);
    }
}

// Cells [x0, x1) of a row, none of them beyond a wall in x.
void fill_row(const WindPass& f, int32_t slot, int32_t y, int32_t x0, int32_t x1) {
    const WindField& w = f.field;
    const WindPass::Place py = f.place(w.y, f.origin[2 * slot + 1] + y);
    const int64_t columns = w.x.coarse;
    const int64_t top = w.y.inside(py.low) * columns;
    const int64_t bottom = w.y.inside(py.low + 1) * columns;
    const int32_t s = 1 << w.shift;
    float mixed[k_columns + 1];
    const auto local = static_cast<int32_t>(f.origin[2 * slot] - w.x.first); // of local x = 0
    // The centre of coarse cell i lies at 2^shift i + lead cells: there column i begins.
    const int32_t lead = s / 2;
    for (int32_t x = x0; x < x1;) {
        const int32_t first = f.place(w.x, f.origin[2 * slot] + x).low;
        const int32_t begin = (first << w.shift) + lead - local; // local x of column `first`
        int32_t end = begin + (k_columns << w.shift);
        end = end < x1 ? end : x1;
        const int32_t count = (end - begin + s - 1) >> w.shift; // columns touched
        const int32_t from = x - begin;                         // cells of the first column that are not ours
        const bool straight = first >= 0 && first + count < w.x.coarse;
        for (int32_t component = 0; component < 2; ++component) {
            const float* plane = component == 0 ? w.wind_x : w.wind_y;
            float* out = (component == 0 ? f.wind_x : f.wind_y).row(slot, y);
            if (straight) {
                const float* a = plane + top + first;
                const float* b = plane + bottom + first;
                for (int32_t i = 0; i <= count; ++i) mixed[i] = WindPass::between(a[i], b[i], py.part);
            } else {
                for (int32_t i = 0; i <= count; ++i) {
                    const int32_t c = w.x.inside(first + i);
                    mixed[i] = WindPass::between(plane[top + c], plane[bottom + c], py.part);
                }
            }
            // Ragged ends cell by cell, what lies between in whole columns.
            const int32_t whole_from = from == 0 ? 0 : 1;
            const int32_t whole_to = (end - begin) >> w.shift;
            const auto cells = [&](int32_t column, int32_t k0, int32_t k1) {
                const float base = mixed[column];
                const float step = mixed[column + 1] - mixed[column];
                for (int32_t k = k0; k < k1; ++k) {
                    const float part = static_cast<float>(w.shift == 0 ? 0 : 2 * k + 1) * f.unit();
                    out[begin + column * s + k] = base + part * step;
                }
            };
            if (whole_from > whole_to) {
                cells(0, from, end - begin);
            } else {
                if (from > 0) cells(0, from, s);
                fill_columns(w.shift, mixed + whole_from, whole_to - whole_from, out + begin + whole_from * s);
                if (whole_to < count) cells(whole_to, 0, end - begin - whole_to * s);
            }
            if (component == 1 && py.flip)
                for (int32_t i = x; i < end; ++i) out[i] = -out[i];
        }
        x = end;
    }
}

struct Work {
    const WindPass* pass;
    const WorkItem* items;
    int32_t count;
    int32_t blocks_per_item;
    bool backward;
};

void run_block(const void* context, int64_t index) {
    const Work& work = *static_cast<const Work*>(context);
    const int64_t i = work.backward ? static_cast<int64_t>(work.count) * work.blocks_per_item - 1 - index : index;
    const WorkItem item = work.items[i / work.blocks_per_item];
    const int32_t y0 = item.rect.y0 + static_cast<int32_t>(i % work.blocks_per_item) * k_rows_per_block;
    const int32_t y1 = y0 + k_rows_per_block < item.rect.y1 ? y0 + k_rows_per_block : item.rect.y1;
    const WindPass f = *work.pass;
    // Beyond walls cell by cell; the rest in rows.
    const auto local = static_cast<int32_t>(f.origin[2 * item.slot] - f.field.x.first);
    int32_t low = item.rect.x0;
    int32_t high = item.rect.x1;
    if (f.field.x.wall_low && low < -local) low = -local < high ? -local : high;
    if (f.field.x.wall_high && high > f.field.x.cells - local)
        high = f.field.x.cells - local > low ? f.field.x.cells - local : low;
    for (int32_t y = y0; y < y1; ++y) {
        for (int32_t x = item.rect.x0; x < low; ++x) f(item.slot, x, y);
        if (low < high) fill_row(f, item.slot, y, low, high);
        for (int32_t x = high; x < item.rect.x1; ++x) f(item.slot, x, y);
    }
}

} // namespace

void run_wind_pass(const Launch& l, const WindPass& f) {
    if (l.count == 0 || l.bounds.empty()) return;
    const int32_t rows = l.bounds.y1 - l.bounds.y0;
    const int32_t per_item = (rows + k_rows_per_block - 1) / k_rows_per_block;
    const Work work{&f, l.items, l.count, per_item, l.order == VisitOrder::backward};
    detail::run_blocks(l.name, l.cells, static_cast<int64_t>(l.count) * per_item, &run_block, &work);
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
