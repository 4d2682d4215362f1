#pragma once

#include "world/field.h"
#include "world/result.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

/// A tile as an OpenEXR file: one channel for each layer that varies, named as the layer; ticks and flags as UINT (the
/// bits of the int32), reals as FLOAT. A layer with one value everywhere is an attribute instead of pixels; layers that
/// are only shown are left out where they are zero. Channel Y is the surface in metres (FLOAT), for programs that show
/// pictures; it is not read back.
namespace sahel {

inline constexpr int k_tile_format_version = 1;

enum class TileCompression { none, zips, zip, piz };
/// Chosen by measurement, see README.md.
inline constexpr TileCompression k_tile_compression = TileCompression::piz;

/// The owned cells of a tile's stored layers. Constant layers take no memory.
struct StoredTile {
    TileKey key;
    int tile_cells = 0;
    LayerSet varying;
    LayerBlock block;                              ///< the varying layers; empty when there is none
    std::array<int32_t, k_layer_count> constant{}; ///< bits, of the others

    [[nodiscard]] uint64_t bytes() const { return sizeof(*this) + block.bytes(); }
    /// Bits of one cell, local coordinates.
    [[nodiscard]] int32_t at(Layer layer, int x, int y) const;
    /// One row from x0 on.
    void copy_row(Layer layer, int x0, int y, int count, int32_t* to) const;
};

/// From a block that holds any of the stored layers; the others are zero.
Result<StoredTile> make_stored_tile(TileKey key, int tile_cells, const LayerBlock& from,
                                    MemoryPool& pool = MemoryPool::host());

/// The bytes of the file. Errors: usage (heights whose sum no int32 holds), io.
Result<std::vector<uint8_t>> encode_tile(const StoredTile& tile, TileCompression compression = k_tile_compression);
/// Errors: corrupt (cut short, damaged, not a tile; `name` in the message), unsupported (a newer version).
Result<StoredTile> decode_tile(std::span<const uint8_t> bytes, const std::string& name,
                               MemoryPool& pool = MemoryPool::host());

} // namespace sahel
