#pragma once

#include "world/dem_raster.h"
#include "world/dem_resample.h"

#include <filesystem>
#include <functional>

/// Exact Euclidean distance to the nearest cell of a kind, in cells, for rasters larger than memory.
///
/// The separable transform of Meijster et al. (A general algorithm for computing distance transforms in linear time,
/// 2000) with the lower envelope of Felzenszwalb and Huttenlocher (Distance transforms of sampled functions, 2012): one
/// walk down and one up the rows carry the distance along each column, then each row takes the lower envelope of
/// parabolas. Memory: a few rows.
namespace sahel {

/// `is_target(mask)` says which cells have distance 0. Infinity where there is none. Errors: io.
Result<ScratchRaster<float>> distance_to(const ScratchRaster<DemMask>& mask,
                                         const std::function<bool(DemMask)>& is_target,
                                         const std::filesystem::path& scratch);

} // namespace sahel
