#include "render/gl_context.h"
#include "render/view_tile.h"
#include "tools/bench/bench_cases.h"
#include "tools/flight.h"
#include "tools/tour.h"
#include "tools/view_session.h"
#include "world/base_terrain.h"
#include "world/file_io.h"
#include "world/state_hash.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace sahel::tools {

namespace {

namespace fs = std::filesystem;

/// A folder that goes when the case ends.
class ScratchFolder {
  public:
    ScratchFolder() {
        std::string pattern = (fs::temp_directory_path() / "sahel-bench-XXXXXX").string();
        if (mkdtemp(pattern.data())) path_ = pattern;
    }
    ~ScratchFolder() {
        std::error_code error;
        if (!path_.empty()) fs::remove_all(path_, error);
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    [[nodiscard]] const fs::path& path() const { return path_; }

  private:
    fs::path path_;
};

Result<World> demo_world(const fs::path& folder) {
    WorldDesc desc;
    desc.name = "bench";
    desc.seed = 1;
    desc.preset = "oasis";
    desc.terrain = base_terrain_preset("oasis").value();
    desc.tile_cells = 512;
    return World::create(folder, desc);
}

/// What a worker does for one tile: level 0 with its chain of parents known.
void view_tile(benchmark::State& state) {
    const BaseTerrain source(1, base_terrain_preset("oasis").value());
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

enum class DemoView { flight, shore, high };

/// One sample of 1280 x 720 of a view of the demo (its planned flight, its stills), everything resident.
void frame(benchmark::State& state, DemoView which) {
    auto gl = GlContext::headless();
    if (!gl.ok()) return state.SkipWithError(gl.error().message.c_str());
    const ScratchFolder folder;
    auto world = demo_world(folder.path() / "world");
    if (!world.ok()) return state.SkipWithError(world.error().message.c_str());
    auto tour = plan_tour(*world, 12.0);
    if (!tour.ok()) return state.SkipWithError(tour.error().message.c_str());
    ViewSessionDesc desc;
    desc.atmosphere = tour->atmosphere;
    desc.stream.publishes_per_frame = 64;
    desc.stream.publish_ms_per_frame = 1000.0f;
    CameraPose pose = tour->flight.pose_at(tour->flight.start_s());
    for (const TourStill& still : tour->stills)
        if (still.name.starts_with(which == DemoView::shore ? "shore" : "high") && which != DemoView::flight) {
            pose = still.pose;
            desc.atmosphere = still.atmosphere;
            break;
        }
    auto session = ViewSession::create(world->surface(), desc);
    if (!session.ok()) return state.SkipWithError(session.error().message.c_str());
    const FrameDesc f = frame_of(*world, pose, {}, 3.0, desc.width, desc.height);
    if (const Status s = (*session)->render_settled(f); !s.ok()) return state.SkipWithError(s.error().message.c_str());
    Renderer& renderer = (*session)->renderer();
    renderer.time_passes(true);
    std::vector<uint8_t> pixels;
    std::array<double, 4> pass_ms{};
    double passes = 0.0;
    for (auto _ : state) {
        (*session)->render_now(f, 0.0);
        renderer.read_pixels(pixels);
        const RenderStats& s = renderer.stats();
        pass_ms[0] += s.terrain_ms;
        pass_ms[1] += s.sky_ms;
        pass_ms[2] += s.water_ms;
        pass_ms[3] += s.post_ms;
        passes += 1.0;
    }
    constexpr std::array<const char*, 4> k_names = {"terrain", "sky", "water", "post"};
    double sum = 0.0;
    size_t most = 0;
    for (size_t i = 0; i < 4; ++i) {
        pass_ms[i] /= passes;
        state.counters[std::string(k_names[i]) + "_ms"] = pass_ms[i];
        sum += pass_ms[i];
        if (pass_ms[i] > pass_ms[most]) most = i;
    }
    state.counters["nodes"] = renderer.stats().nodes;
    state.counters["ktri"] = renderer.stats().triangles * 1e-3;
    state.SetLabel(fmt::format("{} {}; {} takes {:.0f} %", to_hex(checksum(pixels)).substr(0, 12),
                               (*gl)->info().renderer, k_names[most], 100.0 * pass_ms[most] / sum));
}

/// Peak resident memory of `sahel fly` as a process of its own, over a world of a million cells each way in tiles of
/// 512: it settles on the centre and on the four corners, 1280 x 720, and stays on the last view for some frames.
void idle_memory(benchmark::State& state) {
    if (auto gl = GlContext::headless(); !gl.ok()) return state.SkipWithError(gl.error().message.c_str());
    const ScratchFolder folder;
    const fs::path world_path = folder.path() / "world";
    {
        auto world = demo_world(world_path);
        if (!world.ok()) return state.SkipWithError(world.error().message.c_str());
        GroundSampler ground(world->surface(), 1);
        nlohmann::ordered_json path = {{"format", 1}, {"name", "corners"}, {"ease", false}};
        int second = 0;
        for (const auto& [x, y] : {std::pair{0.0, 0.0},
                                   {-5e5, -5e5},
                                   {5e5, -5e5},
                                   {5e5, 5e5},
                                   {-5e5, 5e5},
                                   {0.0, 0.0},
                                   {0.0, 0.0},
                                   {0.0, 0.0}})
            path["keys"].push_back({{"time_s", second++},
                                    {"position_m", {x, y, ground.surface_m(x, y) + 30.0}},
                                    {"yaw_deg", 45.0},
                                    {"pitch_deg", -6.0}});
        if (const Status s = write_file(folder.path() / "path.json", path.dump()); !s.ok())
            return state.SkipWithError(s.error().message.c_str());
    }
    const std::array<std::string, 11> words = {"/proc/self/exe",
                                               "fly",
                                               world_path.string(),
                                               "--headless",
                                               "--fps",
                                               "1",
                                               "--path",
                                               (folder.path() / "path.json").string(),
                                               "--out",
                                               (folder.path() / "pictures").string(),
                                               "--json"};
    std::array<char*, 12> arguments{};
    for (size_t i = 0; i < words.size(); ++i) arguments[i] = const_cast<char*>(words[i].c_str());
    for (auto _ : state) {
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", 1, 0);
        pid_t child = 0;
        const int spawned = posix_spawn(&child, words[0].c_str(), &actions, nullptr, arguments.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        int status = 0;
        rusage usage{};
        if (spawned != 0 || wait4(child, &status, 0, &usage) != child || status != 0)
            return state.SkipWithError("sahel fly failed on the world of the test");
        state.counters["peak_MiB"] = static_cast<double>(usage.ru_maxrss) / 1024.0;
    }
    const ViewSessionDesc desc;
    state.counters["slots_MiB"] = static_cast<double>(Renderer::slot_bytes()) * desc.stream.slots / (1024.0 * 1024.0);
}

} // namespace

void add_view_benchmarks(const BenchOptions&) {
    benchmark::RegisterBenchmark("view/tile_level_0", view_tile)->Unit(benchmark::kMillisecond);
    for (const auto& [which, name] :
         {std::pair{DemoView::flight, "flight"}, {DemoView::shore, "shore"}, {DemoView::high, "high"}})
        benchmark::RegisterBenchmark(fmt::format("view/frame/{}", name).c_str(),
                                     [w = which](benchmark::State& s) { frame(s, w); })
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime()
            ->Iterations(6);
    benchmark::RegisterBenchmark("view/idle_memory", idle_memory)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime()
        ->Iterations(1);
}

} // namespace sahel::tools
