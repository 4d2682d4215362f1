#pragma once

#include "world/field.h"
#include "world/terrain_rows.h"

/// Runs the kernels of the base terrain over a block.
namespace sahel {

/// Fills the surface and weight layers that the block has; `level` may differ from the block's (a larger cell size),
/// heights are multiplied by `stretch`. Host memory.
void read_terrain(const TerrainTables& tables, const TerrainKernels& kernels, int32_t level, float stretch,
                  LayerBlock& block);

/// The same on a device, for a block in CUDA memory. Error: unsupported, without a CUDA backend; io.
Status read_terrain_cuda(const TerrainTables& tables, int32_t level, float stretch, LayerBlock& block);

} // namespace sahel
