#pragma once

#include "render/camera.h"
#include "render/spline.h"
#include "world/json_fwd.h"
#include "world/result.h"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

/// A flight: key frames in time, and a smooth curve through them.
///
/// Positions and aims run along centripetal Catmull-Rom splines (spline.h): every key is hit at its time, speed has no
/// jumps, and `ease` lets the flight start and end at rest.
///
/// As JSON, times in seconds, rising; positions in world metres (x east, y south, z up). Keys give either target_m, or
/// yaw_deg (0 east, 90 south) and pitch_deg; all keys of a path in the same way:
///
///     { "format": 1, "name": "over the lake", "vertical_fov_deg": 50, "ease": true,
///       "keys": [ { "time_s": 0, "position_m": [0, 0, 320], "target_m": [500, 0, 300] },
///                 { "time_s": 6, "position_m": [200, 50, 330], "target_m": [700, 80, 300] } ] }
namespace sahel {

struct CameraKey {
    double time_s = 0.0;
    Vec3d position_m{};
    Vec3d target_m{};     ///< used when the path aims at targets
    double yaw_deg = 0.0; ///< used when it does not
    double pitch_deg = 0.0;
    friend bool operator==(const CameraKey&, const CameraKey&) = default;
};

class CameraPath {
  public:
    struct Description {
        std::string name;
        double vertical_fov_deg = 50.0;
        bool ease = true;
        bool aims_at_targets = true;
        std::vector<CameraKey> keys;
        friend bool operator==(const Description&, const Description&) = default;
    };

    /// Errors (usage, naming `where` and the key): fewer than two keys, times that do not rise, numbers out of range, a
    /// target at the eye.
    static Result<CameraPath> create(Description description, std::string_view where = "camera path");
    /// Strict: an unknown key, a wrong type or a value out of range is an error.
    static Result<CameraPath> from_json(const Json& json, std::string_view where);
    static Result<CameraPath> load(const std::filesystem::path& file);

    [[nodiscard]] Json to_json() const;
    [[nodiscard]] Status save(const std::filesystem::path& file) const;

    /// Times outside the path give its ends.
    [[nodiscard]] CameraPose pose_at(double time_s) const;
    [[nodiscard]] Vec3d velocity_at(double time_s) const;
    [[nodiscard]] double start_s() const { return description_.keys.front().time_s; }
    [[nodiscard]] double duration_s() const { return description_.keys.back().time_s - start_s(); }
    [[nodiscard]] const Description& description() const { return description_; }

  private:
    Description description_;
    SplineCurve eye_;
    SplineCurve aim_; ///< targets, or (yaw, pitch, 0) in degrees
};

/// The checks of CameraPath::create.
Status check_camera_path(const CameraPath::Description& description, std::string_view where);

} // namespace sahel
