#include "world/state_hash.h"

#include <fmt/format.h>

#define XXH_STATIC_LINKING_ONLY
#include <xxhash.h>

#include <algorithm>

namespace sahel {

Digest checksum(std::span<const uint8_t> bytes) {
    const XXH128_hash_t h = XXH3_128bits(bytes.data(), bytes.size());
    return {h.high64, h.low64};
}

std::string to_hex(const Digest& d) {
    return fmt::format("{:016x}{:016x}", d[0], d[1]);
}

std::vector<int32_t> block_cells(const StoredTile& tile, int bx, int by) {
    std::vector<int32_t> cells(static_cast<size_t>(k_hash_block_cells) * k_hash_block_cells *
                               static_cast<size_t>(k_state_layers.size()));
    int32_t* to = cells.data();
    k_state_layers.for_each([&](Layer layer) {
        for (int y = 0; y < k_hash_block_cells; ++y, to += k_hash_block_cells)
            tile.copy_row(layer, bx * k_hash_block_cells, by * k_hash_block_cells + y, k_hash_block_cells, to);
    });
    return cells;
}

Digest hash_cells(std::span<const int32_t> cells) {
    return checksum({reinterpret_cast<const uint8_t*>(cells.data()), cells.size() * 4});
}

std::vector<BlockDigest> hash_blocks(const StoredTile& tile) {
    const int side = tile.tile_cells / k_hash_block_cells;
    SAHEL_CHECK_EQ(side * k_hash_block_cells, tile.tile_cells);
    std::vector<BlockDigest> blocks;
    for (int by = 0; by < side; ++by)
        for (int bx = 0; bx < side; ++bx)
            blocks.push_back({tile.key.y * side + by, tile.key.x * side + bx, hash_cells(block_cells(tile, bx, by))});
    return blocks;
}

std::string hash_world(std::vector<BlockDigest> blocks) {
    std::sort(blocks.begin(), blocks.end());
    std::vector<uint64_t> words;
    words.reserve(blocks.size() * 4);
    for (const BlockDigest& b : blocks) {
        words.push_back(static_cast<uint64_t>(b.y));
        words.push_back(static_cast<uint64_t>(b.x));
        words.push_back(b.digest[0]);
        words.push_back(b.digest[1]);
    }
    return to_hex(checksum({reinterpret_cast<const uint8_t*>(words.data()), words.size() * 8}));
}

} // namespace sahel
