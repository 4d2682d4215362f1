#include "render/camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sahel {
namespace {

TEST(CameraPose, DirectionsFollowTheMap) {
    const auto near = [](const Vec3d& a, const Vec3d& b) {
        for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-12);
    };
    near(view_direction({.yaw_deg = 0.0}), {1, 0, 0});  // east
    near(view_direction({.yaw_deg = 90.0}), {0, 1, 0}); // south
    near(view_direction({.pitch_deg = 30.0}), {std::sqrt(0.75), 0, 0.5});
    CameraPose pose{.eye_m = {1e7, -2e7, 100.0}};
    look_at(pose, {1e7 - 50.0, -2e7, 150.0});
    EXPECT_NEAR(std::abs(pose.yaw_deg), 180.0, 1e-9);
    EXPECT_NEAR(pose.pitch_deg, 45.0, 1e-9);
    look_at(pose, {1e7, -2e7, -100.0}); // straight down: the heading stays
    EXPECT_NEAR(std::abs(pose.yaw_deg), 180.0, 1e-9);
    EXPECT_EQ(pose.pitch_deg, -k_max_pitch_deg);
    EXPECT_DOUBLE_EQ(wrap_degrees(540.0), -180.0);
    EXPECT_DOUBLE_EQ(wrap_degrees(-190.0), 170.0);
}

TEST(CameraPose, ViewStateCarriesEverything) {
    const ViewState v =
        make_view_state({.eye_m = {1, 2, 3}, .yaw_deg = 90, .vertical_fov_deg = 60}, {4, 5, 6}, 1280, 720, 7.0);
    EXPECT_EQ(v.eye_m, (Vec3d{1, 2, 3}));
    EXPECT_EQ(v.velocity_m_per_s, (Vec3d{4, 5, 6}));
    EXPECT_NEAR(v.forward[1], 1.0, 1e-12);
    EXPECT_NEAR(v.vertical_fov_rad, 1.0471975511965976, 1e-12);
    EXPECT_DOUBLE_EQ(v.aspect, 1280.0 / 720.0);
    EXPECT_EQ(v.viewport_height_px, 720);
    EXPECT_EQ(v.ground_m, 7.0);
}

FlyInput held_keys(double t) {
    FlyInput in;
    if (t < 1.0) in.forward = 1.0;
    if (t >= 0.5 && t < 1.5) in.right = 1.0;
    if (t >= 1.0) in.up = 0.5;
    in.fast = t >= 1.25 && t < 1.75;
    return in;
}

TEST(FlyCamera, ThePathDoesNotDependOnTheFrameRate) {
    Vec3d first{};
    for (const int rate : {4, 20, 60, 240}) {
        FlyCamera camera;
        camera.place({.eye_m = {1e6, -3e6, 500}, .yaw_deg = 30});
        for (int i = 0; i < 3 * rate; ++i) {
            const double t = static_cast<double>(i) / rate;
            camera.update(held_keys(t), 1.0 / rate, {});
        }
        if (rate == 4) first = camera.pose().eye_m;
        for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(camera.pose().eye_m[c], first[c], 1e-6) << rate << " frames/s";
    }
    EXPECT_GT(std::hypot(first[0] - 1e6, first[1] + 3e6), 50.0);
}

TEST(FlyCamera, StartsAndStopsSmoothly) {
    FlyCamera camera;
    FlyInput ahead;
    ahead.forward = 1.0;
    double speed = 0.0;
    for (int i = 0; i < 120; ++i) {
        camera.update(ahead, 1.0 / 60, {});
        const double now = camera.velocity_m_per_s()[0];
        EXPECT_GE(now, speed);
        EXPECT_LT(now - speed, 0.1 * camera.speed_m_per_s());
        speed = now;
    }
    EXPECT_NEAR(speed, camera.speed_m_per_s(), 0.01);
    for (int i = 0; i < 240; ++i) camera.update({}, 1.0 / 60, {});
    EXPECT_NEAR(camera.velocity_m_per_s()[0], 0.0, 1e-3);
}

TEST(FlyCamera, StaysAboveTheGroundAndMovesOn) {
    const GroundFunction hills = [](double x, double y) {
        return 40.0 * std::sin(x / 30.0) + 10.0 * std::cos(y / 9.0);
    };
    FlyCamera camera;
    camera.place({.eye_m = {0, 0, 60}, .yaw_deg = 20, .pitch_deg = -30});
    FlyInput dive;
    dive.forward = 1.0;
    for (int i = 0; i < 600; ++i) {
        camera.update(dive, 1.0 / 30, hills);
        const Vec3d& e = camera.pose().eye_m;
        ASSERT_GE(e[2], hills(e[0], e[1]) + 1.5 - 1e-9) << i;
    }
    EXPECT_GT(camera.pose().eye_m[0], 300.0);
}

TEST(FlyCamera, WalkingKeepsTheEyeAtEyeHeight) {
    const GroundFunction slope = [](double x, double) { return 0.3 * x; };
    FlyCamera camera;
    camera.set_mode(MoveMode::walk);
    camera.place({.eye_m = {0, 0, 50}, .pitch_deg = -60});
    FlyInput ahead;
    ahead.forward = 1.0;
    for (int i = 0; i < 300; ++i) camera.update(ahead, 1.0 / 60, slope);
    const Vec3d& e = camera.pose().eye_m;
    EXPECT_NEAR(e[0], 4.0 * (5.0 - 0.18), 0.05); // looking down does not slow the walk
    EXPECT_NEAR(e[2] - slope(e[0], e[1]), 1.7, 0.25);
}

TEST(FlyCamera, WheelChangesTheSpeedWithinItsRange) {
    FlyCamera camera;
    FlyInput wheel;
    wheel.speed_steps = 1.0;
    camera.update(wheel, 0.01, {});
    EXPECT_DOUBLE_EQ(camera.speed_m_per_s(), 37.5);
    wheel.speed_steps = 1000.0;
    camera.update(wheel, 0.01, {});
    EXPECT_EQ(camera.speed_m_per_s(), FlyCamera::k_max_speed_m_per_s);
    wheel.speed_steps = -1000.0;
    camera.update(wheel, 0.01, {});
    EXPECT_EQ(camera.speed_m_per_s(), FlyCamera::k_min_speed_m_per_s);
}

TEST(FlyCamera, LookingNeverTurnsOver) {
    FlyCamera camera;
    FlyInput look;
    look.turn_up_deg = 1000.0;
    look.turn_right_deg = 725.0;
    camera.update(look, 0.01, {});
    EXPECT_EQ(camera.pose().pitch_deg, k_max_pitch_deg);
    EXPECT_NEAR(camera.pose().yaw_deg, 5.0, 1e-9);
}

} // namespace
} // namespace sahel
