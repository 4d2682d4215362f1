#pragma once

#include "world/dem_raster.h"
#include "world/dem_resample.h"

#include <filesystem>

/// Heights where there are none, drawn in smoothly from the rim.
///
/// The fill approaches the membrane through the rim (Laplace's equation, the rim's heights held fixed) by cascadic
/// multigrid (F. Bornemann, P. Deuflhard, The cascadic multigrid method for elliptic problems, Numer. Math. 75, 1996):
///
///     level 0   rim r, unknown ?          r r r r r .      rim: a cell with data that has an unknown neighbour
///     level 1   mean of the rim cells     r ? ? ? r .      other cells with data (.) take no part at all
///     ...       until nothing is unknown  r ? ? r r .
///     back down: bilinear start from the coarser level, then Gauss-Seidel sweeps, alternately down and up the rows
///
/// Every step is a mean of rim heights, so no filled cell lies above the highest or below the lowest of its rims. Rows
/// without an unknown cell are never touched. Memory: a few rows; the levels lie in scratch files (5/3 bytes per cell).
/// The result does not depend on how anything is cut into windows.
namespace sahel {

/// Sets `ticks` wherever `mask` has k_mask_filled or k_mask_outside; the mask is not changed. There must be a cell with
/// data. Errors: io.
Status fill_dem(ScratchRaster<int32_t>& ticks, const ScratchRaster<DemMask>& mask,
                const std::filesystem::path& scratch);

} // namespace sahel
