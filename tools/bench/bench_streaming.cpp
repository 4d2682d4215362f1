#include "streaming/stream_bench.h"
#include "tools/bench/bench_cases.h"

#include <fmt/format.h>

namespace sahel::tools {

namespace {

/// The owner's thread over 2000 frames of flight, turns, climbs and jumps with 10 000 known nodes. What counts is p99.
void update(benchmark::State& state, float lod_factor) {
    StreamBenchOptions options;
    options.lod_factor = lod_factor;
    for (auto _ : state) {
        const StreamBenchResult r = run_stream_bench(options);
        state.SetIterationTime(r.p50_ms * 1e-3);
        state.counters["p99_ms"] = r.p99_ms;
        state.counters["max_ms"] = r.max_ms;
        state.counters["known"] = r.known_nodes;
        state.counters["wanted"] = r.wanted_nodes;
        state.SetLabel(fmt::format("{:012x}", r.hash >> 16));
    }
}

} // namespace

void add_streaming_benchmarks(const BenchOptions&) {
    for (const float lod_factor : {2.1f, 6.0f})
        benchmark::RegisterBenchmark(
            fmt::format("streaming/update/lod_factor_{:.1f}", static_cast<double>(lod_factor)).c_str(),
            [=](benchmark::State& s) { update(s, lod_factor); })
            ->Unit(benchmark::kMillisecond)
            ->UseManualTime()
            ->Iterations(1)
            ->Repetitions(3);
}

} // namespace sahel::tools
