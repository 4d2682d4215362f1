#include "tools/bench/bench_cases.h"
#include "tools/command.h"
#include "world/bandwidth.h"
#include "world/cpu_features.h"
#include "world/cuda_runtime.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

namespace sahel::tools {

namespace {

struct Options {
    std::string filter;
    std::string json;
    int tile_cells = 512;
};

/// One line a case: the fastest of its repetitions.
class BestReporter final : public benchmark::BenchmarkReporter {
  public:
    bool ReportContext(const Context&) override { return true; }
    void ReportRuns(const std::vector<Run>& runs) override {
        const Run* best = nullptr;
        for (const Run& run : runs) {
            if (run.run_type == Run::RT_Aggregate) continue;
            if (!best || run.error_occurred || run.GetAdjustedRealTime() < best->GetAdjustedRealTime()) best = &run;
            if (run.error_occurred) break;
        }
        if (!best) return;
        const std::string& name = best->run_name.function_name;
        const std::string group = name.substr(0, name.find('/'));
        if (group != group_) fmt::print("\n{:<32} {:>10}\n", group, "ms");
        group_ = group;
        if (best->error_occurred) {
            any_error_ = true;
            fmt::print("{:<32} {}\n", name, best->error_message);
            return;
        }
        const bool is_cpu = best->GetAdjustedCPUTime() > 0.0 && group == "terrain";
        fmt::print("{:<32} {:>10.3f}", name, is_cpu ? best->GetAdjustedCPUTime() : best->GetAdjustedRealTime());
        for (const auto& [key, counter] : best->counters)
            fmt::print("  {:>7.{}f} {}", counter.value, counter.value < 10.0 ? 2 : 1, key);
        fmt::print("  {}\n", best->report_label);
        std::fflush(stdout);
    }
    [[nodiscard]] bool any_error() const { return any_error_; }

  private:
    std::string group_;
    bool any_error_ = false;
};

BenchMachine measure_machine() {
    BenchMachine m;
    if (const auto one = measure_memory_bandwidth(1); one.ok()) m.one_core_gb_per_s = one->gb_per_s;
    if (const auto all = measure_memory_bandwidth(); all.ok()) m.all_cores_gb_per_s = all->gb_per_s;
    if (cuda::available())
        if (const auto device = measure_cuda_bandwidth(); device.ok()) m.cuda_gb_per_s = device->gb_per_s;
    return m;
}

/// Says what the numbers were taken on, here and in the JSON file.
void name_machine(const BenchMachine& m) {
    const CpuInfo cpu = cpu_info();
    const auto rate = [](double gb) { return gb > 0.0 ? fmt::format("{:.1f}", gb) : std::string("not measured"); };
    const std::vector<std::pair<std::string, std::string>> facts = {
        {"processor", fmt::format("{}, {} cores", cpu.name, cpu.cores)},
        {"memory", human_bytes(cpu.memory_bytes)},
        {"kernels", isa() == Isa::v3 ? "x86-64-v3" : "baseline"},
        {"compiler", __VERSION__},
        {"triad_one_core_gb_per_s", rate(m.one_core_gb_per_s)},
        {"triad_all_cores_gb_per_s", rate(m.all_cores_gb_per_s)},
        {"cuda", cuda::available() ? cuda::status().name : "none: " + cuda::status().why_not},
        {"triad_cuda_gb_per_s", rate(m.cuda_gb_per_s)}};
    for (const auto& [key, value] : facts) {
        fmt::print("{:<26} {}\n", key, value);
        benchmark::AddCustomContext(key, value);
    }
}

/// The library appends how it measures to the names ("/min_time:0.08/repeats:4"): an end of line stands before that.
std::string filter_of(const std::string& regex) {
    std::string filter;
    for (size_t i = 0; i < regex.size(); ++i) {
        if (regex[i] == '$' && (i == 0 || regex[i - 1] != '\\')) filter += "(/[a-z_]+:.*|/real_time.*|/manual_time.*)?";
        filter += regex[i];
    }
    return filter;
}

int run(const Options& o) {
    namespace fs = std::filesystem;
    const std::string part = o.json + ".part"; // written aside: a run that is cut off leaves an older file as it was
    if (!o.json.empty()) {
        std::FILE* probe = std::fopen(part.c_str(), "w");
        if (!probe) return fail(Error{ErrorKind::io, fmt::format("bench --json {}: cannot be written", o.json)});
        std::fclose(probe);
    }
    BenchOptions options;
    options.machine = measure_machine();
    options.tile_cells = o.tile_cells;
    name_machine(options.machine);
    add_terrain_benchmarks(options);
    add_avalanche_benchmarks(options);
    add_sand_benchmarks(options);
    add_store_benchmarks(options);
    add_streaming_benchmarks(options);
    add_view_benchmarks(options);
    add_wind_benchmarks(options);
    std::vector<std::string> arguments = {"sahel"};
    if (!o.filter.empty()) arguments.push_back("--benchmark_filter=" + filter_of(o.filter));
    if (!o.json.empty()) {
        arguments.push_back("--benchmark_out=" + part);
        arguments.emplace_back("--benchmark_out_format=json");
    }
    std::vector<char*> raw;
    for (std::string& a : arguments) raw.push_back(a.data());
    int count = static_cast<int>(raw.size());
    benchmark::Initialize(&count, raw.data());
    BestReporter reporter;
    const size_t ran = benchmark::RunSpecifiedBenchmarks(&reporter);
    benchmark::Shutdown();
    std::error_code error;
    if (ran == 0) {
        fs::remove(part, error);
        return fail(Error{ErrorKind::usage, fmt::format("no benchmark matches '{}'", o.filter)});
    }
    if (!o.json.empty()) fs::rename(part, o.json, error);
    if (error) return fail(Error{ErrorKind::io, fmt::format("bench --json {}: {}", o.json, error.message())});
    return reporter.any_error() ? 1 : 0;
}

} // namespace

void add_bench_command(CommandLine& line) {
    auto o = std::make_shared<Options>();
    CLI::App& app =
        line.add("bench", "How fast this machine does it: time, Mcells/s, GB/s, and the hash of each result",
                 [=] { return run(*o); });
    app.add_option("--filter", o->filter, "Only the benchmarks whose names match this regular expression");
    app.add_option("--json", o->json, "Write every repetition to this file");
    app.add_option("--size", o->tile_cells, "Cells along the side of the square that terrain cases make")
        ->check(CLI::Range(64, 8192))
        ->capture_default_str();
}

} // namespace sahel::tools
