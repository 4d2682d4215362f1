#pragma once

#include "streaming/streamer.h"

#include <array>
#include <functional>

/// The eye: where it is, where it looks, and how it flies. World metres, x east, y south, z up; positions are double,
/// so flight is as smooth 4000 km from the origin as at it. There is no roll.
namespace sahel {

using Vec3d = std::array<double, 3>;

/// Height of the surface (ground or water) at world metres.
using GroundFunction = std::function<double(double x_m, double y_m)>;

struct CameraPose {
    Vec3d eye_m{};
    double yaw_deg = 0.0;   ///< azimuth of the view: 0 east, 90 south (as the sun's)
    double pitch_deg = 0.0; ///< 90 straight up
    double vertical_fov_deg = 50.0;
};

inline constexpr double k_max_pitch_deg = 89.0;

/// Unit vector of the view.
Vec3d view_direction(const CameraPose& pose);
/// Turns the pose so that it looks at a point; the pitch stays within +-k_max_pitch_deg. A point at the eye changes
/// nothing.
void look_at(CameraPose& pose, const Vec3d& target_m);
/// Angle in [-180, 180).
double wrap_degrees(double degrees);

ViewState make_view_state(const CameraPose& pose, const Vec3d& velocity_m_per_s, int width_px, int height_px,
                          double ground_m);

/// What the player asks for in one frame, however it was typed.
struct FlyInput {
    double forward = 0.0; ///< -1 .. 1
    double right = 0.0;
    double up = 0.0;
    bool fast = false;
    bool slow = false;
    double turn_right_deg = 0.0; ///< in this frame
    double turn_up_deg = 0.0;
    double speed_steps = 0.0; ///< notches of the wheel: each changes the speed by a quarter
};

enum class MoveMode { fly, walk };

/// Fly camera with smooth starts and stops. Velocity follows what is asked for with time constant `response_s`, and the
/// motion of a frame is the exact solution of that, so the path does not depend on the frame rate. Walking keeps the
/// eye at eye height over the ground, flying keeps it above `clearance_m`.
class FlyCamera {
  public:
    struct Settings {
        double speed_m_per_s = 30.0;
        double walk_speed_m_per_s = 4.0;
        double response_s = 0.18;
        double clearance_m = 1.5;
        double eye_height_m = 1.7;
        double fast_factor = 8.0;
        double slow_factor = 0.125;
    };
    static constexpr double k_min_speed_m_per_s = 0.25;
    static constexpr double k_max_speed_m_per_s = 20000.0;

    FlyCamera() = default;
    explicit FlyCamera(const Settings& settings) : settings_(settings) {}

    /// Advances by dt_s (0 .. 1; longer frames count as 1 s). `surface` may be empty: nothing is below.
    void update(const FlyInput& input, double dt_s, const GroundFunction& surface);

    /// Stands still at a pose (start, bookmark, teleport).
    void place(const CameraPose& pose);
    void set_mode(MoveMode mode) { mode_ = mode; }
    void set_vertical_fov(double degrees) { pose_.vertical_fov_deg = degrees; }

    [[nodiscard]] const CameraPose& pose() const { return pose_; }
    [[nodiscard]] const Vec3d& velocity_m_per_s() const { return velocity_; }
    [[nodiscard]] MoveMode mode() const { return mode_; }
    /// Chosen by the wheel, without the keys that change it for a moment.
    [[nodiscard]] double speed_m_per_s() const {
        return mode_ == MoveMode::fly ? settings_.speed_m_per_s : settings_.walk_speed_m_per_s;
    }

  private:
    [[nodiscard]] Vec3d wanted_velocity(const FlyInput& input) const;

    Settings settings_;
    CameraPose pose_;
    Vec3d velocity_{};
    MoveMode mode_ = MoveMode::fly;
};

} // namespace sahel
