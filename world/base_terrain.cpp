#include "world/base_terrain.h"

#include "world/check.h"
#include "world/terrain_driver.h"

#include <fmt/format.h>

#include <cmath>

namespace sahel {

BaseTerrain::BaseTerrain(uint64_t seed, const BaseTerrainParams& params, double cell_m)
    : tables_(std::make_unique<const TerrainTables>(make_terrain_tables(seed, params))), cell_m_(cell_m),
      level_shift_(0), stretch_(1.0f) {
    SAHEL_CHECK(cell_m > 0.0);
    while (std::ldexp(1.0, level_shift_ + 1) <= cell_m) ++level_shift_;
    stretch_ = static_cast<float>(cell_m / std::ldexp(1.0, level_shift_));
}

BaseTerrain::~BaseTerrain() = default;

double BaseTerrain::cell_m() const {
    return cell_m_;
}

Status BaseTerrain::read(LayerBlock& block) const {
    const int32_t level = block.level() + level_shift_;
    if (block.level() < 0 || level > k_max_terrain_level)
        return Error{ErrorKind::usage, fmt::format("base terrain: level {} is outside 0 to {}", block.level(),
                                                   k_max_terrain_level - level_shift_)};
    if (block.memory_kind() != MemoryKind::host) return read_terrain_cuda(*tables_, level, stretch_, block);
    read_terrain(*tables_, SAHEL_ISA_CALL(terrain_kernels), level, stretch_, block);
    return {};
}

} // namespace sahel
