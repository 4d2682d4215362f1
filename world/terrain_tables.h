#pragma once

#include "world/base_terrain.h"
#include "world/noise.h"

#include <cstdint>

/// Everything the terrain kernels read, as plain data: parameters and the lattice of every octave. Names follow the
/// stage that uses them.
namespace sahel {

struct TerrainTables {
    uint64_t seed = 1;
    BaseTerrainParams p;
    float wind_x = 1.0f, wind_y = 0.0f; ///< unit vector, downwind
    uint32_t lake_salt = 0;

    Lattice warp_x[2], warp_y[2];
    Lattice relief[4], wet[3], continent[6], canyon[2], plain[5];
    Lattice massif[7]; ///< 0..5 from coarse to fine, 6: the ridged base
    Lattice line[2];   ///< zero lines: wadis and canyons, wetland channels
    Lattice wind_turn;
    Lattice dune, mega, small; ///< phasors of the three dune sizes
    Lattice supply, dune_fine, dune_warp;
    Lattice lake_shape[2];
    Lattice gully[5], fine_gully[2];
    Lattice rock[6];
    Lattice strata;
    Lattice hummock[3];
};

/// Amplitudes of the octaves (coarse to fine).
inline constexpr float k_relief_amplitude[4] = {1.15f, 0.55f, 0.24f, 0.10f};
inline constexpr float k_wet_amplitude[3] = {1.1f, 0.45f, 0.18f};
inline constexpr float k_canyon_amplitude[2] = {1.0f, 0.4f};
inline constexpr float k_continent_amplitude[6] = {0.55f, 0.55f, 0.65f, 0.50f, 0.26f, 0.12f};
inline constexpr float k_plain_amplitude[5] = {1.0f, 0.5f, 0.24f, 0.11f, 0.05f};
inline constexpr float k_massif_amplitude[6] = {0.60f, 0.34f, 0.10f, 0.05f, 0.025f, 0.012f};
inline constexpr float k_gully_amplitude[5] = {0.12f, 0.12f, 0.11f, 0.10f, 0.09f};
inline constexpr float k_fine_gully_amplitude[2] = {0.13f, 0.10f};
inline constexpr float k_gully_wavelength = 0.62f; ///< of the lattice size
inline constexpr float k_massif_slope_m = 1500.0f; ///< length that turns noise slopes into attenuation
inline constexpr float k_dune_wavelength = 11.0f;  ///< of the dune height
inline constexpr float k_mega_wavelength = 12.5f;
inline constexpr float k_small_dune_m = 26.0f; ///< wavelength of the smallest dunes
inline constexpr float k_strata_m = 44.0f;     ///< a cliff and a ledge
inline constexpr int64_t k_lake_lattice_m = 4096;

/// The fields evaluated at nodes and carried to cells by the spline.
enum class NodeField : int {
    height,
    slope_x,
    slope_y,
    mountain,
    dune,
    canyon,
    wetness,
    dune_sin,
    dune_cos,
    mega_sin,
    mega_cos,
    line0,
    line1,
    water_table,
    lake,
    wetland,
    supply,
    strata,
    plain4,
    count_
};
inline constexpr int k_node_fields = static_cast<int>(NodeField::count_);

/// A lake: a pure function of its site, so that every tile that sees it agrees. World half metres and metres.
struct LakeSite {
    int64_t x_half_m = 0, y_half_m = 0;
    float radius_m = 0.0f;
    float level_m = 0.0f;
    float depth_m = 0.0f;
};

TerrainTables make_terrain_tables(uint64_t seed, const BaseTerrainParams& params);

} // namespace sahel
