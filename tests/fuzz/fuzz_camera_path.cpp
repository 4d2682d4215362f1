#include "render/camera_path.h"
#include "tests/fuzz/fuzz_target.h"
#include "world/params_json.h"

#include <cmath>

/// A camera path as JSON.
namespace sahel::fuzz {

static std::vector<Bytes> camera_path_seeds() {
    return {bytes_of(R"({ "format": 1, "name": "over the lake", "vertical_fov_deg": 50, "ease": true,
  "keys": [ { "time_s": 0, "position_m": [0, 0, 320], "target_m": [500, 0, 300] },
            { "time_s": 2.5, "position_m": [120, 10, 325], "target_m": [600, 40, 300] },
            { "time_s": 6, "position_m": [200, 50, 330], "target_m": [700, 80, 300] } ] })"),
            bytes_of(R"({ "format": 1, "ease": false,
  "keys": [ { "time_s": 0, "position_m": [-1e12, 3, 20], "yaw_deg": 170, "pitch_deg": -10 },
            { "time_s": 9, "position_m": [-1e12, 9, 20], "yaw_deg": -170, "pitch_deg": 12.5 } ] })")};
}

} // namespace sahel::fuzz

SAHEL_FUZZ_TARGET(camera_path, camera_path_seeds) {
    using namespace sahel;
    const auto json = parse_json(text_of(bytes), "path.json");
    if (!json.ok()) return expect_one_line(json.error());
    const auto path = CameraPath::from_json(*json, "path.json");
    if (!path.ok()) return expect_one_line(path.error());
    for (int i = -1; i < 10; ++i) {
        const CameraPose pose = path->pose_at(path->start_s() + 0.13 * i * path->duration_s());
        for (const double v : pose.eye_m) expect(std::isfinite(v), "positions are finite");
    }
    const auto again = CameraPath::from_json(path->to_json(), "path.json");
    expect(again.ok() && again->description() == path->description(), "what was read is written and read again");
}
