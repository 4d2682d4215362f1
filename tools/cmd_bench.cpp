#include "render/view_tile.h"
#include "tools/bench/bench_cases.h"
#include "tools/command.h"
#include "world/bandwidth.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <memory>

namespace sahel::tools {

namespace {

struct Options {
    std::string filter;
    std::string json;
};

int run(const Options& o) {
    const CpuInfo cpu = cpu_info();
    const auto bandwidth = measure_memory_bandwidth();
    fmt::print("{}, {} cores; memory {} GB/s (triad, all cores)\n", cpu.name, cpu.cores,
               bandwidth.ok() ? fmt::format("{:.1f}", bandwidth->gb_per_s) : "not measured");
    register_benchmarks(bandwidth.ok() ? bandwidth->gb_per_s : 0.0);
    std::vector<std::string> arguments = {"sahel", "--benchmark_counters_tabular=true"};
    if (!o.filter.empty()) arguments.push_back("--benchmark_filter=" + o.filter);
    if (!o.json.empty()) {
        arguments.push_back("--benchmark_out=" + o.json);
        arguments.emplace_back("--benchmark_out_format=json");
        benchmark::AddCustomContext("processor", cpu.name);
        if (bandwidth.ok()) benchmark::AddCustomContext("memory_gb_per_s", fmt::format("{:.1f}", bandwidth->gb_per_s));
    }
    std::vector<char*> raw;
    for (std::string& a : arguments) raw.push_back(a.data());
    int count = static_cast<int>(raw.size());
    benchmark::Initialize(&count, raw.data());
    const size_t ran = benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    if (ran == 0) return fail(Error{ErrorKind::usage, fmt::format("no benchmark matches '{}'", o.filter)});
    return 0;
}

} // namespace

void add_bench_command(CommandLine& line) {
    auto o = std::make_shared<Options>();
    CLI::App& app =
        line.add("bench", "How fast this machine does it: time, Mcells/s, GB/s, and the hash of each result",
                 [=] { return run(*o); });
    app.add_option("--filter", o->filter, "Only the benchmarks whose names match this regular expression");
    app.add_option("--json", o->json, "Write the results to this file");
}

} // namespace sahel::tools
