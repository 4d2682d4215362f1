#include "render/camera_path.h"

#include <algorithm>
#include <cmath>

namespace sahel {

Result<CameraPath> CameraPath::create(Description description, std::string_view where) {
    CameraPath path;
    path.description_ = std::move(description);
    SAHEL_TRY(check_camera_path(path.description_, where));
    std::vector<double> times;
    std::vector<Vec3d> eyes, aims;
    for (const CameraKey& key : path.description_.keys) {
        times.push_back(key.time_s);
        eyes.push_back(key.position_m);
        if (path.description_.aims_at_targets) {
            aims.push_back(key.target_m);
        } else {
            // The short way round from key to key.
            const double before = aims.empty() ? key.yaw_deg : aims.back()[0];
            aims.push_back({before + wrap_degrees(key.yaw_deg - before), key.pitch_deg, 0.0});
        }
    }
    path.eye_ = SplineCurve(times, std::move(eyes), path.description_.ease);
    path.aim_ = SplineCurve(times, std::move(aims), path.description_.ease);
    return path;
}

CameraPose CameraPath::pose_at(double time_s) const {
    CameraPose pose;
    pose.vertical_fov_deg = description_.vertical_fov_deg;
    pose.eye_m = eye_.at(time_s);
    const Vec3d aim = aim_.at(time_s);
    if (description_.aims_at_targets) {
        look_at(pose, aim);
    } else {
        pose.yaw_deg = wrap_degrees(aim[0]);
        pose.pitch_deg = std::clamp(aim[1], -k_max_pitch_deg, k_max_pitch_deg);
    }
    return pose;
}

Vec3d CameraPath::velocity_at(double time_s) const {
    Vec3d v{};
    if (time_s >= start_s() && time_s <= start_s() + duration_s()) (void)eye_.at(time_s, &v);
    return v;
}

} // namespace sahel
