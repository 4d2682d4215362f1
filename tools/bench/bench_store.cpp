#include "tools/bench/bench_cases.h"
#include "world/base_terrain.h"
#include "world/exr_tile.h"

#include <fmt/format.h>

#include <array>

namespace sahel::tools {

namespace {

StoredTile stored_tile(int n) {
    const BaseTerrain source(1, base_terrain_preset("oasis").value());
    const TileKey key = tile_of({-9000, -7000}, 0, n);
    auto block = LayerBlock::allocate(0, tile_rect(key, n), 0, k_surface_layers);
    SAHEL_CHECK(block.ok() && source.read(*block).ok());
    return make_stored_tile(key, n, *block).value();
}

constexpr std::array<std::pair<TileCompression, const char*>, 4> k_compressions = {{{TileCompression::none, "none"},
                                                                                    {TileCompression::zips, "zips"},
                                                                                    {TileCompression::zip, "zip"},
                                                                                    {TileCompression::piz, "piz"}}};

void exr_write(benchmark::State& state, TileCompression compression) {
    const StoredTile tile = stored_tile(2048);
    size_t size = 0;
    for (auto _ : state) size = encode_tile(tile, compression).value().size();
    state.counters["MB"] = static_cast<double>(size) * 1e-6;
    state.counters["MB/s"] = benchmark::Counter(static_cast<double>(tile.block.bytes()) * 1e-6,
                                                benchmark::Counter::kIsIterationInvariantRate);
    state.SetLabel(bench_hash(tile.block));
}

void exr_read(benchmark::State& state, TileCompression compression) {
    const StoredTile tile = stored_tile(2048);
    const auto bytes = encode_tile(tile, compression).value();
    for (auto _ : state) {
        auto decoded = decode_tile(bytes, "tile");
        benchmark::DoNotOptimize(decoded.ok());
    }
    state.counters["MB"] = static_cast<double>(bytes.size()) * 1e-6;
    state.counters["MB/s"] = benchmark::Counter(static_cast<double>(tile.block.bytes()) * 1e-6,
                                                benchmark::Counter::kIsIterationInvariantRate);
    state.SetLabel(bench_hash(decode_tile(bytes, "tile").value().block));
}

} // namespace

void add_store_benchmarks(const BenchOptions&) {
    for (const auto& [compression, name] : k_compressions) {
        benchmark::RegisterBenchmark(fmt::format("exr/write/{}", name).c_str(), [c = compression](benchmark::State& s) {
            exr_write(s, c);
        })->Unit(benchmark::kMillisecond);
        benchmark::RegisterBenchmark(fmt::format("exr/read/{}", name).c_str(), [c = compression](benchmark::State& s) {
            exr_read(s, c);
        })->Unit(benchmark::kMillisecond);
    }
}

} // namespace sahel::tools
