#include "tests/render/gl_scene.h"

#include <epoxy/gl.h>

#include <array>
#include <string>

/// No crack between levels: over a spin of 360 degrees nothing shows through the ground.
///
/// Ground is a height field and the picture's columns are vertical planes (no roll, pitch 0): once a column has left
/// the ground on its way up it never meets it again. A pixel at depth 0 below a covered one is a hole.
namespace sahel {
namespace {

constexpr int k_frames = 24;

int holes_in(const std::vector<float>& depth, int width, int height) {
    int holes = 0;
    for (int x = 0; x < width; ++x) {
        bool covered = false;
        for (int y = 0; y < height; ++y) { // rows from the top
            const bool here = depth[static_cast<size_t>(y * width + x)] > 0.0f;
            covered |= here;
            holes += covered && !here ? 1 : 0;
        }
    }
    return holes;
}

struct Spin {
    int holes = 0;
    int frames_with_holes = 0;
    double covered = 0.0; ///< share of pixels with ground
};

/// `settled`: every picture waits for its tiles; else what is there is drawn, `dt_s` after the last.
Spin spin(Scene& scene, const CameraPose& start, bool settled, double dt_s = 0.0) {
    Renderer& r = scene.session->renderer();
    Spin result;
    std::vector<float> depth;
    for (int i = 0; i < k_frames; ++i) {
        CameraPose pose = start;
        pose.yaw_deg = 360.0 / k_frames * i + 3.0;
        FrameDesc frame = scene.frame(pose);
        frame.depth_only = true;
        if (settled)
            EXPECT_TRUE(scene.session->render_settled(frame).ok());
        else
            scene.session->render_now(frame, dt_s);
        r.read_depth(depth);
        const int holes = holes_in(depth, r.width(), r.height());
        result.holes += holes;
        result.frames_with_holes += holes > 0 ? 1 : 0;
        for (const float d : depth) result.covered += d > 0.0f ? 1.0 : 0.0;
    }
    result.covered /= double{k_frames} * r.width() * r.height();
    return result;
}

SceneOptions options_of(const std::string& preset) {
    SceneOptions o;
    o.preset = preset;
    o.width = 640;
    o.height = 360;
    o.root_level = 4;
    return o;
}

struct Place {
    double x_m, y_m, height_m;
};

class Holes : public GlTest, public ::testing::WithParamInterface<const char*> {};

/// Eyes on the corner of four tiles, just beside an edge of level 1, and anywhere; from the ground to 900 m.
TEST_P(Holes, NoneInASettledSpin) {
    Scene scene(options_of(GetParam()));
    for (const Place p :
         {Place{512.0, 1024.0, 2.0}, {1023.99, 640.3, 35.0}, {512.0, 1024.0, 250.0}, {1023.99, 640.3, 900.0}}) {
        const Spin s = spin(scene, scene.pose(p.x_m, p.y_m, p.height_m), true);
        EXPECT_EQ(s.holes, 0) << s.frames_with_holes << " frames at " << p.x_m << ", " << p.y_m << ", " << p.height_m
                              << " m above ground";
        EXPECT_GT(s.covered, 0.25);
        EXPECT_EQ(scene.session->streamer().stats().fallbacks, 0);
    }
}
INSTANTIATE_TEST_SUITE_P(Presets, Holes, ::testing::Values("mountains", "canyon", "dunes", "islands"),
                         [](const auto& p) { return std::string(p.param); });

/// Parents stand in where children are withheld (P5): beside ground that is there in full.
TEST_F(GlTest, NoHoleWhereParentsStandIn) {
    Scene scene(options_of("canyon"));
    const CameraPose start = scene.pose(512.0, 1024.0, 35.0);
    ASSERT_TRUE(scene.session->render_settled(scene.frame(start)).ok());
    // Some hundred metres on, without the two finest levels: old tiles are there, new ones are not.
    scene.terrain.least_level = 2;
    for (const double on : {400.0, 900.0, 2500.0}) {
        const Spin s = spin(scene, scene.pose(512.0 + on, 1024.0 + 0.3 * on, 35.0), false, 1.0 / 60.0);
        EXPECT_EQ(s.holes, 0) << s.frames_with_holes << " frames, " << on << " m on";
        EXPECT_GT(s.covered, 0.25);
        EXPECT_GT(scene.session->streamer().stats().fallbacks, 0) << on;
    }
}

/// New tiles ease in from their parent's shape while their neighbours are long there.
TEST_F(GlTest, NoHoleWhileTilesEaseIn) {
    Scene scene(options_of("canyon"));
    ASSERT_TRUE(scene.session->render_settled(scene.frame(scene.pose(512.0, 1024.0, 35.0))).ok());
    const Spin s = spin(scene, scene.pose(1400.0, 1300.0, 35.0), false, 1.0 / 60.0);
    EXPECT_EQ(s.holes, 0) << s.frames_with_holes << " frames";
}

/// The measure itself: it sees one pixel.
TEST(HoleMeasure, SeesOnePixel) {
    std::vector<float> depth(8 * 6, 0.0f);
    for (size_t i = 16; i < depth.size(); ++i) depth[i] = 0.5f;
    EXPECT_EQ(holes_in(depth, 8, 6), 0);
    depth[27] = 0.0f;
    EXPECT_EQ(holes_in(depth, 8, 6), 1);
}

} // namespace
} // namespace sahel
