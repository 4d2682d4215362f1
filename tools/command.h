#pragma once

#include "world/json_fwd.h"
#include "world/result.h"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

/// The frame of the command line: every subcommand is a function that adds its options and a body that returns the
/// exit code. 0 is success, 1 a failure of the outside world, 2 a mistake in the call; each failure is one line.
namespace sahel::tools {

class CommandLine {
  public:
    CommandLine();

    /// A subcommand; `body` runs after its options were parsed.
    CLI::App& add(const std::string& name, const std::string& help, std::function<int()> body);
    int run(int argc, char** argv);

    CLI::App& app() { return app_; }

  private:
    struct Command {
        CLI::App* app;
        std::function<int()> body;
    };
    CLI::App app_;
    std::vector<Command> commands_;
};

/// Prints "sahel: MESSAGE" and gives the exit code.
int fail(const Error& error);

/// Prints JSON to standard output, or a table of "name  value" lines.
void print_report(const Json& report, bool as_json);

/// Bytes as "1.5 GiB"; counts as "12.3 M".
std::string human_bytes(uint64_t bytes);
/// "4GiB", "512MiB", "1000000": bytes. Errors: usage.
Result<uint64_t> parse_bytes(const std::string& text);

/// A progress bar on a terminal; silent elsewhere.
class ProgressBar {
  public:
    explicit ProgressBar(std::string title);
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;
    ~ProgressBar();
    void update(int64_t done, int64_t total, const std::string& note = {});

  private:
    std::string title_;
    bool on_terminal_;
    bool shown_ = false;
    double last_s_ = -1.0;
    double start_s_;
};

/// Seconds of a steady clock.
double now_s();

// The subcommands, one file each.
void add_new_command(CommandLine& line);
void add_import_command(CommandLine& line);
void add_simulate_command(CommandLine& line);
void add_inspect_commands(CommandLine& line); // info, hash, verify
void add_doctor_command(CommandLine& line);
void add_scene_command(CommandLine& line);
void add_bench_command(CommandLine& line);
void add_fly_command(CommandLine& line);
void add_demo_command(CommandLine& line);
void add_experiment_command(CommandLine& line);

} // namespace sahel::tools
