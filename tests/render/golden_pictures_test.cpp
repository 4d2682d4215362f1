#include "tests/render/gl_scene.h"

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

/// Small pictures kept in tests/data/render, made on llvmpipe. SAHEL_WRITE_GOLDEN=1 makes them anew.
///
/// The tolerance lets other drivers pass (filtering and rounding differ), but no change of light, colour or place:
/// the mean difference sees exposure, the worst block (16 x 16 pixels, means compared) sees what moved or is missing.
namespace sahel {
namespace {

constexpr double k_mean = 0.012, k_worst_block = 0.05;

struct Golden {
    const char* name;
    const char* preset;
    double x_m, y_m, height_m, yaw_deg, pitch_deg;
};
void PrintTo(const Golden& golden, std::ostream* out) {
    *out << golden.name;
}
const std::vector<Golden> k_goldens = {
    {"oasis", "oasis", -9000.0, -7000.0, 9.0, 20.0, -5.0},
    {"stream", "oasis", -26900.0, -42500.0, 40.0, 68.0, -12.0},
    {"dunes", "dunes", 600.0, -300.0, 8.0, 75.0, -5.0},
    {"canyon", "canyon", 2200.0, 1500.0, 60.0, -140.0, -7.0},
};

class GoldenPictures : public GlTest, public ::testing::WithParamInterface<Golden> {};

TEST_P(GoldenPictures, LookAsTheyDid) {
    const Golden& g = GetParam();
    SceneOptions options;
    options.preset = g.preset;
    Scene scene(options);
    CameraPose pose = scene.pose(g.x_m, g.y_m, g.height_m, g.yaw_deg);
    pose.pitch_deg = g.pitch_deg;
    FrameDesc frame = scene.frame(pose);
    frame.samples = 4;
    const Image image = scene.picture(frame);
    save_for_eyes(std::string("golden_") + g.name + ".png", image);
    const std::filesystem::path path =
        std::filesystem::path(SAHEL_SOURCE_DIR) / "tests/data/render" / (std::string(g.name) + ".png");
    if (std::getenv("SAHEL_WRITE_GOLDEN")) {
        Image rgb(image.width_px, image.height_px, 3);
        for (size_t i = 0, n = rgb.pixels.size() / 3; i < n; ++i)
            std::copy_n(&image.pixels[4 * i], 3, &rgb.pixels[3 * i]);
        ASSERT_TRUE(write_png(path, rgb, {}, k_png_level_small).ok());
        GTEST_SKIP() << "written: " << path;
    }
    const auto golden = read_png(path);
    ASSERT_TRUE(golden.ok()) << golden.error().message;
    const Difference d = compare(image, golden->image);
    EXPECT_LE(d.mean, k_mean) << g.name;
    EXPECT_LE(d.worst_block, k_worst_block) << g.name;

    // The tolerance is not too wide: a little more light, a little turn, a lower sun are seen.
    Atmosphere brighter = options.atmosphere;
    brighter.exposure *= 1.12f;
    scene.session->renderer().set_atmosphere(brighter);
    const Difference light = compare(scene.picture(frame), golden->image);
    EXPECT_GT(light.mean, k_mean) << "exposure + 12 %";
    scene.session->renderer().set_atmosphere(options.atmosphere);
    frame.view = make_view_state({.eye_m = pose.eye_m, .yaw_deg = pose.yaw_deg + 1.5, .pitch_deg = pose.pitch_deg}, {},
                                 options.width, options.height, 0.0);
    const Difference turned = compare(scene.picture(frame), golden->image);
    EXPECT_TRUE(turned.mean > k_mean || turned.worst_block > k_worst_block) << turned.mean << " " << turned.worst_block;
}
INSTANTIATE_TEST_SUITE_P(Views, GoldenPictures, ::testing::ValuesIn(k_goldens),
                         [](const auto& p) { return std::string(p.param.name); });

} // namespace
} // namespace sahel
