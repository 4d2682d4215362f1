#pragma once

#include "render/camera.h"
#include "world/result.h"
#include "world/surface_source.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

/// Places worth a picture, found in a world instead of typed in.
///
/// A coarse survey proposes standpoints for each kind of picture; from each one the surroundings are seen once all
/// round (view_panorama.h) and every heading is scored on what the picture would hold: share of water, three depths,
/// relief of the far ground, light and shade, something in the foreground, lands behind lands, nothing in the way. The
/// horizon lies on the upper third by choice of the pitch, the sun to the side of the view (40 to 110 degrees) by
/// choice of its azimuth, unless it is given. The result is a function of the world's surface and the options alone.
namespace sahel {

enum class ViewKind : uint8_t { dunes, lake, shore, canyon, mountains, high, count_ };
std::string_view name_of(ViewKind kind);

/// What a picture holds; shares are of all its pixels.
struct ViewMeasures {
    double sky = 0.0, water = 0.0, sand = 0.0, steep = 0.0; ///< steep: slopes above 0.8 from 60 m to 4 km
    double near_ground = 0.0, middle = 0.0, far = 0.0;      ///< nearer than 60 m, than 900 m, beyond
    double near_water = 0.0;                                ///< water nearer than 80 m
    double water_cut = 0.0;                                 ///< of the sides and the lower edge, what is water
    double water_lean = 0.0;     ///< water within 200 m left of the middle against right of it: 1 all on one side
    double dune_flanks = 0.0;    ///< of the sand in the middle, what is steeper than 0.2
    double far_relief_deg = 0.0; ///< standard deviation of the far skyline
    double skyline_top_deg = 0.0, skyline_mean_deg = 0.0;
    double lit = 0.0;            ///< of the ground, what faces the sun
    double far_lit = 0.0;        ///< of the ground beyond 900 m that is steeper than 0.2, what faces the sun well
    double sunlit = 0.0;         ///< of the ground, what the sun reaches past the hills; of the best views alone
    double light_contrast = 0.0; ///< standard deviation of the light on the ground
    double foreground_contrast = 0.0;
    double foreground_light = 0.0; ///< mean of the light on the ground nearer than 60 m: cosine of its angle
    double middle_contrast = 0.0;  ///< the same from 60 m to 2.5 km: a plain without landforms has little
    double layers = 0.0;           ///< lands behind lands: mean number of edges of a column behind which it goes deeper
    double dunes = 0.0;            ///< sand steeper than 0.2, from 60 m to 4 km
    double blocked = 0.0;          ///< share of the middle columns where the ground within 40 m hides the horizon
    double sun_off_axis_deg = 0.0;
    int materials = 0; ///< that fill a twentieth of the picture or more
};

struct FoundView {
    ViewKind kind = ViewKind::dunes;
    CameraPose pose;
    double sun_azimuth_deg = 0.0; ///< that the score is for
    double score = 0.0;           ///< 0 .. 1
    ViewMeasures measures;
};

struct CameraSearchOptions {
    std::array<double, 2> centre_m{};
    double radius_m = 7000.0;                     ///< of the survey
    std::vector<std::array<double, 2>> sites_m{}; ///< more places to look around, also outside the survey
    std::vector<ViewKind> kinds{};                ///< empty: all
    int standpoints = 16;                         ///< for each kind
    int per_kind = 1;                             ///< the best so many, at least `spacing_m` apart
    double spacing_m = 400.0;
    double least_score = 0.45; ///< worse views are left out
    double vertical_fov_deg = 50.0;
    double sun_elevation_deg = 12.0;
    std::optional<double> sun_azimuth_deg{}; ///< none: beside each view, where it lights better
};

/// Best views first within each kind, kinds in order; kinds that the landscape does not have are missing.
/// Errors: usage (options), and those of the source.
Result<std::vector<FoundView>> find_views(const SurfaceSource& source, const CameraSearchOptions& options);

} // namespace sahel
