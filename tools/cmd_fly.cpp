#include "tools/command.h"
#include "tools/flight.h"
#include "world/params_cli.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <optional>

namespace sahel::tools {

namespace {

struct Options {
    std::string world, out, path, size = "1280x720", air = "golden_hour", debug = "off";
    bool headless = false, realtime = false, orbit = false, json = false;
    int frames = 0, fps = 24, samples = 1, threads = 0;
    double seconds = 12.0;
    std::vector<double> eye, look;
    ParamOverrides<StreamSettings> stream;
    ParamOverrides<Atmosphere> atmosphere;
};

Status parse_size(const std::string& text, int& width, int& height) {
    char end = 0;
    if (std::sscanf(text.c_str(), "%dx%d%c", &width, &height, &end) != 2 || width < 16 || height < 16 ||
        width > 16384 || height > 16384)
        return Error{ErrorKind::usage, fmt::format("--size {}: write WIDTHxHEIGHT, each from 16 to 16384", text)};
    return {};
}

Result<Atmosphere> atmosphere_named(const std::string& name) {
    std::string names;
    for (const AtmospherePreset& p : atmosphere_presets()) {
        if (p.name == name) return p.atmosphere;
        names += (names.empty() ? "" : ", ") + std::string(p.name);
    }
    return Error{ErrorKind::usage, fmt::format("--air {}: choose one of {}", name, names)};
}

Result<DebugView> debug_named(const std::string& name) {
    std::string names;
    for (int i = 0; i < static_cast<int>(DebugView::count_); ++i) {
        if (name == name_of(static_cast<DebugView>(i))) return static_cast<DebugView>(i);
        names += (names.empty() ? "" : ", ") + std::string(name_of(static_cast<DebugView>(i)));
    }
    return Error{ErrorKind::usage, fmt::format("--debug {}: choose one of {}", name, names)};
}

bool is_picture(const std::string& path) {
    return path.size() > 4 && path.substr(path.size() - 4) == ".png";
}

int fly_headless(const Options& o, const World& world, const ViewSessionDesc& desc, GroundSampler& ground,
                 const CameraPose& start, DebugView debug) {
    auto gl = GlContext::headless();
    if (!gl.ok()) return fail(gl.error());
    auto session = ViewSession::create(world.surface(), desc);
    if (!session.ok()) return fail(session.error());
    nlohmann::ordered_json report;
    report["renderer"] = (*gl)->info().renderer;
    if (is_picture(o.out)) {
        CameraPose pose = start;
        if (!o.path.empty()) {
            auto path = CameraPath::load(o.path);
            if (!path.ok()) return fail(path.error());
            pose = path->pose_at(path->start_s());
        }
        const double begin = now_s();
        auto image = still(**session, world, pose, 3.0, o.samples, debug);
        if (!image.ok()) return fail(image.error());
        if (const Status s = write_png(o.out, *image, {{"Title", world.desc().name}}, k_png_level_small); !s.ok())
            return fail(s.error());
        report["picture"] = o.out;
        report["seconds"] = now_s() - begin;
        print_report(report, o.json);
        return 0;
    }
    auto path = !o.path.empty() ? CameraPath::load(o.path) : Result<CameraPath>(Error{});
    if (o.path.empty() && o.orbit) {
        OrbitOptions orbit;
        orbit.centre_m = {start.eye_m[0], start.eye_m[1]};
        orbit.duration_s = o.seconds;
        path = orbit_path(orbit, camera_ground(ground));
    } else if (o.path.empty()) {
        path = default_path(world, ground, o.seconds);
    }
    if (!path.ok()) return fail(path.error());
    RecordOptions record_options;
    record_options.frames = o.frames;
    record_options.frames_per_s = o.fps;
    record_options.samples = o.samples;
    record_options.realtime = o.realtime;
    ProgressBar bar("fly");
    auto done = record(**session, world, *path, o.out, record_options, [&](int i, int n) { bar.update(i, n); });
    if (!done.ok()) return fail(done.error());
    report["video"] = done->path;
    if (!done->note.empty()) report["note"] = done->note;
    report["frames"] = done->frames;
    report["samples"] = done->samples;
    report["seconds"] = done->seconds;
    report["ms_per_frame"] = done->seconds * 1e3 / std::max(1, done->frames);
    report["worst_frame_ms"] = done->worst_frame_ms;
    if (o.realtime) report["frames_with_parents_standing_in"] = done->fallback_frames;
    print_report(report, o.json);
    return 0;
}

int run(const Options& o) {
    ViewSessionDesc desc;
    if (const Status s = parse_size(o.size, desc.width, desc.height); !s.ok()) return fail(s.error());
    auto atmosphere = atmosphere_named(o.air);
    if (!atmosphere.ok()) return fail(atmosphere.error());
    auto debug = debug_named(o.debug);
    if (!debug.ok()) return fail(debug.error());
    if (o.headless && o.out.empty())
        return fail(Error{ErrorKind::usage, "fly --headless needs --out FILE.mp4, FILE.png or a folder"});
    desc.atmosphere = *atmosphere;
    o.atmosphere.apply(desc.atmosphere);
    if (o.headless) {
        desc.stream.publishes_per_frame = 64;
        desc.stream.publish_ms_per_frame = 1000.0f;
    }
    o.stream.apply(desc.stream);
    desc.workers = o.threads;
    auto world = World::open(o.world, OpenMode::read);
    if (!world.ok()) return fail(world.error());
    GroundSampler ground(world->surface(), 1);
    CameraPose start = default_start(*world, ground);
    const std::filesystem::path saved = world->folder() / "flight.json";
    if (o.path.empty() && o.eye.empty() && std::filesystem::exists(saved))
        if (auto path = CameraPath::load(saved); path.ok()) start = path->pose_at(path->start_s());
    if (o.eye.size() >= 2)
        start.eye_m = {o.eye[0], o.eye[1], ground.surface_m(o.eye[0], o.eye[1]) + (o.eye.size() > 2 ? o.eye[2] : 10.0)};
    if (o.look.size() == 2) {
        start.yaw_deg = o.look[0];
        start.pitch_deg = o.look[1];
    }
    if (!o.headless) return fly_in_window(*world, desc, start, o.frames);
    return fly_headless(o, *world, desc, ground, start, *debug);
}

} // namespace

void add_fly_command(CommandLine& line) {
    auto o = std::make_shared<Options>();
    CLI::App& app =
        line.add("fly", "Fly over a world in a window, or record a flight without a display", [=] { return run(*o); });
    app.add_option("WORLD", o->world, "World folder")->required();
    app.add_flag("--headless", o->headless, "No window: record to --out");
    app.add_option("--out", o->out, "FILE.mp4, FILE.png for one picture, or a folder for pictures");
    app.add_option("--frames", o->frames,
                   "Frames to record, or after which the window closes; 0: as long as the path, or the user, says")
        ->check(CLI::Range(0, 1000000))
        ->capture_default_str();
    app.add_option("--seconds", o->seconds, "Length of a built-in path")
        ->check(CLI::Range(0.1, 3600.0))
        ->capture_default_str();
    app.add_option("--fps", o->fps, "Frames per second of the video")->check(CLI::Range(1, 240))->capture_default_str();
    app.add_option("--size", o->size, "Pixels, WIDTHxHEIGHT")->capture_default_str();
    app.add_option("--samples", o->samples, "Jittered pictures that are averaged into a frame")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    app.add_option("--path", o->path, "Camera path, JSON");
    app.add_flag("--orbit", o->orbit, "Circle round the start instead of flying over it");
    app.add_option("--eye", o->eye, "Start: X Y [height above ground], m")->expected(2, 3);
    app.add_option("--look", o->look, "Start: YAW PITCH, degrees (0 east, 90 south)")->expected(2);
    app.add_option("--air", o->air, "golden_hour, morning, noon, dusk, sand_haze, after_rain")->capture_default_str();
    app.add_option("--debug", o->debug, "Draw a layer or a value instead: normals, slope, sand, water, level, ...")
        ->capture_default_str();
    app.add_flag("--realtime", o->realtime, "No frame waits for its tiles: shows streaming as it is");
    app.add_option("--threads", o->threads, "Threads that load; 0: as many as the machine has")
        ->check(CLI::Range(0, 256))
        ->capture_default_str();
    app.add_flag("--json", o->json, "Report as JSON");
    add_params_options(app, "stream", o->stream);
    add_params_options(app, "air", o->atmosphere);
}

} // namespace sahel::tools
