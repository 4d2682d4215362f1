#include "tests/tools/run_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <unistd.h>

/// ./demo, ./check and what they share, with commands of the test's own in the place of the system's.
namespace sahel::tools_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

const std::string k_root = SAHEL_SOURCE_DIR;

class Scripts : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (fs::temp_directory_path() / "sahel-scripts-XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        bin_ = pattern;
        command("dpkg-query", "echo 'install ok installed alpha'");
        command("apt-get", "echo \"apt-get $*\" >> \"$CALLS\"");
        command("sudo", "echo \"sudo $*\" >> \"$CALLS\"");
    }
    void TearDown() override { fs::remove_all(bin_); }
    void command(const std::string& name, const std::string& body) const {
        std::ofstream(bin_ / name) << "#!/bin/sh\n" << body << "\n";
        fs::permissions(bin_ / name, fs::perms::owner_all);
    }
    /// Installs as user `id`; the calls of apt-get and sudo are in `calls`.
    Outcome install(const std::string& packages, int id, std::string* calls) const {
        command("id", "echo " + std::to_string(id));
        const fs::path log = bin_ / "calls";
        Outcome outcome = run_line("PATH=" + bin_.string() + ":$PATH CALLS=" + log.string() + " bash -c '. " + k_root +
                                   "/tools/setup.sh; sahel_install " + packages + "'");
        std::ifstream in(log);
        calls->assign(std::istreambuf_iterator<char>(in), {});
        fs::remove(log);
        return outcome;
    }
    fs::path bin_;
};

TEST_F(Scripts, NothingMissingIsNothingSaid) {
    std::string calls;
    const Outcome outcome = install("alpha", 1000, &calls);
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.output, "");
    EXPECT_EQ(calls, "");
}

TEST_F(Scripts, RootInstallsAndSaysWhat) {
    std::string calls;
    const Outcome outcome = install("alpha beta", 0, &calls);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_EQ(outcome.output, "Installing missing packages: beta\n");
    EXPECT_THAT(calls, HasSubstr("install -y"));
    EXPECT_THAT(calls, HasSubstr("beta"));
    EXPECT_THAT(calls, Not(HasSubstr("sudo")));
    EXPECT_THAT(calls, Not(HasSubstr("alpha")));
}

TEST_F(Scripts, OthersAreAskedForSudo) {
    std::string calls;
    const Outcome outcome = install("alpha beta", 1000, &calls);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr("need sudo"));
    EXPECT_THAT(outcome.output, HasSubstr("beta"));
    EXPECT_THAT(calls, HasSubstr("sudo apt-get update"));
    command("sudo", "exit 1"); // the password was wrong
    EXPECT_NE(install("beta", 1000, &calls).exit_code, 0);
}

TEST_F(Scripts, ExplainThemselves) {
    for (const char* name : {"check", "tools/gpu_check"}) {
        const Outcome help = run_line(k_root + "/" + name + " --help");
        EXPECT_EQ(help.exit_code, 0) << name;
        EXPECT_THAT(help.output, HasSubstr(name)) << name;
        const Outcome wrong = run_line(k_root + "/" + name + " --nosuch");
        EXPECT_EQ(wrong.exit_code, 2) << name;
        EXPECT_EQ(std::count(wrong.output.begin(), wrong.output.end(), '\n'), 1) << wrong.output;
    }
    for (const char* name : {"check", "demo", ".ci/run", "tools/gpu_check", "tools/setup.sh"})
        EXPECT_EQ(run_line("bash -n " + k_root + "/" + name).exit_code, 0) << name;
}

TEST_F(Scripts, GpuCheckNeedsAGpuAndSaysSo) {
    command("nvidia-smi", "exit 9");
    const Outcome outcome = run_line("PATH=" + bin_.string() + ":$PATH " + k_root + "/tools/gpu_check");
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.output, HasSubstr("no GPU"));
}

} // namespace
} // namespace sahel::tools_test
