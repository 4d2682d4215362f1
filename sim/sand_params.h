#pragma once

#include "world/params.h"

#include <tuple>

/// Parameters of the sand: shelter, echo dunes, saltation, reptation, avalanches, supply. Rates are per second: the
/// length of a step decides how finely they are followed, not how much moves. Names and defaults follow the Desertscape
/// paper (GRAPP 2024), whose amounts per step of one second these are.
namespace sahel {

inline constexpr int k_sweeps_until_quiet = 10000; ///< a bound for runs that wait until nothing slides

struct SandParams {
    float step_s = 1.0f;
    float hop_s = 1.0f;
    // shelter
    bool shadow_curved = false;
    float shadow_length_m = 10.0f;
    float shadow_min_deg = 10.0f;
    float shadow_max_deg = 15.0f;
    // echo dunes
    float echo_rate_m_per_s = 0.0f;
    float echo_cliff_deg = 55.0f;
    float echo_erosion_range = 0.4f;
    float echo_sticky_range = 2.0f;
    float echo_max_cliff_m = 30.0f;
    // saltation
    bool bilinear = true;
    float lift_rate_m_per_s = 1.0f;
    float bounce_threshold_m = 0.0f;
    float abrasion = 0.0f;
    float soil_abrasion = 0.0f;
    bool abrasion_by_amount = true;
    float abrasion_threshold_m = 0.025f;
    // wet ground
    float moisture_capacity_m = 1.0f;
    float moisture_depth_m = 1.0f;
    // reptation
    float reptation_smooth = 0.0f;
    float reptation_smooth_wind_s_per_m = 0.0f;
    float reptation_repose_s2_per_m2 = 0.0f;
    bool reptation_shadowed = false;
    // avalanches
    int avalanche_sweeps = 0;
    int avalanche_max_sweeps = 200;
    float avalanche_tolerance = 0.004f;
    float avalanche_strength = 1.0f;
    int avalanche_soft_every = 10;
    int avalanche_soft_last = 5;
    float repose_deg = 33.0f;
    float repose_plants_deg = 45.0f;
    int soil_sweeps = 1;
    float soil_repose_deg = 45.0f;
    float soil_repose_plants_deg = 68.0f;
    int bedrock_sweeps = 1;
    float bedrock_repose_deg = 68.0f;
    bool bedrock_to_sand = true;
    // supply
    bool supply = false;
    bool supply_removes = false;
    bool supply_uniform = false;
    float supply_target = 1.0f;
    float supply_threshold_m = 0.1f;
    float supply_add_m = 1.0f;
    float supply_remove_m = 1.0f;
    int supply_radius_cells = 100;
    int supply_every_steps = 10;
};

// clang-format off
template <> inline constexpr auto fields_of<SandParams> = std::tuple{
    Field{&SandParams::step_s,                        "step",                  "s",    1.0e-3f, 100.0f,  "Length of a step"},
    Field{&SandParams::hop_s,                         "hop",                   "s",    1.0e-2f, 100.0f,  "Time that a grain is carried before it may settle; a longer step is run in parts"},
    Field{&SandParams::shadow_curved,                 "shadow_curved",         "",     false,   true,    "Look for shelter along the curved wind, not along a line"},
    Field{&SandParams::shadow_length_m,               "shadow_length",         "m",    0.0f,    1000.0f, "How far upwind shelter is looked for"},
    Field{&SandParams::shadow_min_deg,                "shadow_min",            "deg",  0.0f,    89.0f,   "No shelter where ground rises upwind by less than this"},
    Field{&SandParams::shadow_max_deg,                "shadow_max",            "deg",  0.1f,    89.5f,   "Full shelter where it rises by more"},
    Field{&SandParams::echo_rate_m_per_s,             "echo_rate",             "m/s",  0.0f,    10.0f,   "Lift at the foot of cliffs, 0: no echo dunes"},
    Field{&SandParams::echo_cliff_deg,                "echo_cliff",            "deg",  1.0f,    89.5f,   "A cliff is steeper than this"},
    Field{&SandParams::echo_erosion_range,            "echo_erosion_range",    "m/m",  0.0f,    100.0f,  "Reach of that lift, for each metre of cliff"},
    Field{&SandParams::echo_sticky_range,             "echo_sticky_range",     "m/m",  0.0f,    100.0f,  "Reach of the calm before a cliff, for each metre of it"},
    Field{&SandParams::echo_max_cliff_m,              "echo_max_cliff",        "m",    0.1f,    1000.0f, "Higher cliffs act like one of this height"},
    Field{&SandParams::bilinear,                      "bilinear",              "",     false,   true,    "Sand lands on the four cells around its target; else on the nearest"},
    Field{&SandParams::lift_rate_m_per_s,             "lift_rate",             "m/s",  0.0f,    10.0f,   "Sand lifted from open ground"},
    Field{&SandParams::bounce_threshold_m,            "bounce_threshold",      "m",    0.0f,    10.0f,   "Grains bounce off more sand than this as off sand, else as off soil or rock"},
    Field{&SandParams::abrasion,                      "abrasion",              "",     0.0f,    10.0f,   "Rock worn for each metre of sand that bounces, for each metre of wind"},
    Field{&SandParams::soil_abrasion,                 "soil_abrasion",         "",     0.0f,    10.0f,   "The same for soil"},
    Field{&SandParams::abrasion_by_amount,            "abrasion_by_amount",    "",     false,   true,    "Wear grows with the sand that bounces; else any sand will do"},
    Field{&SandParams::abrasion_threshold_m,          "abrasion_threshold",    "m",    0.0f,    10.0f,   "More sand than this protects the ground"},
    Field{&SandParams::moisture_capacity_m,           "moisture_capacity",     "m",    0.0f,    100.0f,  "Water that deep sand and soil hold"},
    Field{&SandParams::moisture_depth_m,              "moisture_depth",        "m",    1.0e-3f, 100.0f,  "Thickness of sand and soil that holds as much; thinner holds less"},
    Field{&SandParams::reptation_smooth,              "reptation_smooth",      "s/m",  0.0f,    100.0f,  "Smoothing by impacts, for each metre of bounced sand and hop"},
    Field{&SandParams::reptation_smooth_wind_s_per_m, "reptation_smooth_wind", "s2/m2", 0.0f,   100.0f,  "The same, times the speed of the wind"},
    Field{&SandParams::reptation_repose_s2_per_m2,    "reptation_repose",      "s2/m2", 0.0f,   100.0f,  "Moving sand lowers the angle of repose"},
    Field{&SandParams::reptation_shadowed,            "reptation_shadowed",    "",     false,   true,    "but not in shelter"},
    Field{&SandParams::avalanche_sweeps,              "avalanche_sweeps",      "",     0,       10000,   "Sweeps each step as published; 0: until quiet"},
    Field{&SandParams::avalanche_max_sweeps,          "avalanche_max_sweeps",  "",     1,       1000000, "Upper bound of sweeps until quiet; what slides then goes on in the next step"},
    Field{&SandParams::avalanche_tolerance,           "avalanche_tolerance",   "m/m",  0.0f,    0.2f,    "Quiet ground slides when it is steeper than repose by this much"},
    Field{&SandParams::avalanche_strength,            "avalanche_strength",    "",     0.01f,   1.0f,    "Strength of soft sweeps"},
    Field{&SandParams::avalanche_soft_every,          "avalanche_soft_every",  "",     1,       10000,   "Every so many sweeps one is soft"},
    Field{&SandParams::avalanche_soft_last,           "avalanche_soft_last",   "",     0,       10000,   "and so many at the end"},
    Field{&SandParams::repose_deg,                    "repose",                "deg",  1.0f,    80.0f,   "Angle of repose of sand"},
    Field{&SandParams::repose_plants_deg,             "repose_plants",         "deg",  1.0f,    85.0f,   "The same under dense plants"},
    Field{&SandParams::soil_sweeps,                   "soil_sweeps",           "",     0,       1000,    "Sweeps of soil each step"},
    Field{&SandParams::soil_repose_deg,               "soil_repose",           "deg",  1.0f,    85.0f,   "Angle of repose of soil"},
    Field{&SandParams::soil_repose_plants_deg,        "soil_repose_plants",    "deg",  1.0f,    88.0f,   "The same under dense plants"},
    Field{&SandParams::bedrock_sweeps,                "bedrock_sweeps",        "",     0,       1000,    "Sweeps of bedrock each step"},
    Field{&SandParams::bedrock_repose_deg,            "bedrock_repose",        "deg",  1.0f,    89.5f,   "Steepest slope that rock holds"},
    Field{&SandParams::bedrock_to_sand,               "bedrock_to_sand",       "",     false,   true,    "Rock that falls becomes sand; else it stays rock"},
    Field{&SandParams::supply,                        "supply",                "",     false,   true,    "Keep the share of covered ground at a target"},
    Field{&SandParams::supply_removes,                "supply_removes",        "",     false,   true,    "by removing sand too"},
    Field{&SandParams::supply_uniform,                "supply_uniform",        "",     false,   true,    "Sand falls everywhere; else on one disc"},
    Field{&SandParams::supply_target,                 "supply_target",         "",     0.0f,    1.0f,    "Share of ground to be covered"},
    Field{&SandParams::supply_threshold_m,            "supply_threshold",      "m",    0.0f,    100.0f,  "Ground is covered by more sand than this"},
    Field{&SandParams::supply_add_m,                  "supply_add",            "m",    0.0f,    100.0f,  "Mean thickness added at once"},
    Field{&SandParams::supply_remove_m,               "supply_remove",         "m",    0.0f,    100.0f,  "Mean thickness removed at once"},
    Field{&SandParams::supply_radius_cells,           "supply_radius",         "cells", 0,      100000,  "Radius of the disc"},
    Field{&SandParams::supply_every_steps,            "supply_every",          "steps", 1,      1000000, "Steps between two events"},
};
// clang-format on
static_assert(covers_every_member<SandParams> && defaults_in_range<SandParams>);

} // namespace sahel
