#pragma once

#include "world/params_json.h"

#include <array>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

/// Plant species of an Oasis scene: 26 named numbers, stored in the file as a list `arr` of 30 with four of padding,
/// and a row `dominance` of the competition matrix.
namespace sahel {

inline constexpr int k_max_species = 8;

struct SpeciesParams {
    float max_radius_m = 1.0f;
    float growth_m_per_s = 0.0f;
    float position_adjust = 0.0f;
    float damage_per_s = 0.0f;
    float shrink_m_per_s = 0.0f;
    float maturity_s = 0.0f;
    float maturity_share = 0.0f;
    float stem_height = 0.0f;
    float root_depth = 1.0f;
    float water_use_per_s = 1.0f;
    float water_storage = 0.0f;
    float water_resistance = 0.0f;
    float min_moisture = 0.0f;
    float max_moisture = 0.0f;
    float soil_compatibility = 0.0f;
    float sand_compatibility = 0.0f;
    float min_root_cover = 0.0f;
    float max_stem_cover = 0.0f;
    float max_slope = 0.0f;
    float base_spawn = 0.0f;
    float density_spawn = 0.0f;
    float wind_spawn = 0.0f;
    float humus_m_per_s = 0.0f;
    float min_light = 0.0f;
    float max_light = 1.0f;
    float separation = 0.25f;
    friend bool operator==(const SpeciesParams&, const SpeciesParams&) = default;
};

// clang-format off
template <> inline constexpr auto fields_of<SpeciesParams> = std::tuple{
    Field{&SpeciesParams::max_radius_m,       "maxRadius",                 "m",   1.0e-3f, 20.0f,   "Radius a plant may reach"},
    Field{&SpeciesParams::growth_m_per_s,     "growthRate",                "m/s", 0.0f,    1000.0f, "Growth of the radius"},
    Field{&SpeciesParams::position_adjust,    "positionAdjustRate",        "",    0.0f,    1.0f,    "Share of its offset to the ground that a plant gives up in a step"},
    Field{&SpeciesParams::damage_per_s,       "damageRate",                "1/s", 0.0f,    1.0e6f,  "Loss of health for each unit of damage"},
    Field{&SpeciesParams::shrink_m_per_s,     "shrinkRate",                "m/s", 0.0f,    1000.0f, "Loss of radius where there is no room"},
    Field{&SpeciesParams::maturity_s,         "maxMaturityTime",           "s",   0.0f,    1.0e9f,  "Age at which it must be mature"},
    Field{&SpeciesParams::maturity_share,     "maturityPercentage",        "",    0.0f,    1.0f,    "Share of the largest radius that is mature"},
    Field{&SpeciesParams::stem_height,        "height.x",                  "",    0.0f,    1000.0f, "Height of the stem over the radius"},
    Field{&SpeciesParams::root_depth,         "height.y",                  "",    1.0e-6f, 1000.0f, "Depth of the root over the radius"},
    Field{&SpeciesParams::water_use_per_s,    "waterUsageRate",            "1/s", 1.0e-9f, 1.0e6f,  "Need of water for each volume of stem"},
    Field{&SpeciesParams::water_storage,      "waterStorageCapacity",      "",    0.0f,    1.0e6f,  "Water stored for each volume"},
    Field{&SpeciesParams::water_resistance,   "waterResistance",           "",    0.0f,    1000.0f, "Share of the stem that may be under water; 1 and more: a water plant"},
    Field{&SpeciesParams::min_moisture,       "minMoisture",               "",    -1000.0f, 1000.0f, "Driest ground for seeds"},
    Field{&SpeciesParams::max_moisture,       "maxMoisture",               "",    -1000.0f, 1000.0f, "Wettest ground for seeds"},
    Field{&SpeciesParams::soil_compatibility, "soilCompatibility",         "",    0.0f,    1000.0f, "Weight of soil"},
    Field{&SpeciesParams::sand_compatibility, "sandCompatibility",         "",    0.0f,    1000.0f, "Weight of sand"},
    Field{&SpeciesParams::min_root_cover,     "terrainCoverageResistance.x", "",  -1000.0f, 1000.0f, "Least share of the roots in the ground"},
    Field{&SpeciesParams::max_stem_cover,     "terrainCoverageResistance.y", "",  -1000.0f, 1000.0f, "Greatest share of the stem that may be buried"},
    Field{&SpeciesParams::max_slope,          "maxSlope",                  "",    0.0f,    1000.0f, "Greatest sine of the slope"},
    Field{&SpeciesParams::base_spawn,         "baseSpawnRate",             "1/s", 0.0f,    1.0e9f,  "Base rate of seeds over the map"},
    Field{&SpeciesParams::density_spawn,      "densitySpawnMultiplier",    "",    0.0f,    1.0e9f,  "Gain from plants around"},
    Field{&SpeciesParams::wind_spawn,         "windSpawnMultiplier",       "",    0.0f,    1.0e9f,  "Gain from plants upwind"},
    Field{&SpeciesParams::humus_m_per_s,      "humusRate",                 "m/s", 0.0f,    1.0e6f,  "Humus made at density 1"},
    Field{&SpeciesParams::min_light,          "lightConditions.x",         "",    -1000.0f, 1000.0f, "Lower end of its light"},
    Field{&SpeciesParams::max_light,          "lightConditions.y",         "",    -1000.0f, 1000.0f, "Upper end of its light"},
    Field{&SpeciesParams::separation,         "separation",                "",    0.0f,    1000.0f, "Density of its own kind that stops seeds"},
};
// clang-format on
static_assert(covers_every_member<SpeciesParams> && defaults_in_range<SpeciesParams>);

/// Places of the numbers in `arr`; 7, 17, 25 and 29 are padding.
inline constexpr std::array<int, 26> k_species_places = {0,  1,  2,  3,  4,  5,  6,  8,  9,  10, 11, 12, 13,
                                                         14, 15, 16, 18, 19, 20, 21, 22, 23, 24, 26, 27, 28};

struct SceneSpecies {
    std::string name;
    std::string mesh; ///< a model file of the authors' repository; not read
    SpeciesParams params;
    std::array<float, k_max_species> dominance{1, 1, 1, 1, 1, 1, 1, 1}; ///< how strongly each suppresses this one
};

/// The list `vegTypes`. Errors: usage, naming `where`, the key ("vegTypes[2].arr[4] (shrinkRate)") and the range.
Result<std::vector<SceneSpecies>> parse_scene_species(const Json& list, std::string_view where);

} // namespace sahel
