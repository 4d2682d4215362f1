#pragma once

#include "world/dem_raster.h"
#include "world/dem_resample.h"

#include <filesystem>

/// The sea of an imported model: which cells it covers, and a bed where the source has none.
///
/// Sea is what lies at or below sea level and connects to the edge of the data through such cells (4 neighbours): a
/// basin below sea level that the sea cannot reach stays dry. Flooding walks down and up the rows until nothing
/// changes.
///
/// Sources such as SRTM store the sea as a plain at sea level. Where most sea cells lie within half a metre of it, the
/// bed is made up from the distance d to the shore: depth = 0.1 m^(1/3) d^(2/3), the equilibrium profile of beaches in
/// medium sand (R. Dean, Equilibrium beach profiles: US Atlantic and Gulf coasts, 1977), to at most `shelf_m`. Where
/// the source has depths of its own they are kept.
namespace sahel {

struct DemSea {
    int64_t cells = 0; ///< inside the files
    bool made_up_bed = false;
};

/// Depth of a made-up bed at a distance from the shore, m.
float sea_bed_depth_m(float offshore_m, double shelf_m);

/// Sets k_mask_sea inside the files, and lowers `ticks` there to the made-up bed. Errors: io.
Result<DemSea> flood_sea(ScratchRaster<int32_t>& ticks, ScratchRaster<DemMask>& mask, int32_t sea_ticks, double shelf_m,
                         double cell_m, const std::filesystem::path& scratch);

} // namespace sahel
