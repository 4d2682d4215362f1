#include "tests/tools/run_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace sahel::tools_test {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Doctor, SaysWhatIsHereAndWhatIsMissing) {
    const Outcome outcome = run("doctor --json");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    const auto report = nlohmann::json::parse(outcome.output, nullptr, false);
    ASSERT_TRUE(report.is_object()) << outcome.output;
    for (const char* key : {"sahel", "processor", "kernels", "bandwidth_1_core", "bandwidth_all_cores", "cuda",
                            "opengl", "display", "ffmpeg", "libraries"}) {
        ASSERT_TRUE(report.contains(key)) << key;
        EXPECT_FALSE(report[key].get<std::string>().empty()) << key;
    }
    EXPECT_THAT(report["processor"].get<std::string>(), HasSubstr("cores"));
    EXPECT_THAT(report["bandwidth_1_core"].get<std::string>(), HasSubstr("GB/s"));
    for (const char* library : {"OpenEXR", "GDAL", "SQLite", "oneTBB", "GLFW", "libpng", "Dear ImGui", "meshoptimizer"})
        EXPECT_THAT(report["libraries"].get<std::string>(), HasSubstr(library));
    const bool no_cuda = report["cuda"].get<std::string>().find("runs on the CPU") != std::string::npos;
    bool hint = false;
    for (const auto& h : report["hints"]) hint |= h.get<std::string>().find("NVIDIA") != std::string::npos;
    EXPECT_EQ(hint, no_cuda);
    EXPECT_THAT(run("doctor").output, HasSubstr("libraries"));
}

// What is missing is said, each with what it would enable.
TEST(Doctor, MissingPiecesAreHints) {
    const Outcome outcome = run_line("env -u DISPLAY -u WAYLAND_DISPLAY PATH=/nowhere SAHEL_ISA=baseline " +
                                     std::string(SAHEL_PROGRAM) + " doctor");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    for (const char* words : {"ffmpeg would let", "a display would let", "AVX2 runs", "baseline"})
        EXPECT_THAT(outcome.output, HasSubstr(words));
}

// Built with CUDA or without, the program starts where there is no driver: nothing of CUDA is loaded with it.
TEST(Doctor, NeedsNoDriverToStart) {
    const Outcome libraries = run_line("ldd " + std::string(SAHEL_PROGRAM));
    if (libraries.exit_code != 0) GTEST_SKIP() << "no ldd on this machine";
    EXPECT_THAT(libraries.output, HasSubstr("libc.so"));
    EXPECT_THAT(libraries.output, Not(HasSubstr("libcuda")));
    // And where there is one, it can be hidden.
    const Outcome hidden = run_line("env CUDA_VISIBLE_DEVICES= " + std::string(SAHEL_PROGRAM) + " doctor");
    EXPECT_EQ(hidden.exit_code, 0);
    EXPECT_THAT(hidden.output, HasSubstr("runs on the CPU"));
}

} // namespace
} // namespace sahel::tools_test
