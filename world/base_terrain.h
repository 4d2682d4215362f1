#pragma once

#include "world/params.h"
#include "world/surface_source.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

/// Endless procedural landscape: bedrock, soil, sand and water as a pure function of (seed, level, int64 cell).
namespace sahel {

/// Constants of a landscape. Defaults are the "oasis" preset.
struct BaseTerrainParams {
    float relief_bias = 0.05f;
    float relief_scale = 1.0f;
    float wetness_bias = -0.10f;
    float wetness_scale = 0.8f;
    float canyon_bias = -0.9f;
    int sea = 0;
    float continent_bias = 0.0f;
    float continent_scale = 1.0f;
    float base_m = 300.0f;
    float plain_m = 30.0f;
    float rise_m = 150.0f;
    float mountain_m = 980.0f;
    float gully = 1.0f;
    float dune_m = 13.0f;
    float mega_dune_m = 70.0f;
    float sand_supply = 1.0f;
    float canyon_m = 60.0f;
    float mesa = 0.25f;
    float wadi_m = 9.0f;
    float lake_probability = 0.75f;
    float lake_radius_m = 420.0f;
    float lake_relief_min = -0.22f;
    float lake_relief_max = 0.30f;
    float wetland = 0.0f;
    float wind_x = 0.86f;
    float wind_y = 0.50f;
};

/// oasis, dunes, canyon, mountains, islands, wetland.
std::span<const std::string_view> base_terrain_presets();
/// Error: usage, with the list of names.
Result<BaseTerrainParams> base_terrain_preset(std::string_view name);

/// Thread safe; holds only tables made from the seed and the parameters.
class BaseTerrain final : public SurfaceSource {
  public:
    BaseTerrain(uint64_t seed, const BaseTerrainParams& params, double cell_m = 1.0);
    ~BaseTerrain() override;

    /// Fills bedrock, soil, sand, water (ticks) and the region weights, whichever the block has; other layers become 0.
    /// Levels 0 to 20; any rectangle; the same bits for any rectangle, tile size, order, thread and instruction set.
    Status read(LayerBlock& block) const override;
    [[nodiscard]] double cell_m() const override;

    struct Tables;

  private:
    std::unique_ptr<const Tables> tables_;
};

} // namespace sahel
