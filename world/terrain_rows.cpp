#include "world/terrain_rows.h"

#include "world/terrain_cell_rows.h"
#include "world/terrain_mid_rows.h"
#include "world/terrain_node_rows.h"
#include "world/terrain_spline_rows.h"
#include "world/terrain_water_rows.h"

// Row kernels of the base terrain on the CPU: compiled once per instruction set (cpu_features.h).
namespace sahel::SAHEL_ISA_NAMESPACE {

const TerrainKernels& terrain_kernels() {
    static constexpr TerrainKernels k_kernels{sum_row,     base_row,   lake_row,   stream_row, detail_row,
                                              sharpen_row, spline_row, middle_row, cell_row,   ticks_row};
    return k_kernels;
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
