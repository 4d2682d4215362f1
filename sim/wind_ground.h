#pragma once

#include "sim/slab_view.h"
#include "sim/wind_pass.h"
#include "world/cpu_features.h"
#include "world/result.h"

#include <cstdint>

/// The ground that the wind feels: sums of ticks over the cells of each coarse cell, exact in 64 bits. Only owned cells
/// are read, each once, so the sums know nothing of tiles and halos.
namespace sahel {

struct GroundSums {
    static constexpr int k_layers = 4;
    SlabView<const int32_t> layer[k_layers]; ///< bedrock, soil, sand, water: those that there are
    int32_t layers = 0;
    int32_t shift = 0;      ///< spacing = 2^shift cells
    int32_t n = 0;          ///< coarse cells along a tile
    int64_t* out = nullptr; ///< [slot][row][column]

    /// The sum of one coarse cell of a slot.
    [[nodiscard]] SAHEL_HD int64_t sum(int32_t slot, int32_t x, int32_t y) const {
        const int32_t s = 1 << shift;
        int64_t total = 0;
        for (int32_t l = 0; l < layers; ++l)
            for (int32_t j = 0; j < s; ++j) {
                const int32_t* row = layer[l].row(slot, y * s + j) + x * s;
                for (int32_t i = 0; i < s; ++i) total += row[i];
            }
        return total;
    }
};

SAHEL_ISA_DECLARE(void run_ground_sums(const GroundSums& f, int32_t slots))
/// `f.layer` is device memory; `f.out` is memory of the host.
Status run_ground_sums_cuda(const GroundSums& f, int32_t slots);

} // namespace sahel
