#pragma once

#include "render/camera_search.h"
#include "render/view_panorama.h"

/// What makes a picture good, in numbers. Used by camera_search.cpp.
namespace sahel {

/// 0 up to `from`, 1 from `to` on, straight in between.
double rising(double x, double from, double to);

/// Height of the eye over the ground for a kind of picture, m.
double eye_height_m(ViewKind kind);

/// Pitch that puts the skyline around a heading on the upper third of the picture, from high up on the upper quarter.
double pitch_for(ViewKind kind, const Panorama& panorama, double yaw_deg, double vertical_fov_deg);

ViewMeasures measure_view(const Panorama& panorama, const CameraPose& pose, double sun_azimuth_deg,
                          double sun_elevation_deg);

/// Share of the ground in the picture that the sun reaches, hills in its way counted: rays over the terrain from every
/// few pixels.
double sunlit_share(ViewTerrain& terrain, const Panorama& panorama, const CameraPose& pose, double sun_azimuth_deg,
                    double sun_elevation_deg);

/// 0 .. 1; 0 where the picture is not of this kind.
double score_view(ViewKind kind, const ViewMeasures& measures);

/// The best heading from a standpoint.
FoundView best_heading(ViewKind kind, const Panorama& panorama, const Vec3d& eye_m, const CameraSearchOptions& options);

} // namespace sahel
