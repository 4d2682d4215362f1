#include "render/png_io.h"
#include "run_program.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <unistd.h>

/// What `fly` and `demo` leave behind, as a user calls them: pictures, videos, a window.
namespace {

namespace fs = std::filesystem;
using sahel::tools_test::Outcome;
using sahel::tools_test::run;
using sahel::tools_test::run_line;

class ViewCommand : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (fs::temp_directory_path() / "sahel-view-XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;
        ASSERT_EQ(run("new " + world() + " --preset canyon --seed 3").exit_code, 0);
    }
    void TearDown() override { fs::remove_all(folder_); }
    /// Small, few tiles: root level 3.
    [[nodiscard]] std::string fly(const std::string& more) const {
        return "fly " + world() + " --headless --size 160x90 --stream.root_level=3 " + more;
    }
    [[nodiscard]] std::string world() const { return (folder_ / "world").string(); }
    [[nodiscard]] std::string at(const char* name) const { return (folder_ / name).string(); }
    fs::path folder_;
};

bool no_gl(const Outcome& o) {
    return o.exit_code == 1 && o.output.find("OpenGL: neither") != std::string::npos;
}

TEST_F(ViewCommand, PicturesFoldersAndVideos) {
    const Outcome one = run(fly("--out " + at("one.png") + " --samples 2 --json"));
    if (no_gl(one)) GTEST_SKIP() << one.output;
    ASSERT_EQ(one.exit_code, 0) << one.output;
    const auto picture = sahel::read_png(at("one.png"));
    ASSERT_TRUE(picture.ok());
    EXPECT_EQ(picture->image.width_px, 160);
    EXPECT_EQ(picture->image.height_px, 90);
    ASSERT_EQ(run(fly("--out " + at("again.png") + " --samples 2 --threads 1")).exit_code, 0);
    EXPECT_EQ(sahel::read_png(at("again.png"))->image.pixels, picture->image.pixels) << "the same view, the same bytes";
    ASSERT_EQ(run(fly("--out " + at("slope.png") + " --debug slope")).exit_code, 0);
    EXPECT_NE(sahel::read_png(at("slope.png"))->image.pixels, picture->image.pixels);

    std::ofstream(at("path.json")) << R"({"format": 1, "name": "test", "ease": false, "keys": [
        {"time_s": 0, "position_m": [0, 0, 700], "yaw_deg": 10, "pitch_deg": -8},
        {"time_s": 1, "position_m": [40, 0, 700], "yaw_deg": 16, "pitch_deg": -8}]})";
    const Outcome frames = run(fly("--path " + at("path.json") + " --fps 2 --frames 3 --out " + at("frames")));
    ASSERT_EQ(frames.exit_code, 0) << frames.output;
    for (const char* name : {"frame_00001.png", "frame_00002.png", "frame_00003.png"})
        EXPECT_TRUE(sahel::read_png(folder_ / "frames" / name).ok()) << name;
    EXPECT_FALSE(fs::exists(folder_ / "frames" / "frame_00004.png"));

    const Outcome now =
        run(fly("--path " + at("path.json") + " --fps 2 --frames 2 --realtime --json --out " + at("now")));
    ASSERT_EQ(now.exit_code, 0) << now.output;
    EXPECT_NE(now.output.find("frames_with_parents_standing_in"), std::string::npos) << now.output;

    const Outcome video = run(fly("--orbit --seconds 1 --frames 2 --out " + at("orbit.mp4")));
    ASSERT_EQ(video.exit_code, 0) << video.output;
    if (run_line("command -v ffmpeg").exit_code != 0) GTEST_SKIP() << "ffmpeg is not there: frames instead of a video";
    std::ifstream file(at("orbit.mp4"), std::ios::binary);
    const std::string head((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    ASSERT_GT(head.size(), 200u);
    EXPECT_EQ(head.substr(4, 4), "ftyp");
}

TEST_F(ViewCommand, MistakesAreOneLine) {
    for (const char* more :
         {"--out x.png --debug nosuch", "--out x.png --air nosuch", "--size 10x10 --out x.png", ""}) {
        const Outcome o = run("fly " + world() + " --headless " + more);
        EXPECT_EQ(o.exit_code, 2) << more << ": " << o.output;
        EXPECT_EQ(std::count(o.output.begin(), o.output.end(), '\n'), 1) << o.output;
    }
    EXPECT_FALSE(fs::exists("x.png"));
}

TEST_F(ViewCommand, TheWindowOpensAndCloses) {
    if (run_line("command -v xvfb-run && command -v xauth").exit_code != 0)
        GTEST_SKIP() << "xvfb-run or xauth is not there";
    const Outcome o = run_line("timeout 120 xvfb-run -a -s '-screen 0 800x600x24' " + std::string(SAHEL_PROGRAM) +
                               " fly " + world() + " --size 320x180 --frames 4 --stream.root_level=3");
    EXPECT_EQ(o.exit_code, 0) << o.output;
}

TEST_F(ViewCommand, WithoutADisplayTheWindowSaysWhy) {
    const Outcome o = run_line("env -u DISPLAY -u WAYLAND_DISPLAY " + std::string(SAHEL_PROGRAM) + " fly " + world());
    EXPECT_EQ(o.exit_code, 1) << o.output;
    EXPECT_NE(o.output.find("--headless"), std::string::npos) << o.output;
    EXPECT_EQ(std::count(o.output.begin(), o.output.end(), '\n'), 1) << o.output;
}

TEST_F(ViewCommand, DemoLeavesVideoStillsSheetAndReport) {
    const Outcome o =
        run("demo --out " + at("demo") + " --seconds 1 --fps 2 --samples 1 --still-samples 1 --width 160 --height 90");
    if (no_gl(o)) GTEST_SKIP() << o.output;
    ASSERT_EQ(o.exit_code, 0) << o.output;
    const fs::path demo = folder_ / "demo";
    EXPECT_TRUE(fs::exists(demo / "world" / "world.json"));
    EXPECT_TRUE(fs::exists(demo / "world" / "flight.json"));
    EXPECT_TRUE(sahel::read_png(demo / "contact-sheet.png").ok());
    std::ifstream in(demo / "report.json");
    const std::string report((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    for (const char* word :
         {"\"stills\"", "\"video\"", "\"ms_per_frame\"", "\"processor\"", "\"renderer\"", "\"total_s\""})
        EXPECT_NE(report.find(word), std::string::npos) << word;
    int stills = 0;
    for (const auto& entry : fs::directory_iterator(demo)) {
        if (entry.path().extension() != ".png" || entry.path().filename() == "contact-sheet.png") continue;
        ++stills;
        EXPECT_EQ(sahel::read_png(entry.path())->image.width_px, 160) << entry.path();
    }
    EXPECT_EQ(stills, 4);
}

} // namespace
