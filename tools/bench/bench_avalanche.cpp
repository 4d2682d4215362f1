#include "sim/avalanche.h"
#include "sim/avalanche_column.h"
#include "tools/bench/bench_cases.h"
#include "world/cuda_runtime.h"
#include "world/executor.h"
#include "world/field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace sahel::tools {

namespace {

constexpr double k_sweep_bytes = 20.0; ///< bedrock, soil, sand and repose read, sand written
constexpr int k_sweeps = 50;

SimLayerSet layers() {
    SimLayerSet set{SimLayer::bedrock, SimLayer::soil, SimLayer::sand, SimLayer::repose};
    set.insert(avalanche_layers());
    return set;
}

Result<TileDomain> make(int32_t n, MemoryPool& pool) {
    return TileDomain::create(TileLayout::rectangle(n, 16, 1, 1, Border::periodic), layers(), pool);
}

// Barchans on a thin sheet, one every 512 cells: windward slopes at rest, slip faces a little too steep.
Status fill_barchans(TileDomain& d) {
    SAHEL_TRY(fill_column(d, {0, 0.0f, 0.5f}));
    return d.fill(SimLayer::sand, [](int64_t x, int64_t y) {
        const double dx = static_cast<double>(floor_mod(x, 512) - 256);
        const double dy = static_cast<double>(floor_mod(y, 512) - 256);
        const double dune = std::max(0.0, 30.0 - 0.3 * std::hypot(dx, dy));
        const double slip = dx > 20.0 ? std::max(0.0, dune - 0.75 * (dx - 20.0)) : dune;
        return ticks_of_metres(static_cast<float>(0.5 + slip));
    });
}

std::string short_hash(const TileDomain& d) {
    return d.hash({SimLayer::sand}).value().substr(0, 12);
}

// 50 sweeps of the published schedule, from the same ground each time. `adaptive`: blocks are left out.
void fixed(benchmark::State& state, int32_t n, bool adaptive, int threads, MemoryKind kind, double memory_gb_per_s) {
    MemoryPool pool("bench", kind, uint64_t{8} << 30);
    auto domain = make(n, pool);
    if (!domain.ok()) return state.SkipWithError(domain.error().message.c_str());
    SandParams params;
    params.avalanche_sweeps = k_sweeps;
    AvalancheStats stats;
    set_thread_count(threads);
    for (auto _ : state) {
        state.PauseTiming();
        if (!fill_barchans(*domain).ok()) return state.SkipWithError("filling failed");
        state.ResumeTiming();
        const Status ran = avalanche(*domain, params, 1.0, AvalancheKind::sand, {adaptive}, &stats);
        if (!ran.ok()) return state.SkipWithError(ran.error().message.c_str());
    }
    set_thread_count(0);
    state.SetLabel(short_hash(*domain));
    const double cells = static_cast<double>(n) * n * k_sweeps;
    set_rates(state, cells, cells * k_sweep_bytes, memory_gb_per_s);
    state.counters["ms/sweep"] = benchmark::Counter(k_sweeps * 1e-3, benchmark::Counter::kIsIterationInvariantRate |
                                                                         benchmark::Counter::kInvert);
    state.counters["swept"] = stats.swept();
}

// Until quiet: the barchans, or a column that falls (method 5.3).
void until_quiet(benchmark::State& state, int32_t n, std::optional<SandColumn> column, MemoryKind kind) {
    MemoryPool pool("bench", kind, uint64_t{8} << 30);
    auto domain = make(n, pool);
    if (!domain.ok()) return state.SkipWithError(domain.error().message.c_str());
    SandParams params;
    params.avalanche_max_sweeps = 100000;
    AvalancheStats stats;
    for (auto _ : state) {
        state.PauseTiming();
        if (!(column ? fill_column(*domain, *column) : fill_barchans(*domain)).ok())
            return state.SkipWithError("filling failed");
        state.ResumeTiming();
        const Status ran = avalanche(*domain, params, 1.0, AvalancheKind::sand, {}, &stats);
        if (!ran.ok() || !stats.quiet) return state.SkipWithError("not quiet");
    }
    state.SetLabel(short_hash(*domain));
    state.counters["sweeps"] = stats.sweeps;
    state.counters["swept"] = stats.swept();
}

template <class F> void add(const std::string& name, const F& run) {
    benchmark::RegisterBenchmark(name.c_str(), run)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime()
        ->MinTime(0.2)
        ->Repetitions(3);
}

} // namespace

void add_avalanche_benchmarks(const BenchOptions& o) {
    const BenchMachine m = o.machine;
    for (const int32_t n : {512, 1024, 2048}) {
        add(fmt::format("avalanche/forced_one_core/{}", n),
            [=](benchmark::State& s) { fixed(s, n, false, 1, MemoryKind::host, m.one_core_gb_per_s); });
        add(fmt::format("avalanche/forced/{}", n),
            [=](benchmark::State& s) { fixed(s, n, false, 0, MemoryKind::host, m.all_cores_gb_per_s); });
        add(fmt::format("avalanche/adaptive/{}", n),
            [=](benchmark::State& s) { fixed(s, n, true, 0, MemoryKind::host, m.all_cores_gb_per_s); });
        add(fmt::format("avalanche/barchans_until_quiet/{}", n),
            [=](benchmark::State& s) { until_quiet(s, n, std::nullopt, MemoryKind::host); });
        if (!cuda::available()) continue;
        add(fmt::format("avalanche_cuda/forced/{}", n),
            [=](benchmark::State& s) { fixed(s, n, false, 0, MemoryKind::cuda, m.cuda_gb_per_s); });
        add(fmt::format("avalanche_cuda/adaptive/{}", n),
            [=](benchmark::State& s) { fixed(s, n, true, 0, MemoryKind::cuda, m.cuda_gb_per_s); });
        add(fmt::format("avalanche_cuda/barchans_until_quiet/{}", n),
            [=](benchmark::State& s) { until_quiet(s, n, std::nullopt, MemoryKind::cuda); });
    }
    add("avalanche/column_33_until_quiet", [](benchmark::State& s) {
        until_quiet(s, 145, SandColumn{33, 132.0f}, MemoryKind::host);
    });
    add("avalanche/column_100_until_quiet",
        [](benchmark::State& s) { until_quiet(s, 424, SandColumn{}, MemoryKind::host); });
}

} // namespace sahel::tools
