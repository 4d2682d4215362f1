#pragma once

#include "world/dem_raster.h"
#include "world/dem_resample.h"
#include "world/params.h"

#include <cstdint>
#include <optional>
#include <vector>

/// What lies on the rock of an imported surface: soil and sand, guessed from the shape of the ground. The surface
/// itself is not changed: soil and sand are taken out of the rock.
///
/// Soil: thickness falls linearly with the tangent of the slope, to nothing at `bare_slope` (G.-M. Saulnier, K. Beven,
/// C. Obled, Including spatially variable effective soil depths in TOPMODEL, J. Hydrology 202, 1997), times a factor of
/// position: hollows hold more than ridges (convex ground sheds its soil: A. Heimsath et al., The soil production
/// function and landscape equilibrium, Nature 388, 1997), position being the height above the mean of the surroundings
/// (A. Weiss, Topographic position and landforms analysis, 2001). Sand: a thin sheet on flat valley floors, a beach
/// where land or bed near sea level lies beside the sea.
namespace sahel {

struct DemCoverParams {
    float soil_m = 1.5f;
    float bare_slope = 0.9f;
    float relief_radius_m = 60.0f;
    float sand_m = 0.15f;
    float beach_m = 0.8f;
};
template <>
inline constexpr auto fields_of<DemCoverParams> = std::tuple{
    Field{&DemCoverParams::soil_m, "soil_m", "m", 0.0f, 20.0f, "Soil on level ground; hollows hold up to 1.6 times it"},
    Field{&DemCoverParams::bare_slope, "bare_slope", "m/m", 0.05f, 10.0f, "Slope from which on rock is bare"},
    Field{&DemCoverParams::relief_radius_m, "relief_radius_m", "m", 1.0f, 100000.0f,
          "Half side of the surroundings that tell hollow from ridge (2 to 48 cells)"},
    Field{&DemCoverParams::sand_m, "sand_m", "m", 0.0f, 20.0f, "Sand on flat valley floors"},
    Field{&DemCoverParams::beach_m, "beach_m", "m", 0.0f, 20.0f, "Sand at the shore of the sea"},
};
static_assert(covers_every_member<DemCoverParams> && defaults_in_range<DemCoverParams>);

/// Soil and sand of cells, from the heights around them.
class DemCover {
  public:
    DemCover(const DemCoverParams& params, double cell_m, std::optional<int32_t> sea_ticks);

    /// How far around a cell the estimate looks, cells.
    [[nodiscard]] int64_t reach() const { return reach_; }

    /// `around` is the rectangle of the heights and masks given (row after row); `cells`, inside it, is what is asked
    /// for. Beyond `around` nothing is assumed, so give cells.grown(reach()) as far as the raster goes. Ticks.
    void estimate(const CellRect& around, const int32_t* ground, const DemMask* mask, const CellRect& cells,
                  int32_t* soil, int32_t* sand) const;

  private:
    DemCoverParams params_;
    double cell_m_;
    std::optional<int32_t> sea_ticks_;
    int64_t relief_cells_;
    int64_t slope_cells_;
    int64_t beach_cells_;
    int64_t reach_;
};

} // namespace sahel
