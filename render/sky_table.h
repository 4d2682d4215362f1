#pragma once

#include "render/atmosphere.h"

#include <array>
#include <vector>

/// The sky as a small table, filled on the CPU when the sun or the haze changes: sky, haze, ambient light and
/// reflections are all read from it, so they agree by construction.
///
/// Single scattering along 28 steps (Rayleigh, ozone, haze) with an isotropic term for what is scattered again.
/// Radiance in units where the sun above the air is (20, 19.6, 19.2). Display only: ordinary floating point.
namespace sahel {

using Rgb = std::array<float, 3>;

struct SkyTable {
    static constexpr int k_width = 128; ///< azimuth from the sun, 0 .. pi
    static constexpr int k_height = 64; ///< square root of elevation / 90 degrees

    std::vector<std::array<float, 4>> radiance; ///< rows of elevation
    Rgb sun{};                                  ///< irradiance of a surface that faces the sun
    Rgb up{};                  ///< mean radiance of the upper half, weighted by the sine of the elevation
    Rgb side{};                ///< what a wall that faces the sun gets more
    Rgb ground{};              ///< light from below
    float exposure_key = 1.0f; ///< factor that brings a sunlit scene to middle grey

    /// Radiance towards a direction at azimuth `from_sun_rad` and `elevation_rad`.
    [[nodiscard]] Rgb lookup(float from_sun_rad, float elevation_rad) const;
};

SkyTable make_sky_table(const Atmosphere& atmosphere);

} // namespace sahel
