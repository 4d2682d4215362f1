#include "render/hud.h"
#include "tests/render/gl_scene.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

/// What must hold for every picture: the same bytes each time, parents in place of what is missing, debug
/// views and panels without GL errors.
namespace sahel {
namespace {

constexpr double k_x_m = -9000.0, k_y_m = -7000.0; // a lake shore of oasis, seed 1

SceneOptions options_of(int workers) {
    SceneOptions o;
    o.workers = workers;
    return o;
}

TEST_F(GlTest, SamePictureEachTimeAndForAnyNumberOfWorkers) {
    Image first;
    for (const int workers : {1, 3}) {
        Scene scene(options_of(workers));
        FrameDesc frame = scene.frame(scene.pose(k_x_m, k_y_m, 6.0, 20.0));
        frame.samples = 2;
        const Image image = scene.picture(frame);
        EXPECT_EQ(compare(image, scene.picture(frame)).mean, 0.0) << "the same frame again";
        // Away and back: what was drawn in between must leave no trace.
        FrameDesc elsewhere = scene.frame(scene.pose(k_x_m + 3000.0, k_y_m, 200.0, -100.0));
        EXPECT_GT(compare(image, scene.picture(elsewhere)).mean, 0.01);
        EXPECT_EQ(scene.picture(frame).pixels, image.pixels) << "after another view";
        if (first.pixels.empty())
            first = image;
        else
            EXPECT_EQ(first.pixels, image.pixels) << workers << " workers";
    }
}

/// P5: where children are missing their parents are drawn, the picture is about the same, and the children come once
/// they can.
TEST_F(GlTest, ParentsStandInUntilTheirChildrenCome) {
    Scene scene(options_of(0));
    const FrameDesc frame = scene.frame(scene.pose(k_x_m, k_y_m, 18.0, 20.0));
    scene.terrain.least_level = 2;
    EXPECT_FALSE(scene.session->render_settled(frame).ok());
    const Image coarse = scene.picture_now(frame, 1.0 / 60.0);
    EXPECT_GT(scene.session->streamer().stats().fallbacks, 0);
    EXPECT_EQ(scene.session->streamer().stats().missing_roots, 0);
    for (const VisibleTile& t : scene.session->streamer().frame().visible) EXPECT_GE(t.key.level, 2);
    save_for_eyes("parents.png", coarse);

    scene.terrain.least_level = 0;
    scene.session->streamer().invalidate_all();
    for (int i = 0; i < 2000 && !scene.session->streamer().ready(); ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(2)); // for the workers
        scene.session->render_now(frame, 1.0 / 60.0);
    }
    ASSERT_TRUE(scene.session->streamer().ready());
    EXPECT_EQ(scene.session->streamer().stats().fallbacks, 0);
    const Image fine = scene.picture(frame);
    save_for_eyes("children.png", fine);
    const Difference all = compare(coarse, fine);
    EXPECT_GT(all.mean, 0.002) << "the children add nothing: the test is blind";
    EXPECT_LT(all.mean, 0.10) << "a parent shows the same landscape";
}

/// Ripples lie across the wind that was simulated: brightness changes along it, hardly across.
TEST_F(GlTest, RipplesFollowTheSimulatedWind) {
    SceneOptions options = options_of(0);
    options.preset = "dunes";
    Image calm;
    for (const float wind_deg : {-1.0f, 0.0f, 90.0f}) {
        Scene scene(options);
        scene.terrain.wind_deg = wind_deg;
        CameraPose pose = scene.pose(250.0, 250.0, 9.0, 270.0); // looks north, straight down: x is east, y is south
        pose.pitch_deg = -89.9;
        FrameDesc frame = scene.frame(pose);
        frame.samples = 4;
        const Image image = scene.picture(frame);
        save_for_eyes("ripples_" + std::to_string(static_cast<int>(wind_deg)) + ".png", image);
        if (wind_deg < 0.0f) {
            calm = image;
            continue;
        }
        EXPECT_GT(compare(calm, image).mean, 0.002) << "the wind of the preset blows to 30 degrees";
        double along_x = 0.0, along_y = 0.0;
        for (int y = 1; y < image.height_px; ++y)
            for (int x = 1; x < image.width_px; ++x) {
                along_x += std::abs(image.at(x, y)[1] - image.at(x - 1, y)[1]);
                along_y += std::abs(image.at(x, y)[1] - image.at(x, y - 1)[1]);
            }
        std::printf("wind to %g deg: brightness changes by %g along x, %g along y\n", static_cast<double>(wind_deg),
                    along_x, along_y);
        if (wind_deg == 0.0f)
            EXPECT_GT(along_x, 2.0 * along_y);
        else
            EXPECT_GT(along_y, 2.0 * along_x);
        // Elsewhere and back: patterns stay where they are.
        FrameDesc elsewhere = scene.frame(scene.pose(700.0, 250.0, 9.0));
        (void)scene.picture(elsewhere);
        EXPECT_EQ(scene.picture(frame).pixels, image.pixels);
    }
}

TEST_F(GlTest, EveryDebugViewIsAViewOfItsOwn) {
    Scene scene(options_of(0));
    scene.terrain.wind_deg = 40.0f;
    FrameDesc frame = scene.frame(scene.pose(k_x_m, k_y_m, 18.0, 20.0));
    std::vector<std::pair<Image, const char*>> seen;
    for (int v = 0; v < static_cast<int>(DebugView::count_); ++v) {
        frame.debug = static_cast<DebugView>(v);
        const Image image = scene.picture(frame);
        save_for_eyes(std::string("view_") + name_of(frame.debug) + ".png", image);
        for (const auto& [other, name] : seen)
            EXPECT_GT(compare(image, other).mean, 0.0) << name_of(frame.debug) << " looks like " << name;
        seen.emplace_back(image, name_of(frame.debug));
        EXPECT_EQ(context->take_errors(), "") << name_of(frame.debug);
    }
    frame.debug = DebugView::none;
    const Image plain = scene.picture(frame);
    EXPECT_EQ(compare(plain, seen.front().first).mean, 0.0) << "debug views leave a trace";
    frame.wireframe = true;
    EXPECT_GT(compare(plain, scene.picture(frame)).mean, 0.01);
    frame.wireframe = false;
    EXPECT_EQ(plain.pixels, scene.picture(frame).pixels) << "wireframe leaves a trace";
}

TEST_F(GlTest, DepthOnlyLeavesThePictureAndFindsTheSameDepth) {
    Scene scene(options_of(0));
    FrameDesc frame = scene.frame(scene.pose(k_x_m, k_y_m, 18.0, 160.0));
    const Image plain = scene.picture(frame);
    std::vector<float> depth;
    frame.depth_only = true;
    EXPECT_EQ(scene.picture(frame).pixels, plain.pixels);
    scene.session->renderer().read_depth(depth);
    const auto covered = std::count_if(depth.begin(), depth.end(), [](float d) { return d > 0.0f; });
    EXPECT_GT(covered, static_cast<ptrdiff_t>(depth.size() / 4));
    EXPECT_LT(covered, static_cast<ptrdiff_t>(depth.size()));
}

TEST_F(GlTest, PanelsOverThePictureAndOtherSizes) {
    Scene scene(options_of(0));
    Renderer& r = scene.session->renderer();
    const auto hud = Hud::create(nullptr);
    for (const auto& [w, h] : {std::pair{640, 360}, {1, 1}, {317, 203}, {640, 360}}) {
        r.resize(w, h);
        const CameraPose pose = scene.pose(k_x_m, k_y_m, 18.0, 20.0);
        const Image plain = scene.picture(scene.frame(pose));
        EXPECT_EQ(plain.width_px, w);
        HudModel model;
        model.title = "test";
        model.pose = pose;
        model.render = r.stats();
        model.stream = scene.session->streamer().stats();
        scene.session->streamer().list_nodes(model.nodes);
        EXPECT_FALSE(model.nodes.empty());
        HudControls controls;
        glBindFramebuffer(GL_FRAMEBUFFER, r.framebuffer());
        for (int i = 0; i < 2; ++i) hud->draw(model, controls, w, h, 1.0 / 60.0);
        if (w == 640) {
            const Image panels = scene.read();
            save_for_eyes("panels.png", panels);
            EXPECT_GT(compare(plain, panels).mean, 0.02);
        }
        EXPECT_EQ(scene.picture(scene.frame(pose)).pixels, plain.pixels) << "panels leave a trace in the next frame";
        EXPECT_EQ(context->take_errors(), "") << w << " x " << h;
    }
}

} // namespace
} // namespace sahel
