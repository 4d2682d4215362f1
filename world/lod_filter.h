#pragma once

#include "world/exr_tile.h"

/// From fine to coarse: a cell of the next level is made of its 2 x 2 cells, by the filter of its layer. Means of ticks
/// are rounded to the nearest, halves up, in 64 bits.
namespace sahel {

/// The parent of four children (index as TileKey::child), all of one size.
Result<StoredTile> make_parent(TileKey parent, const std::array<const StoredTile*, 4>& children);

SAHEL_HD int32_t mean_of_ticks(int64_t a, int64_t b, int64_t c, int64_t d) {
    return static_cast<int32_t>((a + b + c + d + 2) >> 2);
}

} // namespace sahel
