#include "sim/step_plan.h"
#include "sim/tile_domain.h"
#include "sim/wind_grid.h"
#include "tools/bench/bench_cases.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

namespace sahel::tools {

namespace {

const SimLayerSet k_layers{SimLayer::bedrock, SimLayer::soil,   SimLayer::sand,
                           SimLayer::water,   SimLayer::wind_x, SimLayer::wind_y};

/// Hills with dunes on them, periodic, in tiles of 512.
Result<TileDomain> region(int32_t side) {
    const int32_t tile = side < 512 ? side : 512;
    SAHEL_ASSIGN(
        TileDomain d,
        TileDomain::create(TileLayout::rectangle(tile, 16, side / tile, side / tile, Border::periodic), k_layers));
    const double a = 2.0 * 3.14159265358979 / side;
    std::vector<int32_t> wave; // one period of hills, in ticks
    for (int32_t i = 0; i < side; ++i) wave.push_back(static_cast<int32_t>(40.0 * 131072.0 * std::sin(a * i)));
    const auto at = [&](int64_t i) { return wave[static_cast<size_t>(floor_mod(i, side))]; };
    SAHEL_TRY(d.fill(SimLayer::bedrock, [&](int64_t x, int64_t y) { return at(x + 2 * y) + at(3 * x - y) / 2; }));
    SAHEL_TRY(d.fill(SimLayer::soil, [&](int64_t x, int64_t y) { return (at(7 * x + y) + at(0)) / 64 + 131072; }));
    SAHEL_TRY(
        d.fill(SimLayer::sand, [&](int64_t x, int64_t y) { return at(side / 4 + 32 * x + 5 * y) / 16 + 400000; }));
    SAHEL_TRY(d.fill(SimLayer::water, [](int64_t, int64_t) { return 0; }));
    return d;
}

void solve(benchmark::State& state, int32_t side, bool ground, bool rest, const BenchOptions& o) {
    auto d = region(side);
    if (!d.ok()) return state.SkipWithError(d.error().message.c_str());
    auto grid = WindGrid::create(*d, WindParams{}, 1.0);
    const WindNow now{6.0f, 25.0f};
    if (!grid.ok() || !grid->solve(*d, now).ok()) return state.SkipWithError("the wind could not be solved");
    for (auto _ : state) {
        bool ok = true;
        if (ground) ok = ok && grid->add_ground(*d).ok();
        if (rest) ok = ok && grid->solve_ground(now).ok();
        benchmark::DoNotOptimize(ok);
    }
    if (!run_passes(*d, std::vector<Pass>{grid->pass()}).ok()) return state.SkipWithError("the wind could not be read");
    state.SetLabel(d->hash({SimLayer::wind_x, SimLayer::wind_y}).value().substr(0, 12));
    const double cells = static_cast<double>(side) * side;
    set_rates(state, cells, ground ? cells * 16.0 : 0.0, o.machine.all_cores_gb_per_s);
    if (rest) state.counters["iterations"] = grid->projected().iterations;
}

void read(benchmark::State& state, int32_t side, const BenchOptions& o) {
    auto d = region(side);
    if (!d.ok()) return state.SkipWithError(d.error().message.c_str());
    auto grid = WindGrid::create(*d, WindParams{}, 1.0);
    if (!grid.ok() || !grid->solve(*d, {6.0f, 25.0f}).ok()) return state.SkipWithError("the wind could not be solved");
    const Pass pass = grid->pass();
    const Launch& launch = d->launch(0, "sim/wind");
    for (auto _ : state) benchmark::DoNotOptimize(pass.run({*d, launch, 0}).ok());
    state.SetLabel(d->hash({SimLayer::wind_x, SimLayer::wind_y}).value().substr(0, 12));
    const double cells = static_cast<double>(side) * side;
    set_rates(state, cells, cells * pass.decl.least_bytes, o.machine.all_cores_gb_per_s);
}

} // namespace

void add_wind_benchmarks(const BenchOptions& o) {
    const auto add = [](const std::string& name, auto&& f) {
        benchmark::RegisterBenchmark(name.c_str(), f)
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime()
            ->MinTime(0.1)
            ->Repetitions(4);
    };
    for (const int32_t side : {1024, 2048}) {
        add(fmt::format("wind/ground/{}", side), [=](benchmark::State& s) { solve(s, side, true, false, o); });
        add(fmt::format("wind/solve/{}", side), [=](benchmark::State& s) { solve(s, side, false, true, o); });
        add(fmt::format("wind/read/{}", side), [=](benchmark::State& s) { read(s, side, o); });
    }
}

} // namespace sahel::tools
