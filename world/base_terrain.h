#pragma once

#include "world/params.h"
#include "world/surface_source.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <tuple>

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
    float stream_m = 24.0f;
    float wetland = 0.0f;
    float wind_x = 0.86f;
    float wind_y = 0.50f;
};

// clang-format off
template <> inline constexpr auto fields_of<BaseTerrainParams> = std::tuple{
    Field{&BaseTerrainParams::relief_bias,      "relief_bias",      "",  -2.0f, 2.0f,    "Share of mountains against basins"},
    Field{&BaseTerrainParams::relief_scale,     "relief_scale",     "",  0.0f,  3.0f,    "How strongly relief varies from place to place"},
    Field{&BaseTerrainParams::wetness_bias,     "wetness_bias",     "",  -2.0f, 2.0f,    "Climate: dry below 0, wet above"},
    Field{&BaseTerrainParams::wetness_scale,    "wetness_scale",    "",  0.0f,  3.0f,    "How strongly wetness varies from place to place"},
    Field{&BaseTerrainParams::canyon_bias,      "canyon_bias",      "",  -2.0f, 2.0f,    "Share of canyon country"},
    Field{&BaseTerrainParams::sea,              "sea",              "",  0,     1,       "1: a sea at height 0, 0: inland"},
    Field{&BaseTerrainParams::continent_bias,   "continent_bias",   "",  -2.0f, 2.0f,    "Share of land against sea"},
    Field{&BaseTerrainParams::continent_scale,  "continent_scale",  "",  0.0f,  3.0f,    "How strongly land and sea alternate"},
    Field{&BaseTerrainParams::base_m,           "base_m",           "m", -1000.0f, 4000.0f, "Height of the basins"},
    Field{&BaseTerrainParams::plain_m,          "plain_m",          "m", 0.0f,  500.0f,  "Relief of the plains"},
    Field{&BaseTerrainParams::rise_m,           "rise_m",           "m", 0.0f,  1000.0f, "Rise of the fans towards the mountains"},
    Field{&BaseTerrainParams::mountain_m,       "mountain_m",       "m", 0.0f,  4000.0f, "Height of the mountains"},
    Field{&BaseTerrainParams::gully,            "gully",            "",  0.0f,  2.0f,    "Depth of gullies and valleys"},
    Field{&BaseTerrainParams::dune_m,           "dune_m",           "m", 0.0f,  60.0f,   "Height of dunes, 0: none"},
    Field{&BaseTerrainParams::mega_dune_m,      "mega_dune_m",      "m", 0.0f,  300.0f,  "Height of the large dunes, 0: none"},
    Field{&BaseTerrainParams::sand_supply,      "sand_supply",      "",  0.0f,  3.0f,    "Sand between the dunes: little bares the ground"},
    Field{&BaseTerrainParams::canyon_m,         "canyon_m",         "m", 0.0f,  1500.0f, "Depth of canyons, 0: none"},
    Field{&BaseTerrainParams::mesa,             "mesa",             "",  0.0f,  1.0f,    "Ledges on flat ground too"},
    Field{&BaseTerrainParams::wadi_m,           "wadi_m",           "m", 0.0f,  40.0f,   "Depth of dry valleys, 0: none"},
    Field{&BaseTerrainParams::lake_probability, "lake_probability", "",  0.0f,  1.0f,    "Chance of a lake in each 4 km square that could hold one"},
    Field{&BaseTerrainParams::lake_radius_m,    "lake_radius_m",    "m", 50.0f, 800.0f,  "Size of lakes"},
    Field{&BaseTerrainParams::lake_relief_min,  "lake_relief_min",  "",  -3.0f, 3.0f,    "Lakes lie where relief is above this"},
    Field{&BaseTerrainParams::lake_relief_max,  "lake_relief_max",  "",  -3.0f, 3.0f,    "Lakes lie where relief is below this"},
    Field{&BaseTerrainParams::stream_m,         "stream_m",         "m", 0.0f,  60.0f,   "Width of the streams of a middling lake, 0: none"},
    Field{&BaseTerrainParams::wetland,          "wetland",          "",  0.0f,  1.0f,    "1: flat land of pools and channels at the sea's level"},
    Field{&BaseTerrainParams::wind_x,           "wind_x",           "",  -1.0f, 1.0f,    "Wind that shaped the dunes, to the east (a direction)"},
    Field{&BaseTerrainParams::wind_y,           "wind_y",           "",  -1.0f, 1.0f,    "Wind that shaped the dunes, to the south (a direction)"},
};
// clang-format on
static_assert(covers_every_member<BaseTerrainParams>);

inline constexpr int32_t k_max_terrain_level = 20;

/// oasis, dunes, canyon, mountains, islands, wetland.
std::span<const std::string_view> base_terrain_presets();
/// Error: usage, with the list of names.
Result<BaseTerrainParams> base_terrain_preset(std::string_view name);

/// Thread safe; holds only tables made from the seed and the parameters.
///
/// A cell size other than 1 m reads the same landscape: whole powers of two above 1 sample it at a coarser level, what
/// remains stretches it in all three directions, so that slopes stay what they are.
class BaseTerrain final : public SurfaceSource {
  public:
    BaseTerrain(uint64_t seed, const BaseTerrainParams& params, double cell_m = 1.0);
    ~BaseTerrain() override;

    /// Fills bedrock, soil, sand, water (ticks) and the region weights, whichever the block has; other layers become 0.
    /// Levels 0 to 20; any rectangle, host or CUDA memory; the same bits for any rectangle, tile size, order, thread,
    /// instruction set and device.
    Status read(LayerBlock& block) const override;
    [[nodiscard]] double cell_m() const override;

    [[nodiscard]] const struct TerrainTables& tables() const { return *tables_; }

  private:
    std::unique_ptr<const struct TerrainTables> tables_;
    double cell_m_;
    int32_t level_shift_; ///< a cell of level k samples level k + level_shift_
    float stretch_;       ///< heights and lengths, times
};

} // namespace sahel
