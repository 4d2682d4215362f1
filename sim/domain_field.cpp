#include "sim/domain_field.h"

#include "world/field.h"

#include <algorithm>

namespace sahel {

Result<std::vector<float>> field_of(const TileDomain& domain, SimLayer layer) {
    const std::vector<TileKey>& tiles = domain.layout().tiles;
    std::vector<float> out;
    if (tiles.empty()) return out;
    TileKey first = tiles.front();
    TileKey last = first;
    for (const TileKey& key : tiles) {
        first.x = std::min(first.x, key.x);
        first.y = std::min(first.y, key.y);
        last.x = std::max(last.x, key.x);
        last.y = std::max(last.y, key.y);
    }
    const int64_t n = domain.tile_cells();
    const int64_t width = (int64_t{last.x} - first.x + 1) * n;
    out.assign(static_cast<size_t>(width * (int64_t{last.y} - first.y + 1) * n), 0.0f);
    const LayerType type = info_of(layer).type;
    std::vector<int32_t> cells(static_cast<size_t>(n * n));
    for (int32_t slot = 0; slot < domain.slots(); ++slot) {
        SAHEL_TRY(domain.store(slot, layer, cells.data()));
        const TileKey key = tiles[static_cast<size_t>(slot)];
        const int32_t* word = cells.data();
        for (int64_t y = 0; y < n; ++y) {
            float* row = out.data() + ((int64_t{key.y} - first.y) * n + y) * width + (int64_t{key.x} - first.x) * n;
            for (int64_t x = 0; x < n; ++x, ++word)
                row[x] = type == LayerType::ticks  ? metres_of_ticks(*word)
                         : type == LayerType::real ? __builtin_bit_cast(float, *word)
                                                   : static_cast<float>(*word);
        }
    }
    return out;
}

} // namespace sahel
