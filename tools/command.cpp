#include "tools/command.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <unistd.h>

namespace sahel::tools {

double now_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

CommandLine::CommandLine() : app_("Sahel: a living landscape larger than memory", "sahel") {
    app_.require_subcommand(1);
    app_.failure_message(CLI::FailureMessage::simple);
    app_.set_version_flag("--version", std::string(SAHEL_VERSION));
    app_.get_formatter()->column_width(34);
}

CLI::App& CommandLine::add(const std::string& name, const std::string& help, std::function<int()> body) {
    CLI::App* sub = app_.add_subcommand(name, help);
    commands_.push_back({sub, std::move(body)});
    return *sub;
}

int CommandLine::run(int argc, char** argv) {
    try {
        app_.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0) return app_.exit(e); // --help, --version
        std::fprintf(stderr, "sahel: %s; see sahel --help\n", e.what());
        return 2;
    }
    for (const Command& command : commands_) {
        if (!command.app->parsed()) continue;
        try {
            return command.body();
        } catch (const std::exception& e) { // a library's exception, for example out of memory
            std::fprintf(stderr, "sahel %s: %s\n", command.app->get_name().c_str(), e.what());
            return 1;
        }
    }
    return 2;
}

int fail(const Error& error) {
    std::fprintf(stderr, "sahel: %s\n", error.message.c_str());
    return error.exit_code();
}

void print_report(const nlohmann::ordered_json& report, bool as_json) {
    if (as_json) {
        std::fputs((report.dump(2) + "\n").c_str(), stdout);
        return;
    }
    size_t width = 0;
    for (const auto& [key, value] : report.items()) width = std::max(width, key.size());
    for (const auto& [key, value] : report.items()) {
        const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
        fmt::print("{:<{}}  {}\n", key, width, text);
    }
}

std::string human_bytes(uint64_t bytes) {
    constexpr const char* k_units[] = {"B", "KiB", "MiB", "GiB", "TiB", "PiB"};
    auto value = static_cast<double>(bytes);
    size_t unit = 0;
    while (value >= 1024.0 && unit + 1 < std::size(k_units)) {
        value /= 1024.0;
        ++unit;
    }
    return unit == 0 ? fmt::format("{} B", bytes) : fmt::format("{:.1f} {}", value, k_units[unit]);
}

Result<uint64_t> parse_bytes(const std::string& text) {
    size_t used = 0;
    double value = -1.0;
    try {
        value = std::stod(text, &used);
    } catch (const std::exception&) {
        value = -1.0;
    }
    std::string unit = text.substr(std::min(used, text.size()));
    for (char& c : unit) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    int power = -1;
    if (unit.empty() || unit == "b") power = 0;
    if (unit == "k" || unit == "kib") power = 1;
    if (unit == "m" || unit == "mib") power = 2;
    if (unit == "g" || unit == "gib") power = 3;
    if (unit == "t" || unit == "tib") power = 4;
    const double bytes = value * std::pow(1024.0, power);
    if (power < 0 || !(value >= 0.0) || bytes > 9.0e18)
        return Error{ErrorKind::usage, fmt::format("'{}' is not a size; write for example 512MiB or 4GiB", text)};
    return static_cast<uint64_t>(bytes);
}

ProgressBar::ProgressBar(std::string title)
    : title_(std::move(title)), on_terminal_(isatty(STDERR_FILENO) != 0), start_s_(now_s()) {}

ProgressBar::~ProgressBar() {
    if (shown_) std::fputs("\n", stderr);
}

void ProgressBar::update(int64_t done, int64_t total, const std::string& note) {
    const double t = now_s();
    if (!on_terminal_ || total <= 0 || (done < total && t - last_s_ < 0.1)) return;
    last_s_ = t;
    shown_ = true;
    constexpr int k_cells = 30;
    const double share = static_cast<double>(done) / static_cast<double>(total);
    const int full = static_cast<int>(share * k_cells);
    const double left_s = share > 0.0 ? (t - start_s_) * (1.0 - share) / share : 0.0;
    std::fprintf(stderr, "\r%s [%s%s] %3d %%  %.0f s left  %s\033[K", title_.c_str(), std::string(full, '#').c_str(),
                 std::string(k_cells - full, '.').c_str(), static_cast<int>(share * 100.0), left_s, note.c_str());
    std::fflush(stderr);
}

} // namespace sahel::tools
