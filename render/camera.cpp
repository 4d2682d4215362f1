#include "render/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sahel {

namespace {
constexpr double k_rad = std::numbers::pi / 180.0;
}

Vec3d view_direction(const CameraPose& pose) {
    const double yaw = pose.yaw_deg * k_rad;
    const double pitch = pose.pitch_deg * k_rad;
    return {std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch)};
}

double wrap_degrees(double degrees) {
    return degrees - 360.0 * std::floor((degrees + 180.0) / 360.0);
}

void look_at(CameraPose& pose, const Vec3d& target_m) {
    const double dx = target_m[0] - pose.eye_m[0];
    const double dy = target_m[1] - pose.eye_m[1];
    const double dz = target_m[2] - pose.eye_m[2];
    const double flat = std::hypot(dx, dy);
    if (flat + std::abs(dz) < 1e-9) return;
    if (flat > 1e-9) pose.yaw_deg = std::atan2(dy, dx) / k_rad; // straight down keeps the heading
    pose.pitch_deg = std::clamp(std::atan2(dz, flat) / k_rad, -k_max_pitch_deg, k_max_pitch_deg);
}

ViewState make_view_state(const CameraPose& pose, const Vec3d& velocity_m_per_s, int width_px, int height_px,
                          double ground_m) {
    ViewState view;
    view.eye_m = pose.eye_m;
    view.velocity_m_per_s = velocity_m_per_s;
    view.forward = view_direction(pose);
    view.vertical_fov_rad = pose.vertical_fov_deg * k_rad;
    view.aspect = static_cast<double>(width_px) / std::max(1, height_px);
    view.viewport_height_px = height_px;
    view.ground_m = ground_m;
    return view;
}

Vec3d FlyCamera::wanted_velocity(const FlyInput& input) const {
    // Walking follows the heading alone; flying goes where the eye looks.
    CameraPose heading = pose_;
    if (mode_ == MoveMode::walk) heading.pitch_deg = 0.0;
    const Vec3d ahead = view_direction(heading);
    const double yaw = pose_.yaw_deg * k_rad;
    const Vec3d right{-std::sin(yaw), std::cos(yaw), 0.0};
    Vec3d v{};
    for (size_t i = 0; i < 3; ++i) v[i] = ahead[i] * input.forward + right[i] * input.right;
    if (mode_ == MoveMode::fly) v[2] += input.up;
    const double length = std::hypot(v[0], v[1], v[2]);
    if (length < 1e-9) return {};
    double speed = speed_m_per_s() * std::min(1.0, length);
    if (input.fast) speed *= mode_ == MoveMode::fly ? settings_.fast_factor : 3.0;
    if (input.slow) speed *= settings_.slow_factor;
    for (double& c : v) c *= speed / length;
    return v;
}

void FlyCamera::update(const FlyInput& input, double dt_s, const GroundFunction& surface) {
    const double dt = std::clamp(dt_s, 0.0, 1.0);
    pose_.yaw_deg = wrap_degrees(pose_.yaw_deg + input.turn_right_deg);
    pose_.pitch_deg = std::clamp(pose_.pitch_deg + input.turn_up_deg, -k_max_pitch_deg, k_max_pitch_deg);
    if (input.speed_steps != 0.0) {
        double& speed = mode_ == MoveMode::fly ? settings_.speed_m_per_s : settings_.walk_speed_m_per_s;
        speed = std::clamp(speed * std::pow(1.25, input.speed_steps), k_min_speed_m_per_s, k_max_speed_m_per_s);
    }

    // v' = (wanted - v) / response, solved over the frame.
    const Vec3d wanted = wanted_velocity(input);
    const double keep = std::exp(-dt / settings_.response_s);
    for (size_t i = 0; i < 3; ++i) {
        const double excess = velocity_[i] - wanted[i];
        pose_.eye_m[i] += wanted[i] * dt + excess * settings_.response_s * (1.0 - keep);
        velocity_[i] = wanted[i] + excess * keep;
    }
    if (!surface) return;
    const double below = surface(pose_.eye_m[0], pose_.eye_m[1]);
    if (mode_ == MoveMode::walk) {
        const double stand = below + settings_.eye_height_m;
        pose_.eye_m[2] = stand + (pose_.eye_m[2] - stand) * std::exp(-dt / 0.12);
        pose_.eye_m[2] = std::max(pose_.eye_m[2], below + 0.3);
        velocity_[2] = 0.0;
    } else if (pose_.eye_m[2] < below + settings_.clearance_m) {
        pose_.eye_m[2] = below + settings_.clearance_m;
        velocity_[2] = std::max(velocity_[2], 0.0);
    }
}

void FlyCamera::place(const CameraPose& pose) {
    pose_ = pose;
    pose_.pitch_deg = std::clamp(pose.pitch_deg, -k_max_pitch_deg, k_max_pitch_deg);
    velocity_ = {};
}

} // namespace sahel
