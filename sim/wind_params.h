#pragma once

#include "world/params.h"

#include <tuple>

/// Parameters of the wind: schedule, venturi, warping, projection. Units are metres, seconds and degrees from +x
/// towards +y. Names and defaults follow the Desertscape paper (GRAPP 2024), Section 4.1, and its published scenes.
namespace sahel {

struct WindParams {
    float speed_m_per_s = 5.0f;
    float angle_deg = 0.0f;
    bool bidirectional = false;
    bool strength_based = true;
    float second_angle_deg = 45.0f;
    float ratio = 2.0f;
    float period_s = 15.0f;
    float venturi_per_m = 0.005f;
    float venturi_radius_m = 2000.0f;
    bool warp = true;
    int warp_count = 2;
    float warp_gain = 1.0f;
    float warp_radius_1_m = 200.0f;
    float warp_radius_2_m = 50.0f;
    float warp_radius_3_m = 100.0f;
    float warp_radius_4_m = 100.0f;
    float warp_weight_1 = 0.8f;
    float warp_weight_2 = 0.2f;
    float warp_weight_3 = 0.0f;
    float warp_weight_4 = 0.0f;
    float warp_strength_1_m_per_s = 30.0f;
    float warp_strength_2_m_per_s = 5.0f;
    float warp_strength_3_m_per_s = 0.0f;
    float warp_strength_4_m_per_s = 0.0f;
    bool project = true;
    int epoch_steps = 16;
};

// clang-format off
template <> inline constexpr auto fields_of<WindParams> = std::tuple{
    Field{&WindParams::speed_m_per_s,           "speed",            "m/s", 0.0f,    60.0f,   "Speed of the undisturbed wind"},
    Field{&WindParams::angle_deg,               "angle",            "deg", -360.0f, 360.0f,  "Direction it blows to: 0 east, 90 south"},
    Field{&WindParams::bidirectional,           "bidirectional",    "",    false,   true,    "Two winds take turns, the second one first"},
    Field{&WindParams::strength_based,          "strength_based",   "",    false,   true,    "The ratio divides the speed of the second wind; else it stretches the time of the first"},
    Field{&WindParams::second_angle_deg,        "second_angle",     "deg", -360.0f, 360.0f,  "Direction of the second wind"},
    Field{&WindParams::ratio,                   "ratio",            "",    0.01f,   100.0f,  "Ratio of the first wind to the second"},
    Field{&WindParams::period_s,                "period",           "s",   0.01f,   1.0e9f,  "Length of one turn"},
    Field{&WindParams::venturi_per_m,           "venturi",          "1/m", 0.0f,    1.0f,    "Growth of the wind with height"},
    Field{&WindParams::venturi_radius_m,        "venturi_radius",   "m",   0.0f,    1.0e5f,  "That height is taken above the mean within this radius; 0: above the datum"},
    Field{&WindParams::warp,                    "warp",             "",    false,   true,    "Terrain turns the wind"},
    Field{&WindParams::warp_count,              "warp_count",       "",    0,       4,       "Scales of terrain that turn it"},
    Field{&WindParams::warp_gain,               "warp_gain",        "",    0.0f,    1000.0f, "Factor on the smoothed slopes"},
    Field{&WindParams::warp_radius_1_m,         "warp_radius_1",    "m",   1.0f,    1.0e4f,  "Radius of the first scale: two standard deviations"},
    Field{&WindParams::warp_radius_2_m,         "warp_radius_2",    "m",   1.0f,    1.0e4f,  "Radius of the second scale"},
    Field{&WindParams::warp_radius_3_m,         "warp_radius_3",    "m",   1.0f,    1.0e4f,  "Radius of the third scale"},
    Field{&WindParams::warp_radius_4_m,         "warp_radius_4",    "m",   1.0f,    1.0e4f,  "Radius of the fourth scale"},
    Field{&WindParams::warp_weight_1,           "warp_weight_1",    "",    0.0f,    100.0f,  "Weight of the first scale"},
    Field{&WindParams::warp_weight_2,           "warp_weight_2",    "",    0.0f,    100.0f,  "Weight of the second scale"},
    Field{&WindParams::warp_weight_3,           "warp_weight_3",    "",    0.0f,    100.0f,  "Weight of the third scale"},
    Field{&WindParams::warp_weight_4,           "warp_weight_4",    "",    0.0f,    100.0f,  "Weight of the fourth scale"},
    Field{&WindParams::warp_strength_1_m_per_s, "warp_strength_1",  "m/s", 0.0f,    1000.0f, "Deflection at slope 1 by the first scale"},
    Field{&WindParams::warp_strength_2_m_per_s, "warp_strength_2",  "m/s", 0.0f,    1000.0f, "Deflection at slope 1 by the second scale"},
    Field{&WindParams::warp_strength_3_m_per_s, "warp_strength_3",  "m/s", 0.0f,    1000.0f, "Deflection at slope 1 by the third scale"},
    Field{&WindParams::warp_strength_4_m_per_s, "warp_strength_4",  "m/s", 0.0f,    1000.0f, "Deflection at slope 1 by the fourth scale"},
    Field{&WindParams::project,                 "project",          "",    false,   true,    "Take the divergence out of the wind"},
    Field{&WindParams::epoch_steps,             "epoch_steps",      "",    1,       1024,    "Steps between two solutions of the wind"},
};
// clang-format on
static_assert(covers_every_member<WindParams> && defaults_in_range<WindParams>);

} // namespace sahel
