#include "render/sky_table.h"

#include "world/executor.h"

#include <algorithm>
#include <cmath>

namespace sahel {

namespace {

constexpr float k_pi = 3.14159265f;
constexpr float k_earth_m = 6371e3f;
constexpr Rgb k_sun_above_air = {20.0f, 19.6f, 19.2f};
constexpr Rgb k_rayleigh = {5.8e-6f, 13.5e-6f, 33.1e-6f}; // 1/m at the ground
constexpr Rgb k_ozone = {0.65e-6f, 1.88e-6f, 0.085e-6f};  // 1/m in the middle of its layer
constexpr float k_haze_scale_m = 1200.0f;

float sstepf(float a, float b, float x) {
    const float t = std::clamp((x - a) / (b - a), 0.0f, 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

/// Height above the ground after t metres from height h towards a direction with sine of elevation dy.
float height_at(float h, float t, float dy) {
    const float r = k_earth_m + h + t * dy;
    return std::max(std::sqrt(r * r + t * t * (1.0f - dy * dy)) - k_earth_m, -2000.0f);
}

struct Air {
    float haze; // scattering of haze at the ground, 1/m

    [[nodiscard]] Rgb extinction(float height_m) const {
        const float rayleigh = std::exp(-height_m / 8000.0f);
        const float mie = 1.1f * haze * std::exp(-height_m / k_haze_scale_m);
        const float ozone = std::max(0.0f, 1.0f - std::fabs(height_m - 25e3f) / 15e3f);
        return {k_rayleigh[0] * rayleigh + k_ozone[0] * ozone + mie,
                k_rayleigh[1] * rayleigh + k_ozone[1] * ozone + mie,
                k_rayleigh[2] * rayleigh + k_ozone[2] * ozone + mie};
    }
    /// Share of sunlight that reaches a height.
    [[nodiscard]] Rgb sun_transmittance(float height_m, float sun_sine) const {
        constexpr int k_steps = 20;
        const float reach = std::min(60e3f / std::max(sun_sine, 0.06f), 700e3f);
        Rgb depth{};
        for (int i = 0; i < k_steps; ++i) {
            const float a = (static_cast<float>(i) + 0.5f) / k_steps;
            const float dt = reach * 2.0f * a / k_steps;
            const Rgb e = extinction(height_at(height_m, reach * a * a, sun_sine));
            for (size_t k = 0; k < 3; ++k) depth[k] += dt * e[k];
        }
        return {std::exp(-depth[0]), std::exp(-depth[1]), std::exp(-depth[2])};
    }
};

Rgb march(const Air& air, const Atmosphere& a, float sun_sine, float sun_cosine, float azimuth, float elevation) {
    const float dy = std::sin(elevation);
    const float mu = std::cos(elevation) * sun_cosine * std::cos(azimuth) + dy * sun_sine;
    constexpr float g = 0.78f;
    const float phase_rayleigh = 3.0f / (16.0f * k_pi) * (1.0f + mu * mu);
    const float phase_haze =
        0.9f * (1.0f - g * g) / (4.0f * k_pi * std::pow(1.0f + g * g - 2.0f * g * mu, 1.5f)) + 0.1f / (4.0f * k_pi);
    const float sandy = sstepf(2e-4f, 9e-4f, a.haze_per_m);
    const Rgb haze_colour = {1.0f, 0.95f + sandy * (0.82f - 0.95f), 0.87f + sandy * (0.58f - 0.87f)};
    const float daylight = sstepf(-0.05f, 0.35f, sun_sine);
    const Rgb again = {0.20f * daylight, 0.26f * daylight, 0.34f * daylight};
    constexpr int k_steps = 28;
    const float reach = std::min(60e3f / std::max(dy, 0.055f), 620e3f);
    Rgb transmitted = {1.0f, 1.0f, 1.0f}, light{};
    for (int i = 0; i < k_steps; ++i) {
        const float s = (static_cast<float>(i) + 0.5f) / k_steps;
        const float t = reach * s * s, dt = reach * 2.0f * s / k_steps;
        const float h = height_at(0.0f, t, dy);
        const Rgb e = air.extinction(h);
        const Rgb sun = air.sun_transmittance(h, sun_sine);
        const float rayleigh = std::exp(-h / 8000.0f), haze = air.haze * std::exp(-h / k_haze_scale_m);
        for (size_t k = 0; k < 3; ++k) {
            const float multiple = 0.125f * (0.5f * sun[k] + again[k]);
            const float scattered =
                k_sun_above_air[k] * (k_rayleigh[k] * rayleigh * (phase_rayleigh * sun[k] + multiple) +
                                      haze * haze_colour[k] * (phase_haze * sun[k] + multiple));
            const float kept = std::exp(-e[k] * dt);
            light[k] += transmitted[k] * scattered * (1.0f - kept) / std::max(e[k], 1e-9f);
            transmitted[k] *= kept;
        }
    }
    return light;
}

} // namespace

std::span<const AtmospherePreset> atmosphere_presets() {
    static constexpr std::array<AtmospherePreset, 6> k_presets = {{
        {"golden_hour", {-140.0f, 12.0f, 5.0e-5f, 900.0f, 0.5f, 1.0f, 0.15f, 5.0f}},
        {"morning", {-60.0f, 22.0f, 4.0e-5f, 900.0f, 0.45f, 1.0f, 0.15f, 4.0f}},
        {"noon", {-90.0f, 62.0f, 3.0e-5f, 1200.0f, 0.35f, 0.9f, 0.15f, 5.0f}},
        {"dusk", {-170.0f, 2.0f, 7.0e-5f, 700.0f, 0.6f, 1.3f, 0.15f, 3.0f}},
        {"sand_haze", {-110.0f, 18.0f, 1.1e-3f, 260.0f, 0.2f, 0.72f, 0.3f, 12.0f}},
        {"after_rain", {-130.0f, 17.0f, 3.0e-5f, 900.0f, 0.8f, 1.0f, 0.35f, 6.0f}},
    }};
    return k_presets;
}

Rgb SkyTable::lookup(float from_sun_rad, float elevation_rad) const {
    const float u = std::clamp(from_sun_rad / k_pi, 0.0f, 1.0f) * (k_width - 1);
    const float v = std::sqrt(std::clamp(elevation_rad / (0.5f * k_pi), 0.0f, 1.0f)) * (k_height - 1);
    const int i = std::min(static_cast<int>(u), k_width - 2), j = std::min(static_cast<int>(v), k_height - 2);
    const float a = u - static_cast<float>(i), b = v - static_cast<float>(j);
    const auto* p = &radiance[static_cast<size_t>(j * k_width + i)];
    Rgb out{};
    for (size_t k = 0; k < 3; ++k)
        out[k] = (p[0][k] * (1 - a) + p[1][k] * a) * (1 - b) + (p[k_width][k] * (1 - a) + p[k_width + 1][k] * a) * b;
    return out;
}

SkyTable make_sky_table(const Atmosphere& a) {
    const Air air{a.haze_per_m * 0.22f + 3e-6f};
    const SunDirection direction = sun_direction(a);
    const float sun_sine = std::sin(direction.elevation_rad), sun_cosine = std::cos(direction.elevation_rad);
    SkyTable table;
    table.radiance.resize(static_cast<size_t>(SkyTable::k_width) * SkyTable::k_height);
    for_each_index("render/sky", SkyTable::k_height, [&](int64_t row) {
        const auto j = static_cast<int>(row);
        const float s = static_cast<float>(j) / (SkyTable::k_height - 1);
        for (int i = 0; i < SkyTable::k_width; ++i) {
            const float azimuth = static_cast<float>(i) / (SkyTable::k_width - 1) * k_pi;
            const Rgb c = march(air, a, sun_sine, sun_cosine, azimuth, s * s * 0.5f * k_pi);
            table.radiance[static_cast<size_t>(j * SkyTable::k_width + i)] = {c[0], c[1], c[2], 1.0f};
        }
    });
    const Rgb reached = air.sun_transmittance(0.0f, sun_sine);
    for (size_t k = 0; k < 3; ++k) table.sun[k] = k_sun_above_air[k] * reached[k];

    Rgb up{}, sunward{}, away{};
    float up_weight = 0.0f, side_weight = 0.0f;
    for (int j = 0; j < SkyTable::k_height; ++j)
        for (int i = 0; i < SkyTable::k_width; ++i) {
            const float s = static_cast<float>(j) / (SkyTable::k_height - 1);
            const float elevation = s * s * 0.5f * k_pi;
            const float solid = std::cos(elevation) * s * 2.0f;
            const float across = std::cos(static_cast<float>(i) / (SkyTable::k_width - 1) * k_pi) * std::cos(elevation);
            const auto& c = table.radiance[static_cast<size_t>(j * SkyTable::k_width + i)];
            up_weight += std::sin(elevation) * solid;
            side_weight += std::fabs(across) * solid * 0.5f;
            for (size_t k = 0; k < 3; ++k) {
                const float light = std::min(c[k], 6.0f); // the glare round the sun is the sun's, not the sky's
                up[k] += light * std::sin(elevation) * solid;
                (across > 0.0f ? sunward : away)[k] += light * std::fabs(across) * solid;
            }
        }
    constexpr Rgb k_ground_albedo = {0.40f, 0.28f, 0.17f};
    constexpr Rgb k_luminance = {0.2126f, 0.7152f, 0.0722f};
    float brightness = 0.0f;
    for (size_t k = 0; k < 3; ++k) {
        table.up[k] = up[k] / up_weight;
        table.side[k] = 0.25f * (sunward[k] - away[k]) / side_weight;
        table.ground[k] = 0.7f * k_ground_albedo[k] * (table.sun[k] * sun_sine / k_pi + table.up[k]);
        brightness +=
            k_luminance[k] * (0.30f * (table.sun[k] * 0.75f * sun_sine / k_pi + table.up[k]) + 0.02f * table.sun[k]);
    }
    table.exposure_key = 0.30f / std::max(brightness, 1e-4f);
    return table;
}

} // namespace sahel
