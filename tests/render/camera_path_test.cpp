#include "render/camera_flights.h"
#include "render/camera_path.h"
#include "world/file_io.h"
#include "world/params_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

namespace sahel {
namespace {

using ::testing::HasSubstr;

double distance(const Vec3d& a, const Vec3d& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

CameraPath::Description winding_path(bool targets, bool ease) {
    CameraPath::Description d;
    d.name = "winding";
    d.ease = ease;
    d.aims_at_targets = targets;
    // Uneven times and distances, a stop in the middle, far from the origin.
    const std::vector<double> times{0.5, 1.0, 4.0, 5.0, 5.5, 12.0};
    const std::vector<Vec3d> eyes{{1e6, 0, 10},        {1e6 + 3, 1, 12},    {1e6 + 90, -40, 60},
                                  {1e6 + 90, -40, 60}, {1e6 + 95, -20, 50}, {1e6 + 400, 200, 20}};
    for (size_t i = 0; i < times.size(); ++i) {
        CameraKey key;
        key.time_s = times[i];
        key.position_m = eyes[i];
        if (targets)
            key.target_m = {1e6 + 150.0 + 20.0 * static_cast<double>(i), 300.0, 5.0};
        else {
            key.yaw_deg = wrap_degrees(150.0 + 25.0 * static_cast<double>(i)); // over the +-180 seam
            key.pitch_deg = -10.0 + 3.0 * static_cast<double>(i);
        }
        d.keys.push_back(key);
    }
    return d;
}

TEST(CameraPath, HitsEveryKeyFrame) {
    for (const bool targets : {true, false})
        for (const bool ease : {true, false}) {
            auto path = CameraPath::create(winding_path(targets, ease));
            ASSERT_TRUE(path.ok()) << path.error().message;
            for (const CameraKey& key : path->description().keys) {
                const CameraPose pose = path->pose_at(key.time_s);
                EXPECT_LT(distance(pose.eye_m, key.position_m), 1e-6) << key.time_s;
                CameraPose want = pose;
                want.yaw_deg = key.yaw_deg;
                want.pitch_deg = key.pitch_deg;
                if (targets) look_at(want, key.target_m);
                EXPECT_LT(distance(view_direction(pose), view_direction(want)), 1e-6) << key.time_s;
            }
        }
}

TEST(CameraPath, SpeedHasNoJumps) {
    auto path = CameraPath::create(winding_path(true, true));
    ASSERT_TRUE(path.ok());
    for (const CameraKey& key : path->description().keys) {
        const double h = 1e-6;
        const Vec3d before = path->velocity_at(key.time_s - h);
        const Vec3d after = path->velocity_at(key.time_s + h);
        if (key.time_s > path->start_s() && key.time_s < path->start_s() + path->duration_s()) {
            EXPECT_LT(distance(before, after), 0.02) << key.time_s;
        }
    }
    // The velocity is the derivative of the position.
    for (double t = 0.6; t < 11.9; t += 0.37) {
        const double h = 1e-4;
        const Vec3d a = path->pose_at(t - h).eye_m, b = path->pose_at(t + h).eye_m, v = path->velocity_at(t);
        for (size_t c = 0; c < 3; ++c) EXPECT_NEAR((b[c] - a[c]) / (2 * h), v[c], 1e-2) << t;
    }
    // At rest at both ends, moving in between, and still outside.
    EXPECT_LT(distance(path->velocity_at(0.5), {}), 1e-9);
    EXPECT_LT(distance(path->velocity_at(12.0), {}), 1e-9);
    EXPECT_GT(distance(path->velocity_at(8.0), {}), 1.0);
    EXPECT_EQ(path->pose_at(-5.0).eye_m, path->pose_at(0.5).eye_m);
    EXPECT_EQ(path->pose_at(99.0).eye_m, path->pose_at(12.0).eye_m);
}

TEST(CameraPath, TakesTheShortWayRound) {
    CameraPath::Description d;
    d.aims_at_targets = false;
    d.keys = {{.time_s = 0, .yaw_deg = 170}, {.time_s = 1, .position_m = {1, 0, 0}, .yaw_deg = -170}};
    auto path = CameraPath::create(d);
    ASSERT_TRUE(path.ok());
    for (double t = 0; t <= 1.0; t += 0.1) EXPECT_GE(std::abs(path->pose_at(t).yaw_deg), 170.0 - 1e-9) << t;
}

TEST(CameraPath, JsonComesBackAsItWas) {
    const auto file = std::filesystem::path(::testing::TempDir()) / ("path_" + std::to_string(::getpid()) + ".json");
    for (const bool targets : {true, false}) {
        auto path = CameraPath::create(winding_path(targets, !targets));
        ASSERT_TRUE(path.ok());
        ASSERT_TRUE(path->save(file).ok());
        auto back = CameraPath::load(file);
        ASSERT_TRUE(back.ok()) << back.error().message;
        EXPECT_EQ(back->description(), path->description());
    }
    std::filesystem::remove(file);
    EXPECT_EQ(CameraPath::load(file).error().kind, ErrorKind::not_found);
}

struct BadPath {
    const char* json;
    const char* names; ///< what the message must name besides the file
};
void PrintTo(const BadPath& path, std::ostream* out) { // else its addresses, which change with every build
    *out << path.names;
}
class CameraPathErrors : public ::testing::TestWithParam<BadPath> {};

TEST_P(CameraPathErrors, NameFileAndKey) {
    const auto json = parse_json(GetParam().json, "flight.json");
    const auto path = json.ok() ? CameraPath::from_json(json.value(), "flight.json") : json.error();
    ASSERT_FALSE(path.ok());
    EXPECT_THAT(path.error().message, HasSubstr("flight.json"));
    EXPECT_THAT(path.error().message, HasSubstr(GetParam().names));
    EXPECT_EQ(path.error().message.find('\n'), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(
    All, CameraPathErrors,
    ::testing::Values(
        BadPath{"[1, 2]", "object"}, BadPath{"{", "JSON"}, BadPath{R"({"keys": []})", "'format'"},
        BadPath{R"({"format": 2, "keys": []})", "format 2"}, BadPath{R"({"format": 1})", "'keys'"},
        BadPath{R"({"format": 1, "keys": {}})", "'keys'"},
        BadPath{R"({"format": 1, "key": []})", "did you mean 'keys'"},
        BadPath{R"({"format": 1, "ease": 1, "keys": []})", "'ease'"},
        BadPath{R"({"format": 1, "vertical_fov_deg": 500, "keys": []})", "'vertical_fov_deg' is 500"},
        BadPath{R"({"format": 1, "keys": [{"time_s": 0, "position_m": [0,0,0], "target_m": [1,0,0]}]})",
                "1 key frames"},
        BadPath{R"({"format": 1, "keys": [{"time_s": 0, "position": [0,0,0], "target_m": [1,0,0]}]})",
                "keys[0].position"},
        BadPath{R"({"format": 1, "keys": [{"time_s": 0, "position_m": [0,0], "target_m": [1,0,0]}]})",
                "keys[0].position_m"},
        BadPath{R"({"format": 1, "keys": [{"time_s": 0, "position_m": [0,"a",0], "target_m": [1,0,0]}]})",
                "keys[0].position_m[1]"},
        BadPath{R"({"format": 1, "keys": [{"time_s": "soon", "position_m": [0,0,0], "target_m": [1,0,0]}]})",
                "keys[0].time_s"},
        BadPath{R"({"format": 1, "keys": [{"position_m": [0,0,0], "target_m": [1,0,0]}]})", "'time_s'"},
        BadPath{R"({"format": 1, "keys": [{"time_s": 0, "position_m": [0,0,0]}]})", "keys[0]"},
        BadPath{R"({"format": 1, "keys": [{"time_s": 0, "position_m": [0,0,0], "yaw_deg": 0}]})", "keys[0]"},
        BadPath{R"({"format": 1, "keys": [{"time_s": 0, "position_m": [0,0,0], "target_m": [1,0,0], "yaw_deg": 0}]})",
                "keys[0]"},
        BadPath{R"({"format": 1, "keys": [{"time_s": 0, "position_m": [0,0,0], "target_m": [1,0,0]},
                                          {"time_s": 0, "position_m": [9,0,0], "target_m": [1,0,0]}]})",
                "keys[1].time_s"},
        BadPath{R"({"format": 1, "keys": [{"time_s": 0, "position_m": [0,0,0], "target_m": [1,0,0]},
                                          {"time_s": 1, "position_m": [9,0,0], "target_m": [9,0,0]}]})",
                "keys[1].target_m"},
        BadPath{R"({"format": 1, "keys": [{"time_s": 0, "position_m": [0,0,0], "target_m": [1,0,0]},
                                          {"time_s": 1, "position_m": [9,0,0], "yaw_deg": 0, "pitch_deg": 0}]})",
                "keys[1]"},
        BadPath{R"({"format": 1, "keys": [{"time_s": 0, "position_m": [0,0,0], "yaw_deg": 0, "pitch_deg": 95},
                                          {"time_s": 1, "position_m": [9,0,0], "yaw_deg": 0, "pitch_deg": 0}]})",
                "keys[0].pitch_deg"},
        BadPath{R"({"format": 1, "keys": [{"time_s": 0, "position_m": [0,0,1e300], "yaw_deg": 0, "pitch_deg": 0},
                                          {"time_s": 1, "position_m": [9,0,0], "yaw_deg": 0, "pitch_deg": 0}]})",
                "keys[0].position_m[2]"}));

// --- flights ---------------------------------------------------------------------------------------------------------

const GroundFunction k_hills = [](double x, double y) {
    const double dune = 18.0 * std::sin(x / 45.0 + 0.6 * std::sin(y / 70.0));
    const double cliff = 80.0 / (1.0 + std::exp(-(x - 300.0) / 6.0)); // a wall of 80 m
    return 300.0 + dune + cliff + 3.0 * std::sin(x / 7.0) * std::cos(y / 11.0);
};

void expect_within(const FlightReport& r, double height_m, const FlightLimits& limits) {
    EXPECT_GE(r.lowest_m, height_m - 0.5);
    EXPECT_GE(r.lowest_m, limits.clearance_m);
    EXPECT_LE(r.top_speed_per_height_per_s, limits.speed_per_height_per_s);
    EXPECT_LE(r.top_turn_deg_per_s, limits.turn_deg_per_s);
    EXPECT_GT(r.length_m, 100.0);
}

TEST(Flights, OrbitKeepsItsLimits) {
    for (const double height : {12.0, 60.0, 250.0}) {
        OrbitOptions o{.centre_m = {250, 40}, .radius_m = 350, .height_m = height};
        auto path = orbit_path(o, k_hills);
        ASSERT_TRUE(path.ok()) << path.error().message;
        expect_within(measure_flight(*path, k_hills), height, o.limits);
        EXPECT_GE(path->duration_s(), 25.0); // 360 degrees at 12 a second, a little less where it looks down
        const CameraPose a = path->pose_at(0), b = path->pose_at(path->duration_s());
        EXPECT_LT(distance(a.eye_m, b.eye_m), 20.0);
        // It looks at the centre all the way.
        for (double t = 0; t < path->duration_s(); t += 1.7) {
            const CameraPose p = path->pose_at(t);
            CameraPose aimed = p;
            look_at(aimed, {250, 40, k_hills(250, 40) + 0.2 * height});
            EXPECT_LT(distance(view_direction(p), view_direction(aimed)), 0.02) << t;
        }
    }
}

TEST(Flights, FlyoverKeepsItsLimitsInSharpTurns) {
    for (const double height : {5.0, 30.0, 130.0}) {
        FlyoverOptions o;
        o.waypoints_m = {{-400, 0}, {100, 50}, {250, 400}, {700, 300}, {720, -200}};
        o.height_m = height;
        auto path = flyover_path(o, k_hills);
        ASSERT_TRUE(path.ok()) << path.error().message;
        expect_within(measure_flight(*path, k_hills), height, o.limits);
        EXPECT_LT(std::hypot(path->pose_at(1e9).eye_m[0] - 720, path->pose_at(1e9).eye_m[1] + 200), 1.0);
    }
}

TEST(Flights, LastAsLongAsAsked) {
    FlyoverOptions o;
    o.waypoints_m = {{0, 0}, {5000, 0}};
    o.height_m = 40;
    for (const double duration : {12.0, 90.0, 400.0}) { // cut short, about as allowed, slower
        o.duration_s = duration;
        auto path = flyover_path(o, k_hills);
        ASSERT_TRUE(path.ok());
        EXPECT_NEAR(path->duration_s(), duration, 1e-6);
        expect_within(measure_flight(*path, k_hills), 40, o.limits);
    }
    OrbitOptions orbit{.duration_s = 12.0};
    auto path = orbit_path(orbit, k_hills);
    ASSERT_TRUE(path.ok());
    EXPECT_NEAR(path->duration_s(), 12.0, 1e-6);
    expect_within(measure_flight(*path, k_hills), orbit.height_m, orbit.limits);
}

TEST(Flights, WishedSpeedIsKept) {
    FlyoverOptions o;
    o.waypoints_m = {{0, 0}, {1000, 0}};
    o.height_m = 40;
    o.speed_m_per_s = 14;
    const GroundFunction flat = [](double, double) { return 5.0; };
    auto path = flyover_path(o, flat);
    ASSERT_TRUE(path.ok());
    EXPECT_NEAR(measure_flight(*path, flat).top_speed_m_per_s, 14.0, 0.3);
    EXPECT_NEAR(path->duration_s(), 1000.0 / 14.0, 4.0);
    EXPECT_NEAR(path->pose_at(20.0).eye_m[2], 45.0, 1e-6);
    EXPECT_NEAR(path->pose_at(20.0).pitch_deg, -6.0, 1e-6);
}

TEST(Flights, FarFromTheOriginTheyAreTheSame) {
    const double far = 4e9;
    const GroundFunction flat = [](double, double) { return 0.0; };
    OrbitOptions o{.centre_m = {far, -far}, .radius_m = 200, .height_m = 50};
    auto path = orbit_path(o, flat);
    ASSERT_TRUE(path.ok());
    expect_within(measure_flight(*path, flat), 50, o.limits);
}

TEST(Flights, ImpossibleWishesAreErrors) {
    const GroundFunction flat = [](double, double) { return 0.0; };
    EXPECT_THAT(orbit_path({.height_m = 1.0}, flat).error().message, HasSubstr("height"));
    EXPECT_THAT(orbit_path({.radius_m = 0.0}, flat).error().message, HasSubstr("radius"));
    EXPECT_THAT(orbit_path({.arc_deg = 0.0}, flat).error().message, HasSubstr("arc"));
    EXPECT_THAT(flyover_path({.waypoints_m = {{0, 0}}}, flat).error().message, HasSubstr("way points"));
    EXPECT_THAT(flyover_path({.waypoints_m = {{0, 0}, {0, 0}}}, flat).error().message, HasSubstr("apart"));
    EXPECT_THAT(flyover_path({.waypoints_m = {{0, 0}, {std::nan(""), 0}}}, flat).error().message, HasSubstr("apart"));
    EXPECT_THAT(flyover_path({.waypoints_m = {{0, 0}, {9, 0}}, .duration_s = -1}, flat).error().message,
                HasSubstr("duration"));
}

} // namespace
} // namespace sahel
