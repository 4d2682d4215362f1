#include "tools/bench/bench_cases.h"

#include "render/gl_context.h"
#include "render/view_tile.h"
#include "tools/view_session.h"
#include "world/base_terrain.h"
#include "world/exr_tile.h"
#include "world/state_hash.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>

namespace sahel::tools {

namespace {

constexpr uint64_t k_seed = 1;
constexpr int k_tile = 512;

std::string hash_of(const LayerBlock& block) {
    // Rows without their padding, layer by layer.
    std::vector<int32_t> cells;
    const auto w = static_cast<int32_t>(block.owned().width());
    block.layers().intersected(k_persisted_layers).for_each([&](Layer l) {
        const auto view = block.ints(l);
        for (int32_t y = 0; y < static_cast<int32_t>(block.owned().height()); ++y)
            cells.insert(cells.end(), view.row(y), view.row(y) + w);
    });
    return to_hex(checksum({reinterpret_cast<const uint8_t*>(cells.data()), cells.size() * 4})).substr(0, 12);
}

void set_rates(benchmark::State& state, double cells, double least_bytes, double memory_gb_per_s) {
    state.counters["Mcells/s"] = benchmark::Counter(cells * 1e-6, benchmark::Counter::kIsIterationInvariantRate);
    state.counters["GB/s"] = benchmark::Counter(least_bytes * 1e-9, benchmark::Counter::kIsIterationInvariantRate);
    if (memory_gb_per_s > 0.0)
        state.counters["of_memory"] =
            benchmark::Counter(least_bytes * 1e-9 / memory_gb_per_s, benchmark::Counter::kIsIterationInvariantRate);
}

/// One core: the four materials of a 512 x 512 tile, somewhere new each time.
void terrain(benchmark::State& state, const std::string& preset, int level, double memory_gb_per_s) {
    const BaseTerrain source(k_seed, base_terrain_preset(preset).value());
    auto block = LayerBlock::allocate(level, {0, 0, k_tile, k_tile}, 0, k_surface_layers);
    if (!block.ok() || !source.read(*block).ok()) return state.SkipWithError("no memory");
    state.SetLabel(hash_of(*block));
    int64_t i = 0;
    for (auto _ : state) {
        const int64_t x = (i % 8) * 37 * k_tile, y = ((i % 8) * 11 + 3) * k_tile;
        ++i;
        block = LayerBlock::allocate(level, {x, y, x + k_tile, y + k_tile}, 0, k_surface_layers);
        benchmark::DoNotOptimize(source.read(*block).ok());
    }
    set_rates(state, double{k_tile} * k_tile, double{k_tile} * k_tile * 16.0, memory_gb_per_s);
}

StoredTile stored_tile(int n) {
    const BaseTerrain source(k_seed, base_terrain_preset("oasis").value());
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
    state.SetLabel(hash_of(tile.block));
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
    state.SetLabel(hash_of(decode_tile(bytes, "tile").value().block));
}

/// A view tile of level 0 with its whole chain of parents known.
void view_tile(benchmark::State& state) {
    const BaseTerrain source(k_seed, base_terrain_preset("oasis").value());
    const SunDirection sun{-2.4f, 0.2f};
    std::shared_ptr<const TileContext> context;
    for (int level = 8; level > 0; --level)
        context = build_view_tile(source, tile_of({-9000 >> level, -7000 >> level}, level, k_view_cells), sun, context)
                      .value()
                      ->context();
    for (auto _ : state) {
        auto tile = build_view_tile(source, tile_of({-9000, -7000}, 0, k_view_cells), sun, context);
        benchmark::DoNotOptimize(tile.ok());
    }
    set_rates(state, double{k_view_cells} * k_view_cells, static_cast<double>(view_tile_max_bytes()), 0.0);
}

/// One sample of the demo's first view, 1280 x 720, everything resident.
void frame(benchmark::State& state, bool water_view) {
    auto gl = GlContext::headless();
    if (!gl.ok()) return state.SkipWithError(gl.error().message.c_str());
    const BaseTerrain source(k_seed, base_terrain_preset("oasis").value());
    ViewSessionDesc desc;
    desc.stream.publishes_per_frame = 64;
    desc.stream.publish_ms_per_frame = 1000.0f;
    auto session = ViewSession::create(source, desc);
    if (!session.ok()) return state.SkipWithError(session.error().message.c_str());
    GroundSampler ground(source, 0);
    FrameDesc f;
    const double x = water_view ? -5700.0 : -9000.0, y = water_view ? -7150.0 : -7000.0;
    f.view.eye_m = {x, y, ground.surface_m(x, y) + 12.0};
    f.view.forward = {std::cos(0.9), std::sin(0.9), -0.06};
    f.haze_base_m = static_cast<float>(f.view.eye_m[2]);
    f.look = look_for("oasis", f.view.eye_m[2]);
    if (const Status s = (*session)->render_settled(f); !s.ok()) return state.SkipWithError(s.error().message.c_str());
    (*session)->renderer().time_passes(true);
    std::vector<uint8_t> pixels;
    for (auto _ : state) {
        (*session)->render_now(f, 0.0);
        (*session)->renderer().read_pixels(pixels);
    }
    const RenderStats& s = (*session)->renderer().stats();
    state.counters["terrain_ms"] = s.terrain_ms;
    state.counters["sky_ms"] = s.sky_ms;
    state.counters["water_ms"] = s.water_ms;
    state.counters["post_ms"] = s.post_ms;
    state.counters["nodes"] = s.nodes;
    state.SetLabel(to_hex(checksum(pixels)).substr(0, 12) + " " + (*gl)->info().renderer);
}

} // namespace

void register_benchmarks(double memory_gb_per_s) {
    for (const std::string_view preset : base_terrain_presets())
        for (int level = 0; level < 10; ++level)
            benchmark::RegisterBenchmark(
                fmt::format("terrain/{}/level_{}", preset, level).c_str(),
                [=, name = std::string(preset)](benchmark::State& s) { terrain(s, name, level, memory_gb_per_s); })
                ->Unit(benchmark::kMillisecond)
                ->MinTime(0.25);
    for (const auto& [compression, name] : k_compressions) {
        benchmark::RegisterBenchmark(fmt::format("exr/write/{}", name).c_str(), [c = compression](benchmark::State& s) {
            exr_write(s, c);
        })->Unit(benchmark::kMillisecond);
        benchmark::RegisterBenchmark(fmt::format("exr/read/{}", name).c_str(), [c = compression](benchmark::State& s) {
            exr_read(s, c);
        })->Unit(benchmark::kMillisecond);
    }
    benchmark::RegisterBenchmark("view_tile/level_0", view_tile)->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark("frame/dunes", [](benchmark::State& s) { frame(s, false); })
        ->Unit(benchmark::kMillisecond)
        ->Iterations(5);
    benchmark::RegisterBenchmark("frame/lake", [](benchmark::State& s) { frame(s, true); })
        ->Unit(benchmark::kMillisecond)
        ->Iterations(5);
}

} // namespace sahel::tools
