#pragma once

#include <array>
#include <cstdio>
#include <string>
#include <sys/wait.h>

/// Programs as a user calls them.
namespace sahel::tools_test {

struct Outcome {
    int exit_code = -1;
    std::string output; ///< standard output and standard error
};

/// A line for the shell.
inline Outcome run_line(const std::string& line) {
    Outcome outcome;
    FILE* pipe = popen(("{ " + line + " ; } 2>&1 </dev/null").c_str(), "r");
    if (!pipe) return outcome;
    std::array<char, 4096> chunk{};
    while (const size_t n = std::fread(chunk.data(), 1, chunk.size(), pipe)) outcome.output.append(chunk.data(), n);
    const int status = pclose(pipe);
    outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return outcome;
}
/// `sahel ARGUMENTS`.
inline Outcome run(const std::string& arguments) {
    return run_line(std::string(SAHEL_PROGRAM) + " " + arguments);
}

} // namespace sahel::tools_test
