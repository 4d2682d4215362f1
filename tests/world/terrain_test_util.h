#pragma once

#include "world/base_terrain.h"
#include "world/noise.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <string>

namespace sahel::test {

inline const LayerSet k_terrain_layers = k_surface_layers.united(k_weight_layers);

inline BaseTerrain terrain_of(std::string_view preset, uint64_t seed = 1, double cell_m = 1.0) {
    return BaseTerrain(seed, base_terrain_preset(preset).value(), cell_m);
}

inline LayerBlock read_rect(const BaseTerrain& terrain, int32_t level, const CellRect& owned, int32_t halo = 0,
                            LayerSet layers = k_terrain_layers) {
    LayerBlock block = LayerBlock::allocate(level, owned, halo, layers).value();
    const Status status = terrain.read(block);
    EXPECT_TRUE(status.ok());
    return block;
}

/// Bits of one element of any layer.
inline uint32_t bits_of(const LayerBlock& block, Layer layer, int32_t x, int32_t y) {
    if (info_of(layer).type == LayerType::real) return std::bit_cast<uint32_t>(block.reals(layer)(x, y));
    return static_cast<uint32_t>(block.ints(layer)(x, y));
}

/// Cells of the common rectangle (halos included) in which any layer differs in any bit.
inline int64_t count_differences(const LayerBlock& a, const LayerBlock& b) {
    const CellRect common = a.rect().intersected(b.rect());
    EXPECT_FALSE(common.empty());
    int64_t different = 0;
    for (int64_t y = common.y0; y < common.y1; ++y)
        for (int64_t x = common.x0; x < common.x1; ++x) {
            bool same = true;
            a.layers().intersected(b.layers()).for_each([&](Layer layer) {
                same = same && bits_of(a, layer, static_cast<int32_t>(x - a.owned().x0),
                                       static_cast<int32_t>(y - a.owned().y0)) ==
                                   bits_of(b, layer, static_cast<int32_t>(x - b.owned().x0),
                                           static_cast<int32_t>(y - b.owned().y0));
            });
            if (!same) ++different;
        }
    return different;
}

/// Order-dependent hash of all layers of a block, halo included.
inline uint64_t hash_of(const LayerBlock& block, uint64_t hash = 0xcbf29ce484222325ull) {
    const CellRect r = block.rect();
    block.layers().for_each([&](Layer layer) {
        for (int32_t y = -block.halo(); y < static_cast<int32_t>(r.height()) - block.halo(); ++y)
            for (int32_t x = -block.halo(); x < static_cast<int32_t>(r.width()) - block.halo(); ++x)
                hash = (hash ^ bits_of(block, layer, x, y)) * 0x100000001b3ull;
    });
    return hash;
}

inline double ground_m(const LayerBlock& block, int32_t x, int32_t y) {
    return static_cast<double>(block.ints(Layer::bedrock)(x, y) + block.ints(Layer::soil)(x, y) +
                               block.ints(Layer::sand)(x, y)) /
           static_cast<double>(k_ticks_per_m);
}

} // namespace sahel::test
