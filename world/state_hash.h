#pragma once

#include "world/exr_tile.h"

#include <array>
#include <compare>
#include <cstdint>
#include <string>
#include <vector>

/// Hash of state over world cells in world order. The unit is a block of 128 x 128 cells that is aligned to the world;
/// tiles are whole numbers of blocks, so the result does not know how the world was cut into tiles.
namespace sahel {

inline constexpr int k_hash_block_cells = 128;

using Digest = std::array<uint64_t, 2>; ///< XXH3, 128 bits

struct BlockDigest {
    int64_t y = 0, x = 0; ///< block coordinates
    Digest digest{};
    friend auto operator<=>(const BlockDigest&, const BlockDigest&) = default;
};

/// The cells of one block as they are hashed: every layer of the state in table order, row by row.
std::vector<int32_t> block_cells(const StoredTile& tile, int block_x, int block_y);
Digest hash_cells(std::span<const int32_t> cells);
/// One digest for each block of the tile.
std::vector<BlockDigest> hash_blocks(const StoredTile& tile);
/// Hash of the whole: blocks in world order with their places. 32 hexadecimal digits.
std::string hash_world(std::vector<BlockDigest> blocks);

/// Checksum of a file's bytes.
Digest checksum(std::span<const uint8_t> bytes);
std::string to_hex(const Digest& digest);

} // namespace sahel
