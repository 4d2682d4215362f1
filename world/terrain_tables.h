#pragma once

#include "world/base_terrain.h"
#include "world/noise.h"

#include <cstdint>

/// Everything the terrain kernels read, as plain data (a CUDA kernel takes it by value): parameters, and the lattice
/// and the amplitude of every octave. Names follow the stage that uses them.
namespace sahel {

struct Octave {
    Lattice lattice;
    float amplitude = 1.0f;
};

struct TerrainTables {
    uint64_t seed = 1;
    BaseTerrainParams p;
    float wind_x = 1.0f, wind_y = 0.0f; ///< unit vector, downwind
    uint32_t lake_salt = 0;

    Octave warp_x[2], warp_y[2];
    Octave relief[4], wet[3], continent[6], canyon[2], plain[5];
    Octave massif[6], massif_base; ///< from coarse to fine; the ridged base
    Octave gully[5], fine_gully[2];
    Octave rock[6], hummock[3];
    Lattice canyon_line, channel_line; ///< zero lines: wadis and canyons, wetland channels
    Lattice wind_turn, supply;
    Lattice dune, mega, small; ///< phasors of the three dune sizes
    Lattice dune_fine, dune_warp;
    Lattice lake_shape[3];
    Lattice strata, tilt;
};
static_assert(sizeof(TerrainTables) < 4000, "kernel arguments hold 4 KiB");

inline constexpr float k_gully_wavelength = 0.62f; ///< of the lattice size
inline constexpr float k_massif_slope_m = 1500.0f; ///< length that turns noise slopes into attenuation
inline constexpr float k_dune_wavelength = 11.0f;  ///< of the dune height
inline constexpr float k_mega_wavelength = 12.5f;
inline constexpr float k_small_dune_m = 26.0f; ///< wavelength of the smallest dunes
inline constexpr float k_strata_m = 44.0f;     ///< a cliff and a ledge
inline constexpr int64_t k_lake_lattice_m = 4096;
inline constexpr float k_line_limit_m = 3000.0f; ///< distances to lines are not known beyond
inline constexpr float k_no_lake = 3.0f;         ///< lake radii from its centre beyond which a lake changes nothing

/// Sums of octaves from which the large scale is made. Octaves of many node spacings are summed at every fourth node.
enum class SumField : int {
    warp_x, ///< m
    warp_y,
    relief,
    wetness,
    continent,
    canyon,
    plain, ///< m
    massif,
    massif_x, ///< slopes
    massif_y,
    line, ///< signed distance to the line of canyons and wadis, m
    count_
};
inline constexpr int k_sum_fields = static_cast<int>(SumField::count_);

/// Fields evaluated at nodes. Those that cells read (Piece::plan) reach them by a spline of their own; the rest goes
/// into the middle pass.
enum class NodeField : int {
    height,  ///< m
    slope_x, ///< of the height, per m
    slope_y,
    mountain, ///< weights
    dune,
    canyon,
    wetness,
    wetland,
    dune_sin, ///< phasors of the dunes
    dune_cos,
    mega_sin,
    mega_cos,
    supply,       ///< noise
    lake,         ///< distance from the lake's centre in radii, at most k_no_lake; less beside streams
    lake_level,   ///< m, where lake < k_lake_end
    wadi,         ///< signed distance to the line of the wadi, m
    channel,      ///< the same of a wetland channel
    strata,       ///< shift of the strata, m
    stream,       ///< signed distance to the middle of a stream, m, at most k_stream_reach_m
    stream_half,  ///< half of its width, m; 0: none near
    stream_level, ///< height of its water, m
    count_
};
inline constexpr int k_node_fields = static_cast<int>(NodeField::count_);

/// Fields of the middle pass.
enum class MidField : int {
    height, ///< m, to be added to the node's
    slope,
    rough, ///< weight of rock detail
    soil,  ///< m
    bed,   ///< sand in wadis, m
    noise,
    strata,      ///< weight of the ledges
    mega,        ///< amplitudes of the dunes, 0 to 1
    dune,        ///<
    small,       ///< m
    small_sin,   ///< phasor of the smallest
    small_cos,   ///<
    fine,        ///< noise on dunes, m
    sand,        ///< m, sheet of sand under the dunes; negative where the ground is bare
    sand_factor, ///< keeps sand off steep ground and out of lakes
    count_
};
inline constexpr int k_mid_fields = static_cast<int>(MidField::count_);

/// A lake: a pure function of its site, so that every tile that sees it agrees. World half metres and metres.
struct LakeSite {
    int64_t x_half_m = 0, y_half_m = 0;
    float radius_m = 0.0f;
    float level_m = 0.0f;
    float depth_m = 0.0f;
};

/// A straight piece of the middle line of a stream.
struct StreamPiece {
    int64_t x_half_m = 0, y_half_m = 0;     ///< where it begins
    float dx_m = 0.0f, dy_m = 0.0f;         ///< to its end
    float half_m = 0.0f, half_end_m = 0.0f; ///< half of the width
    float level_m = 0.0f, level_end_m = 0.0f;
};
inline constexpr float k_stream_reach_m = 170.0f; ///< valleys of streams end at this distance from the middle line
inline constexpr float k_stream_far_m = 2200.0f;  ///< of any part of a stream from the site of its lake

TerrainTables make_terrain_tables(uint64_t seed, const BaseTerrainParams& params);

} // namespace sahel
