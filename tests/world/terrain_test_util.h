#pragma once

#include "world/base_terrain.h"
#include "world/noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <utility>

namespace sahel::test {

/// Looked at in every preset: the origin, the other side of it, far away, a lake of the oasis, one of its streams.
inline constexpr std::array<Cell, 5> k_places = {Cell{0, 0}, Cell{-2048, 1024},
                                                 Cell{int64_t{4'000'000} * 2048, int64_t{-3'000'000} * 2048},
                                                 Cell{-5351, -6900}, Cell{-26800, -42160}};

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

/// Most height of water above the ground of a dry neighbour, m, and how many cells hold water.
struct Walls {
    double highest_m = 0.0;
    int64_t wet = 0;
};
inline void find_walls(const LayerBlock& block, Walls& walls) {
    const auto n = static_cast<int32_t>(block.owned().width());
    const auto water = block.ints(Layer::water);
    for (int32_t y = 1; y + 1 < n; ++y)
        for (int32_t x = 1; x + 1 < n; ++x) {
            if (water(x, y) == 0) continue;
            ++walls.wet;
            const double surface = ground_m(block, x, y) + static_cast<double>(water(x, y)) / k_ticks_per_m;
            for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}})
                if (water(x + dx, y + dy) == 0)
                    walls.highest_m = std::max(walls.highest_m, surface - ground_m(block, x + dx, y + dy));
        }
}

} // namespace sahel::test
