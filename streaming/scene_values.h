#pragma once

#include "world/params.h"

#include <array>
#include <cstdint>
#include <string_view>
#include <tuple>
#include <type_traits>

/// What a published scene file says, key by key, before any of it is interpreted: the numbers keep the meaning and the
/// unit that the authors gave them (amounts per step, reciprocal gains, angles in degrees). One table names every key,
/// its range and which programs write it; the parser, the error messages and the lists of ignored keys come from it.
///
/// Formats: Desertscape of 2023 and of 2025 (GRAPP 2024 paper and its follow-up) and Oasis (2023). Member names follow
/// the keys; units stand in the table.
namespace sahel {

struct SceneValues {
    // grid and time
    std::array<int, 2> grid_size{2048, 2048};
    float grid_scale = 1.0f;
    bool bilinear = true;
    std::string time_mode = "Fixed Delta Time";
    float time_scale = 1.0f;
    float fixed_delta_time = 1.0f;
    int stop_iterations = 0;
    bool export_maps = false;
    // wind
    float wind_speed = 10.0f;
    float wind_angle = 0.0f;
    float second_wind_angle = 45.0f;
    float bidirectional_r = 2.0f;
    float bidirectional_base_time = 15.0f;
    bool bidirectional = false;
    bool bidirectional_strength_based = true;
    float venturi_strength = 0.005f;
    int projection_mode = 2;
    int projection_iterations = 50;
    std::string warping_mode = "None";
    int warping_count = 2;
    float warping_divisor = 1.0f;
    std::array<float, 4> warping_radii{200.0f, 50.0f, 0.0f, 0.0f};
    std::array<float, 4> warping_strengths{0.8f, 0.2f, 0.0f, 0.0f};
    std::array<float, 4> warping_gradient_strengths{30.0f, 5.0f, 0.0f, 0.0f};
    // shadow, echo dunes
    std::string shadow_mode = "Linear";
    float shadow_distance = 10.0f;
    float shadow_min_angle = 10.0f;
    float shadow_max_angle = 15.0f;
    float sticky_strength = 0.0f;
    float sticky_angle = 55.0f;
    std::array<float, 2> sticky_range{0.4f, 2.0f};
    float sticky_max_height = 30.0f;
    // saltation, abrasion, reptation
    std::string saltation_mode = "Forward";
    float saltation_strength = 1.0f;
    float abrasion_strength = 0.0f;
    float soil_abrasion_strength = 0.0f;
    float abrasion_threshold = 0.025f;
    float reptation_strength = 0.0f;
    float reptation_smoothing_strength = 0.0f;
    bool reptation_use_wind_shadow = false;
    // avalanching
    std::string avalanche_mode = "Atomic In-Place";
    int avalanche_iterations = 50;
    float avalanche_strength = 1.0f;
    int avalanche_soft_modulus = 10;
    int avalanche_final_soft = 5;
    float avalanche_angle = 33.0f;
    float vegetation_angle = 45.0f;
    std::string bedrock_mode = "To Sand";
    int bedrock_iterations = 1;
    float bedrock_angle = 68.0f;
    int soil_iterations = 1;
    float soil_angle = 45.0f;
    float vegetation_soil_angle = 68.0f;
    // supply of sand
    bool calc_coverage = false;
    float coverage_threshold = 0.1f;
    bool constant_coverage = false;
    bool constant_coverage_remove = false;
    float target_coverage = 1.0f;
    float coverage_spawn = 1.0f;
    float coverage_subtract = 1.0f;
    int coverage_radius = 100;
    bool coverage_uniform = false;
    int spawn_steps = 10;
    // water and moisture (Oasis)
    float wave_period = 0.02f;
    float wave_strength = 0.005f;
    float wave_depth_scale = 0.1f;
    float rain_strength = 0.001f;
    float rain_period = 0.2f;
    float rain_scale = 30.0f;
    float rain_probability_min = 0.5f;
    float rain_probability_max = 1.0f;
    float rain_height_range = 1000.0f;
    float evaporation_rate = 0.01f;
    float water_border_level = 20.0f;
    float water_level = 0.0f;
    float sediment_capacity = 0.1f;
    float sediment_deposition = 0.1f;
    float sand_dissolution = 0.1f;
    float soil_dissolution = 0.05f;
    float bedrock_dissolution = 0.01f;
    float moisture_capacity = 1.0f;
    float moisture_thickness = 1.0f;
    float sand_moisture_rate = 0.1f;
    float soil_moisture_rate = 0.02f;
    float moisture_evaporation_scale = 0.05f;
    int max_plants = 1000000;
    int plant_types = 0;
    // colours (RGBA, 0 to 1; alpha of an overlay switches it)
    std::array<float, 4> sand_colour{0.9f, 0.8f, 0.6f, 1.0f};
    std::array<float, 4> bedrock_colour{0.5f, 0.5f, 0.5f, 1.0f};
    std::array<float, 4> shadow_colour{1.0f, 0.25f, 0.25f, 1.0f};
    std::array<float, 4> vegetation_colour{0.25f, 0.75f, 0.25f, 1.0f};
    std::array<float, 4> erosion_colour{0.0f, 0.0f, 1.0f, 1.0f};
    std::array<float, 4> sticky_colour{1.0f, 1.0f, 0.0f, 1.0f};
    std::array<float, 4> object_colour{0.75f, 0.25f, 0.75f, 1.0f};
    std::array<float, 4> soil_colour{0.55f, 0.35f, 0.2f, 1.0f};
    std::array<float, 4> water_colour{0.1f, 0.4f, 1.0f, 1.0f};
    std::array<float, 4> humus_colour{0.35f, 0.3f, 0.15f, 0.0f};
    std::array<float, 4> wet_colour{0.0f, 0.0f, 0.0f, 0.1f};

    friend bool operator==(const SceneValues&, const SceneValues&) = default;
};

/// Which programs write a key.
enum class SceneKeyIn : uint8_t { both, dunes, oasis };

/// Whether a Desertscape file must have it. (Oasis files may lack any key.)
enum class SceneKeyNeed : uint8_t { required, optional };

namespace detail {
template <class T> struct SceneElement { using type = T; };
template <class T, size_t n> struct SceneElement<std::array<T, n>> { using type = T; };
template <> struct SceneElement<std::string> { using type = size_t; };
} // namespace detail

template <class T> struct SceneKey {
    using value_type = T;
    using bound_type = typename detail::SceneElement<T>::type; ///< of each element; of a text: of its length
    T SceneValues::*member;
    std::string_view key;
    std::string_view unit;
    bound_type min;
    bound_type max;
    SceneKeyIn in;
    SceneKeyNeed need;
    std::string_view help;
};
template <class T, class Min, class Max>
SceneKey(T SceneValues::*, const char*, const char*, Min, Max, SceneKeyIn, SceneKeyNeed, const char*) -> SceneKey<T>;

// clang-format off
inline constexpr auto k_scene_keys = [] {
    using enum SceneKeyIn;
    using enum SceneKeyNeed;
    using V = SceneValues;
    return std::tuple{
    SceneKey{&V::grid_size,                  "gridSize",                     "cells",  1,        16384,    both,  required, "Cells along x and y"},
    SceneKey{&V::grid_scale,                 "gridScale",                    "m",      0.01f,    1000.0f,  both,  required, "Side of a cell"},
    SceneKey{&V::bilinear,                   "bilinear",                     "",       false,    true,     both,  required, "Bilinear samples and landings; else the nearest cell"},
    SceneKey{&V::time_mode,                  "timeMode",                     "",       0u,       64u,      both,  required, "Fixed Delta Time, or the time of a frame"},
    SceneKey{&V::time_scale,                 "timeScale",                    "",       1.0e-3f,  1000.0f,  both,  required, "Factor on the step"},
    SceneKey{&V::fixed_delta_time,           "fixedDeltaTime",               "s",      1.0e-3f,  100.0f,   both,  required, "Length of a step"},
    SceneKey{&V::stop_iterations,            "stopIterations",               "steps",  0,        1000000,  both,  required, "The published program stops here, 0: never"},
    SceneKey{&V::export_maps,                "exportMaps",                   "",       false,    true,     both,  optional, "Maps lie beside the file"},
    SceneKey{&V::wind_speed,                 "windSpeed",                    "m/s",    0.0f,     60.0f,    both,  required, "Speed of the undisturbed wind"},
    SceneKey{&V::wind_angle,                 "windAngle",                    "deg",    -36000.0f, 36000.0f, both, required, "Its direction"},
    SceneKey{&V::second_wind_angle,          "secondWindAngle",              "deg",    -36000.0f, 36000.0f, both, required, "Direction of the second wind"},
    SceneKey{&V::bidirectional_r,            "windBidirectionalR",           "",       0.01f,    100.0f,   both,  required, "Ratio of the first wind to the second"},
    SceneKey{&V::bidirectional_base_time,    "windBidirectionalBaseTime",    "s",      0.01f,    1.0e9f,   both,  required, "Length of one turn"},
    SceneKey{&V::bidirectional,              "enableBidirectional",          "",       false,    true,     both,  required, "Two winds take turns"},
    SceneKey{&V::bidirectional_strength_based, "bidirectionalStrengthBased", "",       false,    true,     both,  required, "The ratio is one of speeds, else of times"},
    SceneKey{&V::venturi_strength,           "venturiStrength",              "1/m",    0.0f,     1.0f,     both,  required, "Growth of the wind with height"},
    SceneKey{&V::projection_mode,            "projectionMode",               "",       0,        2,        both,  optional, "Removal of divergence: 0 none, 1 Jacobi, 2 FFT"},
    SceneKey{&V::projection_iterations,      "pressureProjectionIterations", "",       0,        1000000,  both,  optional, "Iterations of the Jacobi mode"},
    SceneKey{&V::warping_mode,               "windWarpingMode",              "",       0u,       64u,      both,  required, "None or Standard"},
    SceneKey{&V::warping_count,              "windWarpingCount",             "",       0,        4,        both,  required, "Gaussians used"},
    SceneKey{&V::warping_divisor,            "windWarpingDivisor",           "",       0.001f,   1.0e6f,   both,  required, "Reciprocal of the gain of slopes"},
    SceneKey{&V::warping_radii,              "windWarpingRadii",             "m",      0.0f,     1.0e4f,   both,  required, "Two standard deviations of each Gaussian"},
    SceneKey{&V::warping_strengths,          "windWarpingStrengths",         "",       0.0f,     100.0f,   both,  required, "Weight of each"},
    SceneKey{&V::warping_gradient_strengths, "windWarpingGradientStrengths", "m/s",    0.0f,     1000.0f,  both,  required, "Deflection of each at slope 1"},
    SceneKey{&V::shadow_mode,                "windShadowMode",               "",       0u,       64u,      both,  required, "Linear or Curved"},
    SceneKey{&V::shadow_distance,            "windShadowDistance",           "m",      0.0f,     1000.0f,  both,  required, "How far upwind shelter is looked for"},
    SceneKey{&V::shadow_min_angle,           "minWindShadowAngle",           "deg",    0.0f,     89.0f,    both,  required, "No shadow below"},
    SceneKey{&V::shadow_max_angle,           "maxWindShadowAngle",           "deg",    0.1f,     89.5f,    both,  required, "Full shadow above"},
    SceneKey{&V::sticky_strength,            "stickyStrength",               "m/step", 0.0f,     10.0f,    dunes, required, "Lift at the foot of cliffs"},
    SceneKey{&V::sticky_angle,               "stickyAngle",                  "deg",    1.0f,     89.5f,    dunes, required, "A cliff is steeper"},
    SceneKey{&V::sticky_range,               "stickyRange",                  "m/m",    0.0f,     100.0f,   dunes, required, "Reach of erosion and of calm, for each metre of cliff"},
    SceneKey{&V::sticky_max_height,          "maxStickyHeight",              "m",      0.1f,     1000.0f,  dunes, required, "Higher cliffs act like this one"},
    SceneKey{&V::saltation_mode,             "saltationMode",                "",       0u,       64u,      both,  required, "Forward, Backward, Continuous (2023)"},
    SceneKey{&V::saltation_strength,         "saltationStrength",            "m/step", 0.0f,     10.0f,    both,  required, "Sand lifted"},
    SceneKey{&V::abrasion_strength,          "abrasionStrength",             "",       0.0f,     10.0f,    both,  required, "Wear of rock"},
    SceneKey{&V::soil_abrasion_strength,     "soilAbrasionStrength",         "",       0.0f,     10.0f,    oasis, optional, "Wear of soil"},
    SceneKey{&V::abrasion_threshold,         "abrasionThreshold",            "m",      0.0f,     10.0f,    both,  required, "More sand than this protects the ground"},
    SceneKey{&V::reptation_strength,         "reptationStrength",            "s/m2",   0.0f,     100.0f,   both,  required, "Lowering of the angle of repose; in files of 2023 the smoothing"},
    SceneKey{&V::reptation_smoothing_strength, "reptationSmoothingStrength", "s/m",    0.0f,     100.0f,   both,  optional, "Smoothing, times the wind"},
    SceneKey{&V::reptation_use_wind_shadow,  "reptationUseWindShadow",       "",       false,    true,     both,  optional, "Shadow keeps the angle of repose"},
    SceneKey{&V::avalanche_mode,             "avalancheMode",                "",       0u,       64u,      dunes, required, "Scheme of avalanching"},
    SceneKey{&V::avalanche_iterations,       "avalancheIterations",          "",       1,        10000,    both,  required, "Sweeps of sand in a step"},
    SceneKey{&V::avalanche_strength,         "avalancheStrength",            "",       0.01f,    1.0f,     dunes, required, "Strength of soft sweeps"},
    SceneKey{&V::avalanche_soft_modulus,     "avalancheSoftIterationModulus", "",      1,        10000,    dunes, required, "Every so many sweeps one is soft"},
    SceneKey{&V::avalanche_final_soft,       "avalancheFinalSoftIterations", "",       0,        10000,    dunes, required, "and so many at the end"},
    SceneKey{&V::avalanche_angle,            "avalancheAngle",               "deg",    1.0f,     80.0f,    both,  required, "Repose of sand"},
    SceneKey{&V::vegetation_angle,           "vegetationAngle",              "deg",    1.0f,     85.0f,    both,  required, "Repose of sand under dense plants"},
    SceneKey{&V::bedrock_mode,               "bedrockAvalancheMode",         "",       0u,       64u,      both,  required, "To Sand or To Bedrock"},
    SceneKey{&V::bedrock_iterations,         "bedrockAvalancheIterations",   "",       -1000,    1000,     both,  required, "Sweeps of rock in a step"},
    SceneKey{&V::bedrock_angle,              "bedrockAngle",                 "deg",    1.0f,     89.5f,    both,  required, "Repose of rock"},
    SceneKey{&V::soil_iterations,            "soilAvalancheIterations",      "",       0,        1000,     oasis, optional, "Sweeps of soil in a step"},
    SceneKey{&V::soil_angle,                 "soilAngle",                    "deg",    1.0f,     85.0f,    oasis, optional, "Repose of soil"},
    SceneKey{&V::vegetation_soil_angle,      "vegetationSoilAngle",          "deg",    1.0f,     88.0f,    oasis, optional, "Repose of soil under dense plants"},
    SceneKey{&V::calc_coverage,              "calcCoverage",                 "",       false,    true,     both,  required, "Measure the covered share"},
    SceneKey{&V::coverage_threshold,         "coverageThreshold",            "m",      0.0f,     100.0f,   both,  required, "Covered by more sand than this"},
    SceneKey{&V::constant_coverage,          "constantCoverage",             "",       false,    true,     both,  required, "Keep that share, if it is measured"},
    SceneKey{&V::constant_coverage_remove,   "constantCoverageAllowRemove",  "",       false,    true,     both,  required, "by removing sand too"},
    SceneKey{&V::target_coverage,            "targetCoverage",               "",       0.0f,     1.0f,     both,  required, "The share"},
    SceneKey{&V::coverage_spawn,             "coverageSpawnAmount",          "m",      0.0f,     100.0f,   both,  required, "Mean thickness added at once"},
    SceneKey{&V::coverage_subtract,          "coverageSubtractAmount",       "m",      0.0f,     100.0f,   both,  required, "Mean thickness removed at once"},
    SceneKey{&V::coverage_radius,            "coverageRadius",               "cells",  0,        100000,   both,  required, "Radius of the disc that gets sand"},
    SceneKey{&V::coverage_uniform,           "coverageSpawnUniform",         "",       false,    true,     both,  required, "Sand falls everywhere, else on a disc"},
    SceneKey{&V::spawn_steps,                "spawnSteps",                   "steps",  1,        1000000,  both,  required, "Steps between two events"},
    SceneKey{&V::wave_period,                "wavePeriod",                   "rad/s",  0.0f,     1000.0f,  oasis, optional, "Angular frequency of waves"},
    SceneKey{&V::wave_strength,              "waveStrength",                 "s",      0.0f,     1000.0f,  oasis, optional, "Head of waves, per speed of wind"},
    SceneKey{&V::wave_depth_scale,           "waveDepthScale",               "1/m",    0.0f,     1000.0f,  oasis, optional, "Fade of waves towards the shore"},
    SceneKey{&V::rain_strength,              "rainStrength",                 "m/step", 0.0f,     100.0f,   oasis, optional, "Water added where it rains"},
    SceneKey{&V::rain_period,                "rainPeriod",                   "1/s",    0.0f,     1000.0f,  oasis, optional, "Frequency of the rain's noise"},
    SceneKey{&V::rain_scale,                 "rainScale",                    "",       0.0f,     10000.0f, oasis, optional, "Cells of that noise along the longer side"},
    SceneKey{&V::rain_probability_min,       "rainProbabilityMin",           "",       0.0f,     10.0f,    oasis, optional, "Threshold at height 0"},
    SceneKey{&V::rain_probability_max,       "rainProbabilityMax",           "",       0.0f,     10.0f,    oasis, optional, "Threshold at the height range"},
    SceneKey{&V::rain_height_range,          "rainProbabilityHeightRange",   "m",      0.0f,     1.0e6f,   oasis, optional, "Height at which it is full"},
    SceneKey{&V::evaporation_rate,           "evaporationRate",              "1/s",    0.0f,     100.0f,   oasis, optional, "of standing water"},
    SceneKey{&V::water_border_level,         "waterBorderLevel",             "m",      -16000.0f, 16000.0f, oasis, optional, "Least level of water at the border"},
    SceneKey{&V::water_level,                "waterLevel",                   "m",      -16000.0f, 16000.0f, oasis, optional, "Least level of water everywhere"},
    SceneKey{&V::sediment_capacity,          "sedimentCapacityConstant",     "s/m2",   0.0f,     1000.0f,  oasis, optional, "Sediment that water carries"},
    SceneKey{&V::sediment_deposition,        "sedimentDepositionConstant",   "1/s",    0.0f,     1000.0f,  oasis, optional, "Rate of settling"},
    SceneKey{&V::sand_dissolution,           "sandDissolutionConstant",      "1/s",    0.0f,     1000.0f,  oasis, optional, "Rate at which sand is taken"},
    SceneKey{&V::soil_dissolution,           "soilDissolutionConstant",      "1/s",    0.0f,     1000.0f,  oasis, optional, "Rate at which soil is taken"},
    SceneKey{&V::bedrock_dissolution,        "bedrockDissolutionConstant",   "1/s",    0.0f,     1000.0f,  oasis, optional, "Rate at which rock is taken"},
    SceneKey{&V::moisture_capacity,          "moistureCapacityConstant",     "",       0.0f,     1000.0f,  oasis, optional, "Water that ground holds"},
    SceneKey{&V::moisture_thickness,         "terrainThicknessMoistureThreshold", "m", 0.0f,     1000.0f,  oasis, optional, "Thickness that holds all of it"},
    SceneKey{&V::sand_moisture_rate,         "sandMoistureRate",             "",       0.0f,     1000.0f,  oasis, optional, "Seepage into sand"},
    SceneKey{&V::soil_moisture_rate,         "soilMoistureRate",             "",       0.0f,     1000.0f,  oasis, optional, "Seepage into soil"},
    SceneKey{&V::moisture_evaporation_scale, "moistureEvaporationScale",     "",       0.0f,     1000.0f,  oasis, optional, "Drying of ground"},
    SceneKey{&V::max_plants,                 "maxVegCount",                  "plants", 0,        100000000, oasis, optional, "Room for plants"},
    SceneKey{&V::plant_types,                "vegTypeCount",                 "",       0,        8,        oasis, optional, "Species in vegTypes"},
    SceneKey{&V::sand_colour,                "sandColor",                    "",       0.0f,     1.0f,     both,  optional, "RGBA"},
    SceneKey{&V::bedrock_colour,             "bedrockColor",                 "",       0.0f,     1.0f,     both,  optional, "RGBA"},
    SceneKey{&V::shadow_colour,              "windShadowColor",              "",       0.0f,     1.0f,     both,  optional, "RGBA"},
    SceneKey{&V::vegetation_colour,          "vegetationColor",              "",       0.0f,     1.0f,     both,  optional, "RGBA"},
    SceneKey{&V::erosion_colour,             "erosionColor",                 "",       0.0f,     1.0f,     dunes, optional, "RGBA"},
    SceneKey{&V::sticky_colour,              "stickyColor",                  "",       0.0f,     1.0f,     dunes, optional, "RGBA"},
    SceneKey{&V::object_colour,              "objectColor",                  "",       0.0f,     1.0f,     dunes, optional, "RGBA"},
    SceneKey{&V::soil_colour,                "soilColor",                    "",       0.0f,     1.0f,     oasis, optional, "RGBA"},
    SceneKey{&V::water_colour,               "waterColor",                   "",       0.0f,     1.0f,     oasis, optional, "RGBA"},
    SceneKey{&V::humus_colour,               "humusColor",                   "",       0.0f,     1.0f,     oasis, optional, "RGBA"},
    SceneKey{&V::wet_colour,                 "wetColor",                     "",       0.0f,     1.0f,     oasis, optional, "RGBA"},
    };
}();
// clang-format on

/// Calls f(row) for every key.
template <class F> constexpr void for_each_scene_key(F&& f) {
    std::apply([&](const auto&... row) { (f(row), ...); }, k_scene_keys);
}

} // namespace sahel
