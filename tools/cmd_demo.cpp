#include "render/contact_sheet.h"
#include "streaming/simulation_params.h"
#include "tools/command.h"
#include "tools/demo_dunes.h"
#include "tools/flight.h"
#include "tools/tour.h"
#include "world/bandwidth.h"
#include "world/dem_import.h"
#include "world/file_io.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <memory>

namespace sahel::tools {

namespace {

namespace fs = std::filesystem;

struct Options {
    std::string out = "out/demo", preset = "oasis", dem;
    uint64_t seed = 10; // shore, lake, streams, cliffs and dunes within a few kilometres of the start
    double seconds = 10.0, budget_s = 230.0;
    int64_t steps = 120;
    int fps = 24, samples = 4, still_samples = 8, width = 1280, height = 720;
};

Result<World> make_world(const Options& o, const fs::path& folder) {
    // Only a folder that is a world (of an earlier run) is replaced.
    std::error_code error;
    if (fs::exists(folder / "world.json", error)) fs::remove_all(folder, error);
    SAHEL_ASSIGN(const BaseTerrainParams terrain, base_terrain_preset(o.preset));
    WorldDesc desc;
    desc.name = "demo";
    desc.seed = o.seed;
    desc.preset = o.preset;
    desc.terrain = terrain;
    desc.tile_cells = 512;
    SimulationParams simulation = default_simulation(desc);
    simulation.sand.avalanche_max_sweeps = 24; // a bound: sand that lies on steep rock slides for long
    desc.simulation = simulation_json(simulation);
    return World::create(folder, desc);
}

/// A second act over a real elevation model, where one is given.
Status second_act(const Options& o, const ViewSessionDesc& desc, nlohmann::ordered_json& report,
                  std::vector<std::pair<Image, std::string>>& stills) {
    const fs::path folder = fs::path(o.out) / "real";
    std::error_code error;
    if (fs::exists(folder / "world.json", error)) fs::remove_all(folder, error);
    DemImportOptions import;
    const std::vector<fs::path> files = {o.dem};
    SAHEL_ASSIGN(const DemImportReport done, import_dem(folder, files, import));
    SAHEL_ASSIGN(const World world, World::open(folder, OpenMode::read));
    GroundSampler ground(world.surface(), 1);
    SAHEL_ASSIGN(auto session, ViewSession::create(world.surface(), desc));
    SAHEL_ASSIGN(Image image, still(*session, world, default_start(world, ground), 3.0, o.still_samples));
    const fs::path path = fs::path(o.out) / "real.png";
    SAHEL_TRY(write_png(path, image, {{"Title", "real elevation"}}, k_png_level_small));
    report["real"] = {{"file", fs::path(o.dem).filename().string()},
                      {"cells", fmt::format("{} x {}", done.width, done.height)},
                      {"picture", path.string()}};
    stills.emplace_back(std::move(image), "real elevation");
    return {};
}

/// Wind over the tiles before the still of the dunes (or before the flight), with a time lapse of it. The still is
/// looked for anew after it.
Status dune_act(const Options& o, World& world, Tour& tour, nlohmann::ordered_json& report) {
    CameraPose pose = tour.flight.pose_at(tour.flight.start_s());
    for (const TourStill& s : tour.stills)
        if (s.name == "dunes") pose = s.pose;
    constexpr int k_side = 2; // tiles
    constexpr int k_every = 2;
    ProgressBar bar("wind and sand");
    SAHEL_ASSIGN(const DuneAct act,
                 blow_dunes(world, tiles_before(pose, world.desc(), k_side), o.steps, k_every,
                            fs::path(o.out) / "dunes.mp4", [&](int64_t done, int64_t all) { bar.update(done, all); }));
    if (!act.note.empty()) fmt::print("{}\n", act.note);
    fmt::print("Time lapse: {} ({} steps of wind and sand, {:.1f} Mcells/s, {:.0f} s)\n", act.video, act.steps,
               act.mcells_per_s, act.seconds);
    report["wind_and_sand"] = {
        {"tiles", fmt::format("{},{},{},{}", act.region.x0, act.region.y0, act.region.x1, act.region.y1)},
        {"steps", act.steps},
        {"ms_per_step", act.ms_per_step},
        {"mcells_per_s", act.mcells_per_s},
        {"seconds", act.seconds},
        {"video", act.video}};
    return look_again_at_dunes(world, act.region, tour);
}

Status run_demo(const Options& o) {
    const double begin = now_s();
    const fs::path out = o.out;
    SAHEL_TRY(make_folder(out));
    nlohmann::ordered_json report;
    const CpuInfo cpu = cpu_info();
    report["processor"] = fmt::format("{}, {} cores", cpu.name, cpu.cores);
    SAHEL_ASSIGN(auto gl, GlContext::headless());
    report["renderer"] = gl->info().renderer;

    SAHEL_ASSIGN(World world, make_world(o, out / "world"));
    fmt::print("A world: preset {}, seed {}\n", o.preset, o.seed);
    SAHEL_ASSIGN(Tour tour, plan_tour(world, o.seconds));
    SAHEL_TRY(tour.flight.save(world.folder() / "flight.json"));
    report["preset"] = o.preset;
    report["seed"] = o.seed;
    report["planning_s"] = now_s() - begin;
    if (o.steps > 0) SAHEL_TRY(dune_act(o, world, tour, report));

    ViewSessionDesc desc;
    desc.width = o.width;
    desc.height = o.height;
    desc.atmosphere = tour.atmosphere;
    desc.stream.publishes_per_frame = 64;
    desc.stream.publish_ms_per_frame = 1000.0f;
    std::vector<std::pair<Image, std::string>> stills;
    const double stills_begin = now_s();
    {
        SAHEL_ASSIGN(auto session, ViewSession::create(world.surface(), desc));
        report["stills"] = nlohmann::ordered_json::array();
        for (const TourStill& s : tour.stills) {
            session->set_atmosphere(s.atmosphere);
            SAHEL_ASSIGN(Image image, still(*session, world, s.pose, 3.0, o.still_samples));
            const fs::path path = out / (s.name + ".png");
            SAHEL_TRY(write_png(path, image, {{"Title", s.name}}, k_png_level_small));
            fmt::print("Still: {}\n", path.string());
            report["stills"].push_back({{"name", s.name},
                                        {"file", path.string()},
                                        {"score", s.score},
                                        {"eye_m", s.pose.eye_m},
                                        {"yaw_deg", s.pose.yaw_deg}});
            stills.emplace_back(std::move(image), s.name);
        }
    }
    report["stills_s"] = now_s() - stills_begin;
    {
        SAHEL_ASSIGN(auto session, ViewSession::create(world.surface(), desc));
        RecordOptions options;
        options.frames_per_s = o.fps;
        options.samples = o.samples;
        options.max_s = std::max(20.0, o.budget_s - (now_s() - stills_begin));
        ProgressBar bar("flight");
        SAHEL_ASSIGN(const RecordReport done, record(*session, world, tour.flight, out / "flythrough.mp4", options,
                                                     [&](int i, int n) { bar.update(i, n); }));
        report["video"] = {{"file", done.path},
                           {"frames", done.frames},
                           {"samples", done.samples},
                           {"seconds", done.seconds},
                           {"ms_per_frame", done.seconds * 1e3 / std::max(1, done.frames)},
                           {"worst_frame_ms", done.worst_frame_ms},
                           {"frames_with_parents_standing_in", done.fallback_frames},
                           {"tiles_loaded", session->streamer().stats().published_total}};
        if (!done.note.empty()) fmt::print("{}\n", done.note);
        fmt::print("Video: {} ({} frames, {} samples each, {:.0f} s)\n", done.path, done.frames, done.samples,
                   done.seconds);
    }
    if (!o.dem.empty()) SAHEL_TRY(second_act(o, desc, report, stills));
    std::vector<ContactSheetItem> items;
    for (const auto& [image, caption] : stills) items.push_back({&image, caption});
    ContactSheetOptions sheet;
    sheet.title = fmt::format("Sahel: {}, seed {}", o.preset, o.seed);
    SAHEL_ASSIGN(const Image contact, make_contact_sheet(items, sheet));
    SAHEL_TRY(write_png(out / "contact-sheet.png", contact, {}, k_png_level_small));
    report["total_s"] = now_s() - begin;
    SAHEL_TRY(write_file(out / "report.json", report.dump(2) + "\n"));
    fmt::print("Report: {}, contact sheet: {} ({:.0f} s in all)\n", (out / "report.json").string(),
               (out / "contact-sheet.png").string(), now_s() - begin);
    return {};
}

} // namespace

void add_demo_command(CommandLine& line) {
    auto o = std::make_shared<Options>();
    CLI::App& app = line.add("demo", "Make a world, fly over it, and leave a video, stills and a report", [=] {
        const Status done = run_demo(*o);
        return done.ok() ? 0 : fail(done.error());
    });
    app.add_option("--out", o->out, "Folder for the results")->capture_default_str();
    app.add_option("--preset", o->preset, "Landscape")->capture_default_str();
    app.add_option("--seed", o->seed, "Seed")->capture_default_str();
    app.add_option("--seconds", o->seconds, "Length of the flight")
        ->check(CLI::Range(1.0, 600.0))
        ->capture_default_str();
    app.add_option("--steps", o->steps, "Steps of wind and sand before the flight, 0: none")
        ->check(CLI::Range(0, 100000))
        ->capture_default_str();
    app.add_option("--fps", o->fps, "Frames per second")->check(CLI::Range(1, 120))->capture_default_str();
    app.add_option("--samples", o->samples, "Pictures averaged into a frame, at most")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    app.add_option("--still-samples", o->still_samples, "and into a still")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    app.add_option("--budget", o->budget_s,
                   "Seconds for the stills and the video: fewer samples where the video would take longer")
        ->capture_default_str();
    app.add_option("--width", o->width, "Pixels")->check(CLI::Range(64, 8192))->capture_default_str();
    app.add_option("--height", o->height, "Pixels")->check(CLI::Range(64, 8192))->capture_default_str();
    app.add_option("--dem", o->dem, "An elevation model for a second act");
}

} // namespace sahel::tools
