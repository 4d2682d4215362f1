#include "run_program.h"

#include <nlohmann/json.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace sahel::tools_test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class Simulate : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (fs::temp_directory_path() / "sahel-simulate-XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;
    }
    void TearDown() override { fs::remove_all(folder_); }
    [[nodiscard]] std::string world(const std::string& name = "world") const { return (folder_ / name).string(); }
    void make(const std::string& name, int tile_cells = 128) const {
        ASSERT_EQ(run("new " + world(name) + " --preset dunes --tile " + std::to_string(tile_cells)).exit_code, 0);
    }
    [[nodiscard]] std::string hash(const std::string& name) const { return run("hash " + world(name)).output; }
    [[nodiscard]] Json info(const std::string& name) const {
        return Json::parse(run("info --json " + world(name)).output, nullptr, false);
    }
    fs::path folder_;
};

constexpr const char* k_quick = " --device cpu --set wind.epoch_steps=4 ";

void expect_closed(const Json& ledger) {
    ASSERT_TRUE(ledger.is_object());
    EXPECT_EQ(ledger["closed"], true) << ledger.value("problem", "");
    EXPECT_EQ(ledger["residual"]["solids"], 0);
    EXPECT_EQ(ledger["residual"]["waters"], 0);
}

TEST_F(Simulate, ReportsAndAccounts) {
    make("world");
    const Outcome first = run("simulate " + world() + " --region 0,0,2,2 --steps 3 --json" + k_quick);
    ASSERT_EQ(first.exit_code, 0) << first.output;
    const Json report = Json::parse(first.output, nullptr, false);
    ASSERT_TRUE(report.is_object()) << first.output;
    EXPECT_EQ(report["from_step"], 0);
    EXPECT_EQ(report["step"], 3);
    EXPECT_EQ(report["finished"], true);
    EXPECT_EQ(report["hash"].get<std::string>() + "\n", hash("world"));
    expect_closed(report["ledger"]);
    EXPECT_GT(report["ledger"]["layers"]["sand"]["opening"].get<int64_t>(), 0);

    const Outcome text = run("simulate " + world() + " --region 0,0,2,2 --until-step 5" + k_quick);
    ASSERT_EQ(text.exit_code, 0) << text.output;
    for (const char* word : {"ms_per_step", "mcells_per_s", "hash", "residual", "solids 0, waters 0", "airborne_sand"})
        EXPECT_NE(text.output.find(word), std::string::npos) << word << " in " << text.output;

    const Json all = info("world");
    EXPECT_EQ(all["step"], 5);
    EXPECT_EQ(all["tiles"], 4);
    expect_closed(all["ledger"]);
    ASSERT_EQ(all["ledger"]["tiles"].size(), 4u);
    int64_t left = 0, waits = 0;
    for (const Json& tile : all["ledger"]["tiles"]) {
        EXPECT_EQ(tile["residual"]["solids"], 0);
        for (const auto& [layer, account] : tile["layers"].items()) left += account["to_sleeping"].get<int64_t>();
        EXPECT_EQ(tile["layers"]["sand"]["exchanged_by_border"].size(), 8u);
    }
    for (const auto& [layer, ticks] : all["ledger"]["waiting"].items()) waits += ticks.get<int64_t>();
    EXPECT_EQ(left, waits);
    EXPECT_GT(waits, 0);
    const Outcome table = run("info " + world());
    EXPECT_EQ(table.exit_code, 0);
    EXPECT_NE(table.output.find("solids 0, waters 0"), std::string::npos) << table.output;
    EXPECT_EQ(run("verify " + world()).exit_code, 0);
}

TEST_F(Simulate, TheSameHashForEveryTileSizeHaloAndThreadCount) {
    std::string first;
    for (const auto& [tile, halo, threads] : {std::array{256, 16, 2}, {128, 64, 5}, {128, 0, 1}}) {
        const std::string name = std::to_string(tile) + "-" + std::to_string(halo);
        make(name, tile);
        const std::string last = std::to_string(256 / tile);
        const Outcome ran =
            run("simulate " + world(name) + " --region 0,0," + last + "," + last + " --steps 4 --halo " +
                std::to_string(halo) + " --threads " + std::to_string(threads) + k_quick);
        ASSERT_EQ(ran.exit_code, 0) << ran.output;
        if (first.empty()) first = hash(name);
        EXPECT_EQ(hash(name), first) << name;
    }
}

TEST_F(Simulate, StoppedBySignalsItGoesOnToTheSameBits) {
    make("stopped");
    make("whole");
    int64_t at = 0;
    for (const int signal : {SIGINT, SIGTERM}) {
        const std::vector<std::string> words = {
            SAHEL_PROGRAM, "simulate", world("stopped"), "--region", "0,0,2,1", "--until-step",      "1000000",
            "--device",    "cpu",      "--checkpoint",   "1",        "--set",   "wind.epoch_steps=7"};
        const pid_t child = fork();
        if (child == 0) {
            const int nowhere = open("/dev/null", O_RDWR);
            dup2(nowhere, STDOUT_FILENO);
            dup2(nowhere, STDERR_FILENO);
            std::vector<char*> argv;
            for (const std::string& w : words) argv.push_back(const_cast<char*>(w.c_str()));
            argv.push_back(nullptr);
            execv(SAHEL_PROGRAM, argv.data());
            _exit(127);
        }
        int status = 0;
        int64_t step = at;
        while (step == at && waitpid(child, &status, WNOHANG) == 0) { // until it is under way
            const Json now = info("stopped");
            if (now.is_object()) step = now["step"].get<int64_t>();
        }
        kill(child, signal);
        waitpid(child, &status, 0);
        ASSERT_TRUE(WIFEXITED(status));
        EXPECT_EQ(WEXITSTATUS(status), 1);
        at = info("stopped")["step"].get<int64_t>();
        EXPECT_GE(at, step);
    }
    const std::string until = std::to_string(at + 2);
    const std::string call = " --region 0,0,2,1 --device cpu --set wind.epoch_steps=7 --until-step " + until;
    ASSERT_EQ(run("simulate " + world("stopped") + call).exit_code, 0);
    const Outcome whole = run("simulate " + world("whole") + call + " --halo 48");
    ASSERT_EQ(whole.exit_code, 0) << whole.output;
    EXPECT_EQ(hash("stopped"), hash("whole")) << "stopped before step " << at;
    expect_closed(info("stopped")["ledger"]);
}

TEST_F(Simulate, MistakesInTheCallExitWithTwoAndOneLine) {
    make("world");
    const std::string good = " --region 0,0,1,1 --steps 1 --device cpu";
    for (const char* arguments : {"--region 0,0,0,1 --steps 1",
                                  "--region 1,1,0,0 --steps 1",
                                  "--region 0,0,1 --steps 1",
                                  "--region x --steps 1",
                                  "--region 0,0,99999999999,1 --steps 1",
                                  "--region 0,0,70000,70000 --steps 1",
                                  "--region 0,0,1,1",
                                  "--region 0,0,1,1 --steps 0",
                                  "--region 0,0,1,1 --steps -3",
                                  "--region 0,0,1,1 --steps x",
                                  "--region 0,0,1,1 --until-step 0",
                                  "--region 0,0,1,1 --steps 1 --until-step 3",
                                  "--steps 1",
                                  "--region 0,0,1,1 --steps 1 --device gpu",
                                  "--region 0,0,1,1 --steps 1 --device cuda:9",
                                  "--region 0,0,1,1 --steps 1 --device cpu --halo 3",
                                  "--region 0,0,1,1 --steps 1 --device cpu --halo 129",
                                  "--region 0,0,1,1 --steps 1 --halo -1",
                                  "--region 0,0,1,1 --steps 1 --threads -1",
                                  "--region 0,0,1,1 --steps 1 --checkpoint -1",
                                  "--region 0,0,1,1 --steps 1 --device cpu --memory 1MiB",
                                  "--region 0,0,1,1 --steps 1 --memory lots",
                                  "--region 0,0,1,1 --steps 1 --memory 0",
                                  "--region 0,0,1,1 --steps 1 --set sand.lift_rat=1",
                                  "--region 0,0,1,1 --steps 1 --set sand.lift_rate=x",
                                  "--region 0,0,1,1 --steps 1 --set wind.speed=1000"}) {
        const Outcome outcome = run("simulate " + world() + " " + arguments);
        EXPECT_EQ(outcome.exit_code, 2) << arguments << ": " << outcome.output;
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1)
            << arguments << ": " << outcome.output;
    }
    const auto says = [&](const std::string& arguments, const std::string& word) {
        const Outcome outcome = run("simulate " + world() + good + " " + arguments);
        EXPECT_NE(outcome.output.find(word), std::string::npos) << outcome.output;
    };
    says("--set sand.lift_rat=1", "sand.lift_rate");
    says("--halo 3", "at least");
    says("--memory 1MiB", "MiB of memory");
    EXPECT_EQ(info("world")["step"], 0);
    EXPECT_EQ(run("simulate " + world("missing") + good).exit_code, 1);
}

} // namespace
} // namespace sahel::tools_test
