#include "sim/sand_kernels.h"

namespace sahel::SAHEL_ISA_NAMESPACE {

namespace {

// One block of rows of the destination: it takes what the rows within reach give, and adds to its own rows only.
// Blocks therefore never meet, and integers may be added in any order.
//
//     source rows y0 - reach .. y1 + reach - 1   ->   destination rows y0 .. y1 - 1
constexpr int32_t k_rows_per_block = 64;

struct Work {
    const HopLegPass* pass;
    const WorkItem* items;
    int32_t count;
    int32_t blocks_per_item;
    bool backward;
};

void run_block(const void* context, int64_t index) {
    const auto& work = *static_cast<const Work*>(context);
    const int64_t i = work.backward ? static_cast<int64_t>(work.count) * work.blocks_per_item - 1 - index : index;
    const WorkItem item = work.items[i / work.blocks_per_item];
    const auto block = static_cast<int32_t>(i % work.blocks_per_item);
    const HopLegPass f = *work.pass;
    const int32_t s = item.slot;
    const int32_t x0 = item.rect.x0;
    const int32_t x1 = item.rect.x1;
    const int32_t y0 = item.rect.y0 + block * k_rows_per_block;
    const int32_t y1 = y0 + k_rows_per_block < item.rect.y1 ? y0 + k_rows_per_block : item.rect.y1;
    for (int32_t y = y0; y < y1; ++y)
        for (int32_t x = x0; x < x1; ++x) f.to(s, x, y) = 0;
    const int32_t reach = f.radius();
    for (int32_t y = y0 - reach; y < y1 + reach; ++y)
        for (int32_t x = x0 - reach; x < x1 + reach; ++x) {
            const int32_t amount = f.from(s, x, y);
            if (amount == 0) continue;
            const HopLegPass::Target g = f.target(f.wind_x(s, x, y), f.wind_y(s, x, y));
            const HopLegPass::Shares shares = HopLegPass::shares(amount, g.u, g.v);
            for (int32_t k = 0; k < 4; ++k) {
                const int32_t tx = x + g.x + (k & 1);
                const int32_t ty = y + g.y + (k >> 1);
                if (tx >= x0 && tx < x1 && ty >= y0 && ty < y1) f.to(s, tx, ty) += shares.t[k];
            }
        }
}

} // namespace

void run_hop_leg(const Launch& l, const HopLegPass& f) {
    if (l.count == 0 || l.bounds.empty()) return;
    const int32_t rows = l.bounds.y1 - l.bounds.y0;
    const int32_t per_item = (rows + k_rows_per_block - 1) / k_rows_per_block;
    const Work work{&f, l.items, l.count, per_item, l.order == VisitOrder::backward};
    detail::run_blocks(l.name, l.cells, static_cast<int64_t>(l.count) * per_item, &run_block, &work);
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
