#include "world/lod_filter.h"

#include <bit>
#include <vector>

namespace sahel {

namespace {

int32_t filtered(const LayerInfo& info, int32_t a, int32_t b, int32_t c, int32_t d) {
    if (info.lod_filter == LodFilter::any_bit) return a | b | c | d;
    if (info.type == LayerType::real) {
        const float sum =
            (std::bit_cast<float>(a) + std::bit_cast<float>(b)) + (std::bit_cast<float>(c) + std::bit_cast<float>(d));
        return std::bit_cast<int32_t>(sum * 0.25f);
    }
    return mean_of_ticks(a, b, c, d);
}

} // namespace

Result<StoredTile> make_parent(TileKey parent, const std::array<const StoredTile*, 4>& children) {
    const int n = children[0]->tile_cells, half = n / 2;
    SAHEL_ASSIGN(LayerBlock block, LayerBlock::allocate(parent.level, tile_rect(parent, n), 0, k_stored_layers));
    std::vector<int32_t> rows(static_cast<size_t>(n) * 2);
    for (int q = 0; q < 4; ++q) {
        const StoredTile& child = *children[static_cast<size_t>(q)];
        SAHEL_CHECK(child.key == parent.child(q));
        SAHEL_CHECK_EQ(child.tile_cells, n);
        k_stored_layers.for_each([&](Layer layer) {
            const LayerInfo& info = info_of(layer);
            for (int y = 0; y < half; ++y) {
                child.copy_row(layer, 0, 2 * y, n, rows.data());
                child.copy_row(layer, 0, 2 * y + 1, n, rows.data() + n);
                const int32_t* top = rows.data();
                const int32_t* bottom = top + n;
                const int x0 = (q & 1) * half, to_y = (q >> 1) * half + y;
                int32_t* to = info.type == LayerType::real ? reinterpret_cast<int32_t*>(block.reals(layer).row(to_y))
                                                           : block.ints(layer).row(to_y);
                for (int x = 0; x < half; ++x)
                    to[x0 + x] = filtered(info, top[2 * x], top[2 * x + 1], bottom[2 * x], bottom[2 * x + 1]);
            }
        });
    }
    return make_stored_tile(parent, n, block);
}

} // namespace sahel
