#pragma once

#include "sim/pass.h"

#include <cstdint>

/// Launches for kernels that want whole rows: some passes are fast only where neighbouring cells can share work (look
/// at contiguous memory, draw no random numbers). For the sources that are compiled for several instruction sets.
namespace sahel {
inline namespace SAHEL_EXECUTOR_NAMESPACE {
namespace row_launch_detail {

template <class F> struct Work {
    const F* kernel;
    const WorkItem* items;
    int32_t count;
    int32_t rows_per_block;
    int32_t blocks_per_item;
    bool backward;
};

template <class F> void run_block(const void* context, int64_t index) {
    const auto& work = *static_cast<const Work<F>*>(context);
    const int64_t i = work.backward ? static_cast<int64_t>(work.count) * work.blocks_per_item - 1 - index : index;
    const WorkItem item = work.items[i / work.blocks_per_item];
    const auto block = static_cast<int32_t>(i % work.blocks_per_item);
    const int32_t y0 = item.rect.y0 + block * work.rows_per_block;
    const int32_t y1 = y0 + work.rows_per_block < item.rect.y1 ? y0 + work.rows_per_block : item.rect.y1;
    if (y0 < y1 && item.rect.x0 < item.rect.x1)
        (*work.kernel)(item.slot, LocalRect{item.rect.x0, y0, item.rect.x1, y1});
}

} // namespace row_launch_detail

/// f(slot, rect) for blocks of whole rows of every item; rect is never empty.
template <class F> void launch_rows(const Launch& l, int32_t rows_per_block, const F& f) {
    if (l.count == 0 || l.bounds.empty()) return;
    const int32_t rows = l.bounds.y1 - l.bounds.y0;
    const int32_t per_item = (rows + rows_per_block - 1) / rows_per_block;
    const row_launch_detail::Work<F> work{
        &f, l.items, l.count, rows_per_block, per_item, l.order == VisitOrder::backward};
    detail::run_blocks(l.name, l.cells, static_cast<int64_t>(l.count) * per_item, &row_launch_detail::run_block<F>,
                       &work);
}

} // namespace SAHEL_EXECUTOR_NAMESPACE
} // namespace sahel
