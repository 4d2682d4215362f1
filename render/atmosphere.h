#pragma once

#include "render/view_tile.h"
#include "world/params.h"

#include <span>
#include <string_view>
#include <tuple>

/// Sun, air and exposure.
namespace sahel {

struct Atmosphere {
    float sun_azimuth_deg = -140.0f;
    float sun_elevation_deg = 12.0f;
    float haze_per_m = 5.0e-5f;
    float haze_height_m = 900.0f;
    float cloud_cover = 0.5f;
    float exposure = 1.0f;
    float silt = 0.15f;
    float wind_m_per_s = 5.0f;
};

// clang-format off
template <> inline constexpr auto fields_of<Atmosphere> = std::tuple{
    Field{&Atmosphere::sun_azimuth_deg,   "sun_azimuth_deg",   "deg", -360.0f, 360.0f, "Where the sun stands, from east towards south"},
    Field{&Atmosphere::sun_elevation_deg, "sun_elevation_deg", "deg", 0.5f,  90.0f,  "Height of the sun above the horizon"},
    Field{&Atmosphere::haze_per_m,        "haze_per_m",        "1/m", 0.0f,  5.0e-3f, "Haze at the eye's reference height"},
    Field{&Atmosphere::haze_height_m,     "haze_height_m",     "m",   50.0f, 5000.0f, "Height over which the haze thins to 37 %"},
    Field{&Atmosphere::cloud_cover,       "cloud_cover",       "",    0.0f,  1.0f,   "Share of the sky that clouds cover"},
    Field{&Atmosphere::exposure,          "exposure",          "",    0.05f, 20.0f,  "Brightness of the picture"},
    Field{&Atmosphere::silt,              "silt",              "",    0.0f,  1.0f,   "Murkiness of water"},
    Field{&Atmosphere::wind_m_per_s,      "wind_m_per_s",      "m/s", 0.0f,  40.0f,  "Wind that drives clouds and waves"},
};
// clang-format on
static_assert(covers_every_member<Atmosphere>);

inline SunDirection sun_direction(const Atmosphere& a) {
    constexpr float k_rad = 0.017453293f;
    return {a.sun_azimuth_deg * k_rad, a.sun_elevation_deg * k_rad};
}

struct AtmospherePreset {
    std::string_view name;
    Atmosphere atmosphere;
};
/// golden_hour, morning, noon, dusk, sand_haze, after_rain.
std::span<const AtmospherePreset> atmosphere_presets();

/// What the surface looks like beyond its layers: hues, and the heights at which rock and snow change.
struct SurfaceLook {
    float sand_hue = 0.3f;
    float grey_rock_from_m = 520.0f;
    float grey_rock_to_m = 900.0f;
    float snow_from_m = 2000.0f;
    float strata = 1.0f;
    float wind_azimuth_deg = 30.0f;
};

// clang-format off
template <> inline constexpr auto fields_of<SurfaceLook> = std::tuple{
    Field{&SurfaceLook::sand_hue,         "sand_hue",         "",    0.0f, 1.0f, "0: golden sand, 1: red"},
    Field{&SurfaceLook::grey_rock_from_m, "grey_rock_from_m", "m",   -16000.0f, 16000.0f, "Rock turns grey above this height"},
    Field{&SurfaceLook::grey_rock_to_m,   "grey_rock_to_m",   "m",   -16000.0f, 16000.0f, "and is all grey above this one"},
    Field{&SurfaceLook::snow_from_m,      "snow_from_m",      "m",   -16000.0f, 16000.0f, "Snow lies above this height"},
    Field{&SurfaceLook::strata,           "strata",           "",    0.0f, 1.0f, "How clearly rock shows its beds"},
    Field{&SurfaceLook::wind_azimuth_deg, "wind_azimuth_deg", "deg", -360.0f, 360.0f, "Downwind direction of the ripples, from east towards south"},
};
// clang-format on
static_assert(covers_every_member<SurfaceLook>);

} // namespace sahel
