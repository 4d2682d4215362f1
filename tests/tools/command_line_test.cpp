#include "tests/tools/run_program.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <unistd.h>

namespace sahel::tools_test {
namespace {

namespace fs = std::filesystem;

class CommandLine : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (fs::temp_directory_path() / "sahel-cli-XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;
    }
    void TearDown() override { fs::remove_all(folder_); }
    [[nodiscard]] std::string world() const { return (folder_ / "world").string(); }
    fs::path folder_;
};

size_t lines_of(const std::string& text) {
    return static_cast<size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST_F(CommandLine, EverySubcommandHasHelp) {
    const Outcome top = run("--help");
    EXPECT_EQ(top.exit_code, 0);
    for (const char* name : {"new", "import", "fly", "demo", "info", "hash", "verify", "bench", "doctor", "scene",
                             "simulate", "experiment"}) {
        EXPECT_NE(top.output.find(name), std::string::npos) << name;
        const Outcome help = run(std::string(name) + " --help");
        EXPECT_EQ(help.exit_code, 0) << name;
        EXPECT_NE(help.output.find("Usage"), std::string::npos) << name << ": " << help.output;
    }
}

TEST_F(CommandLine, MistakesInTheCallExitWithTwoAndOneLine) {
    for (const char* arguments :
         {"", "nosuch", "new", "info", "new W --seed x", "fly", "bench --nosuch", "experiment", "experiment nosuch",
          "experiment columns --size 7", "experiment columns --size 100"}) {
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exit_code, 2) << arguments << ": " << outcome.output;
        EXPECT_EQ(lines_of(outcome.output), 1u) << arguments << ": " << outcome.output;
    }
    for (const std::string& arguments :
         {"new " + world() + " --preset nosuch", "new " + world() + " --tile 100", "new " + world() + " --cell 0",
          "new " + world() + " --terrain.nosuch=1", "new " + world() + " --terrain.dune_m=abc"}) {
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exit_code, 2) << arguments << ": " << outcome.output;
        EXPECT_EQ(lines_of(outcome.output), 1u) << arguments << ": " << outcome.output;
        EXPECT_FALSE(fs::exists(world())) << arguments;
    }
}

TEST_F(CommandLine, MissingWorldExitsWithOneAndNamesIt) {
    for (const char* name : {"info", "hash", "verify", "fly --headless --frames 1 --out x.png"}) {
        const Outcome outcome = run(std::string(name) + " " + world());
        EXPECT_EQ(outcome.exit_code, 1) << name << ": " << outcome.output;
        EXPECT_NE(outcome.output.find(world()), std::string::npos) << outcome.output;
        EXPECT_EQ(lines_of(outcome.output), 1u) << outcome.output;
    }
}

TEST_F(CommandLine, NewInfoHashVerify) {
    EXPECT_EQ(run("new " + world() + " --preset dunes --seed 42 --tile 256 --cell 2").exit_code, 0);
    const Outcome info = run("info " + world() + " --json");
    EXPECT_EQ(info.exit_code, 0);
    for (const char* part : {"\"seed\": 42", "\"preset\": \"dunes\"", "\"tile_cells\": 256", "\"cell_m\": 2.0"})
        EXPECT_NE(info.output.find(part), std::string::npos) << part << " in " << info.output;
    const Outcome hash = run("hash " + world());
    EXPECT_EQ(hash.exit_code, 0);
    EXPECT_EQ(hash.output.size(), 33u) << hash.output; // 32 digits and the end of the line
    EXPECT_EQ(run("verify " + world()).exit_code, 0);
    const Outcome again = run("new " + world());
    EXPECT_EQ(again.exit_code, 2) << again.output;
    EXPECT_NE(again.output.find(world()), std::string::npos) << again.output;
}

TEST_F(CommandLine, VerifyFindsAFileThatDoesNotBelong) {
    ASSERT_EQ(run("new " + world() + " --tile 128").exit_code, 0);
    fs::create_directories(world() + "/tiles");
    std::ofstream(world() + "/tiles/stray.exr") << "x";
    const Outcome verify = run("verify " + world());
    EXPECT_EQ(verify.exit_code, 1) << verify.output;
    EXPECT_NE(verify.output.find("stray.exr"), std::string::npos) << verify.output;
}

TEST_F(CommandLine, BenchNamesTheMachineAndHashesItsResults) {
    const std::string json = (folder_ / "bench.json").string();
    const std::string call =
        "bench --size 64 --filter 'terrain/wetland/level_0$|streaming/update/lod_factor_2' --json ";
    const Outcome a = run(call + json);
    ASSERT_EQ(a.exit_code, 0) << a.output;
    for (const char* word : {"processor", "triad_one_core_gb_per_s", "Mcells/s", "p99_ms", "wetland/level_0"})
        EXPECT_NE(a.output.find(word), std::string::npos) << word;
    std::ifstream in(json);
    const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
    EXPECT_NE(text.find("\"processor\""), std::string::npos);
    EXPECT_NE(text.find("terrain/wetland/level_0"), std::string::npos);
    EXPECT_FALSE(fs::exists(json + ".part"));
    EXPECT_EQ(run("bench --filter nothing-is-called-so").exit_code, 2);
    EXPECT_EQ(run("bench --filter nothing --json /nowhere/at/all.json").exit_code, 1);
}

} // namespace

TEST_F(CommandLine, SceneRunsAndReports) {
    const std::string data = std::string(SAHEL_SOURCE_DIR) + "/tests/data/";
    const fs::path out = folder_ / "pictures";
    const Outcome good = run("scene " + data + "scene_dunes.json --steps 3 --out " + out.string());
    EXPECT_EQ(good.exit_code, 0) << good.output;
    EXPECT_NE(good.output.find("drift_ticks"), std::string::npos) << good.output;
    EXPECT_NE(good.output.find("note: saltationMode Backward"), std::string::npos) << good.output;
    for (const char* name :
         {"height.png", "sand.png", "shadow.png", "wind.png", "sheet.png", "fields.exr", "report.json"})
        EXPECT_GT(fs::file_size(out / name), 100u) << name;
    const Outcome json = run("scene " + data + "scene_oasis.json --steps 0 --json");
    EXPECT_EQ(json.exit_code, 0);
    EXPECT_NE(json.output.find("\"drift_ticks\": 0"), std::string::npos) << json.output;
    const Outcome lapse =
        run("scene " + data + "scene_dunes.json --steps 4 --every 2 --video " + (folder_ / "frames").string());
    EXPECT_EQ(lapse.exit_code, 0) << lapse.output;
    EXPECT_TRUE(fs::exists(folder_ / "frames" / "frame_00002.png"));
}

TEST_F(CommandLine, SceneMistakesAreOneLine) {
    const std::string data = std::string(SAHEL_SOURCE_DIR) + "/tests/data/";
    const fs::path broken = folder_ / "broken.json";
    std::ofstream(broken) << "{\"windSpeed\": ";
    const fs::path wrong = folder_ / "wrong.json";
    std::ofstream(wrong) << "{\"vegTypeCount\": 0, \"windSpeed\": 100}";
    struct {
        std::string arguments;
        int exit_code;
        const char* part;
    } const cases[] = {
        {"scene", 2, "FILE"},
        {"scene /nonexistent.json", 1, "nonexistent"},
        {"scene " + folder_.string(), 2, "folder"},
        {"scene " + broken.string(), 1, "JSON"},
        {"scene " + wrong.string(), 2, "windSpeed"},
        {"scene " + data + "scene_dunes.json --size 100", 2, "multiples of 32"},
        {"scene " + data + "scene_dunes.json --steps -1", 2, "steps"},
        {"scene " + data + "scene_dunes.json --steps 1 --out /proc/nowhere", 1, "/proc"},
    };
    for (const auto& c : cases) {
        const Outcome outcome = run(c.arguments);
        EXPECT_EQ(outcome.exit_code, c.exit_code) << c.arguments << ": " << outcome.output;
        EXPECT_NE(outcome.output.find(c.part), std::string::npos) << outcome.output;
    }
}

} // namespace sahel::tools_test
