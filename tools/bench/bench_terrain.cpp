#include "tools/bench/bench_cases.h"
#include "world/base_terrain.h"
#include "world/cuda_runtime.h"

#include <fmt/format.h>

#include <vector>

namespace sahel::tools {

namespace {

constexpr uint64_t k_seed = 1;
constexpr double k_bytes_per_cell = 16.0; ///< four layers, written once

/// The four materials of square number i: places that share no lattice cells, so that nothing is warm but the code.
CellRect square(int64_t i, int64_t n) {
    const int64_t x = (i % 8) * 37 * n, y = ((i % 8) * 11 + 3) * n;
    return {x, y, x + n, y + n};
}

std::string first_hash(const BaseTerrain& source, int level, int64_t n) {
    auto block = LayerBlock::allocate(level, {0, 0, n, n}, 0, k_surface_layers);
    return block.ok() && source.read(*block).ok() ? bench_hash(*block) : std::string();
}

/// One core.
void terrain(benchmark::State& state, const std::string& preset, int level, const BenchOptions& o) {
    const int64_t n = o.tile_cells;
    const BaseTerrain source(k_seed, base_terrain_preset(preset).value());
    const std::string hash = first_hash(source, level, n);
    if (hash.empty()) return state.SkipWithError("no memory");
    state.SetLabel(hash);
    std::vector<LayerBlock> blocks; // taken once: the system clears fresh memory, which is not what is measured
    for (int64_t i = 0; i < (n <= 512 ? 8 : 2); ++i) {
        auto block = LayerBlock::allocate(level, square(i, n), 0, k_surface_layers);
        if (!block.ok() || !source.read(*block).ok()) return state.SkipWithError("no memory");
        blocks.push_back(std::move(*block));
    }
    size_t i = 0;
    for (auto _ : state) benchmark::DoNotOptimize(source.read(blocks[i++ % blocks.size()]).ok());
    const auto cells = static_cast<double>(n * n);
    set_rates(state, cells, cells * k_bytes_per_cell, o.machine.one_core_gb_per_s);
}

/// The first CUDA device; the hash must be the one of the core.
void terrain_cuda(benchmark::State& state, const std::string& preset, int level, const BenchOptions& o) {
    const int64_t n = o.tile_cells;
    const BaseTerrain source(k_seed, base_terrain_preset(preset).value());
    MemoryPool pool("bench", MemoryKind::cuda, uint64_t{4} << 30);
    auto device = LayerBlock::allocate(level, {0, 0, n, n}, 0, k_surface_layers, pool);
    auto host = LayerBlock::allocate(level, {0, 0, n, n}, 0, k_surface_layers);
    if (!device.ok() || !host.ok() || !source.read(*device).ok()) return state.SkipWithError("no memory");
    // Both blocks are laid out alike; the first layer's first row starts them.
    const void* from = device->ints(Layer::bedrock).row(0);
    if (!cuda::copy_to_host(host->ints(Layer::bedrock).row(0), from, host->bytes()).ok())
        return state.SkipWithError("copying from the device failed");
    const std::string hash = bench_hash(*host);
    if (hash != first_hash(source, level, n)) return state.SkipWithError("CPU and CUDA give different bits");
    state.SetLabel(hash + " = CPU");
    int64_t i = 0;
    for (auto _ : state) {
        device = Result<LayerBlock>(LayerBlock());
        device = LayerBlock::allocate(level, square(i++, n), 0, k_surface_layers, pool);
        benchmark::DoNotOptimize(device.ok() && source.read(*device).ok() && cuda::synchronize().ok());
    }
    const auto cells = static_cast<double>(n * n);
    set_rates(state, cells, cells * k_bytes_per_cell, o.machine.cuda_gb_per_s);
}

} // namespace

void add_terrain_benchmarks(const BenchOptions& o) {
    for (const std::string_view preset : base_terrain_presets())
        for (int level = 0; level < 10; ++level) {
            const std::string name(preset);
            benchmark::RegisterBenchmark(fmt::format("terrain/{}/level_{}", name, level).c_str(),
                                         [=](benchmark::State& s) { terrain(s, name, level, o); })
                ->Unit(benchmark::kMillisecond)
                ->MinTime(0.08)
                ->Repetitions(4);
            if (!cuda::available()) continue;
            benchmark::RegisterBenchmark(fmt::format("terrain_cuda/{}/level_{}", name, level).c_str(),
                                         [=](benchmark::State& s) { terrain_cuda(s, name, level, o); })
                ->Unit(benchmark::kMillisecond)
                ->UseRealTime()
                ->MinTime(0.05)
                ->Repetitions(3);
        }
}

} // namespace sahel::tools
