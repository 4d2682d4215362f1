#pragma once

#include "render/camera_path.h"

#include <array>
#include <vector>

/// Flights made for a place: an orbit round it and a flight over way points.
///
/// Both are planned in the map first. The height is the highest ground of a window along the way, smoothed within that
/// window, plus the wanted height: smooth, and never below. The speed at each point is the least of what is wished,
/// what the height allows and what the turn of the view allows; the times follow.
namespace sahel {

/// Limits that keep a flight pleasant: slow near the ground, unhurried turns.
struct FlightLimits {
    double clearance_m = 4.0;            ///< least height over the ground anywhere
    double speed_per_height_per_s = 1.5; ///< speed <= this x height over the ground
    double turn_deg_per_s = 12.0;        ///< of the view
};

struct OrbitOptions {
    std::array<double, 2> centre_m{};
    double radius_m = 350.0;
    double height_m = 60.0;  ///< over the ground
    double start_deg = 0.0;  ///< where the eye starts, as seen from the centre: 0 east, 90 south
    double arc_deg = 360.0;  ///< negative: the other way round
    double duration_s = 0.0; ///< 0: as short as the limits allow; else exactly: slower, or only a part of the arc
    double ease_s = 1.5;     ///< from rest to full speed, and back at the end
    double vertical_fov_deg = 50.0;
    FlightLimits limits{};
};

/// Round a place, looking at it; smoothly over hills. Errors: usage (radius, height or arc of nothing; a height below
/// the clearance).
Result<CameraPath> orbit_path(const OrbitOptions& options, const GroundFunction& ground);

struct FlyoverOptions {
    std::vector<std::array<double, 2>> waypoints_m{}; ///< at least two
    double height_m = 30.0;                           ///< over the ground
    double speed_m_per_s = 0.0;                       ///< wished; 0: as fast as the limits allow
    double duration_s = 0.0; ///< 0: to the last way point; else exactly: slower, or ending before it
    double ease_s = 1.5;
    double look_down_deg = 6.0;
    double vertical_fov_deg = 50.0;
    FlightLimits limits{};
};

/// Over way points, looking ahead; smoothly over hills. Errors: usage.
Result<CameraPath> flyover_path(const FlyoverOptions& options, const GroundFunction& ground);

/// What a flight does, sampled `samples_per_s` times a second: for tests and reports.
struct FlightReport {
    double length_m = 0.0;
    double lowest_m = 0.0; ///< least height over the ground
    double top_speed_m_per_s = 0.0;
    double top_speed_per_height_per_s = 0.0;
    double top_turn_deg_per_s = 0.0;
};
FlightReport measure_flight(const CameraPath& path, const GroundFunction& ground, double samples_per_s = 48.0);

} // namespace sahel
