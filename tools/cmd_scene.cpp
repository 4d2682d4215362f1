#include "render/contact_sheet.h"
#include "render/scene_pictures.h"
#include "render/video_writer.h"
#include "streaming/scene_run.h"
#include "tools/command.h"
#include "world/executor.h"
#include "world/file_io.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

namespace sahel::tools {

namespace {

constexpr int k_default_steps = 500;
constexpr int k_video_side_px = 1024;

struct Options {
    std::string file;
    int size = 0;
    int steps = -1;
    std::string out;
    std::string video;
    int every = 5;
    int fps = 24;
    int wind_every = 1;
    int threads = 0;
    uint64_t seed = 1;
    bool until_quiet = false;
    bool keep_sticky = false;
    bool profile = false;
    bool json = false;
};

/// Frames of the ground at an even size of at most k_video_side_px.
class TimeLapse {
  public:
    static Result<TimeLapse> open(const Options& o, const Scene& scene, const SceneRun& run) {
        TimeLapse t;
        const double scale = static_cast<double>(k_video_side_px) / std::max(run.width(), run.height());
        t.width_ = static_cast<int>(std::lround(run.width() * scale)) / 2 * 2;
        t.height_ = static_cast<int>(std::lround(run.height() * scale)) / 2 * 2;
        VideoSettings settings;
        settings.width_px = t.width_;
        settings.height_px = t.height_;
        settings.frames_per_s = o.fps;
        settings.title = scene.name;
        SAHEL_ASSIGN(VideoWriter writer, VideoWriter::open(o.video, settings));
        t.writer_.emplace(std::move(writer));
        return t;
    }
    Status add(const Scene& scene, const SceneRun& run) {
        SAHEL_ASSIGN(const Image picture, make_scene_picture(scene, run, k_video_side_px));
        return writer_->add_frame(shrink_image(picture, width_, height_));
    }
    Status finish() { return writer_->finish(); }
    [[nodiscard]] const VideoWriter& writer() const { return *writer_; }

  private:
    int width_ = 0;
    int height_ = 0;
    std::optional<VideoWriter> writer_;
};

nlohmann::ordered_json describe(const Scene& scene, const SceneRun& run) {
    nlohmann::ordered_json j;
    j["scene"] = scene.name;
    j["format"] = scene_format_name(scene.format);
    j["grid"] = fmt::format("{} x {} cells of {} m", run.width(), run.height(), scene.cell_m);
    j["tiles"] =
        fmt::format("{} of {} cells, halo {}", run.domain().slots(), run.domain().tile_cells(), run.domain().halo());
    j["step_s"] = scene.step_s;
    return j;
}

void add_report(nlohmann::ordered_json& j, const SceneReport& r, double seconds) {
    const auto rounded = [](double v) { return std::round(v * 1e4) / 1e4; };
    j["steps"] = r.steps;
    j["ms_per_step"] = r.steps > 0 ? rounded(seconds * 1000.0 / static_cast<double>(r.steps)) : 0.0;
    j["sweeps_per_step"] = r.sweeps_per_step;
    j["swept_share"] = rounded(r.swept_share);
    j["max_wind_m_per_s"] = rounded(r.max_wind_m_per_s);
    j["coverage_above_0.1_m"] = rounded(r.coverage);
    j["sand_mean_m"] = rounded(r.sand_mean_m);
    j["sand_std_m"] = rounded(r.sand_std_m);
    j["sand_max_m"] = rounded(r.sand_max_m);
    j["airborne_mean_m"] = rounded(r.airborne_mean_m);
    j["excess_slope_max"] = rounded(r.excess_max);
    j["excess_slope_p99"] = rounded(r.excess_p99);
    j["solids_ticks"] = r.solids_ticks;
    j["supplied_ticks"] = r.supplied_ticks;
    j["drift_ticks"] = r.drift_ticks;
}

int run_scene(const Options& o) {
    if (!o.video.empty() && o.every < 1) return fail(Error{ErrorKind::usage, "--every must be at least 1"});
    set_thread_count(o.threads);
    auto loaded = load_scene(o.file);
    if (!loaded.ok()) return fail(loaded.error());
    const Scene& scene = *loaded;
    SceneRunOptions options;
    options.ground.size = o.size;
    options.ground.keep_sticky = o.keep_sticky;
    options.until_quiet = o.until_quiet;
    options.wind_every = o.wind_every;
    options.seed = o.seed;
    auto made = SceneRun::create(scene, options);
    if (!made.ok()) return fail(made.error());
    SceneRun& run = *made;
    const int published = scene.values.stop_iterations;
    const int steps = o.steps >= 0 ? o.steps : (published > 0 ? published : k_default_steps);

    std::optional<TimeLapse> video;
    if (!o.video.empty()) {
        auto opened = TimeLapse::open(o, scene, run);
        if (!opened.ok()) return fail(opened.error());
        video.emplace(*std::move(opened));
    }
    record_launches(o.profile);
    double busy_s = 0.0;
    {
        ProgressBar bar(scene.name);
        for (int i = 0; i < steps; ++i) {
            const double start = now_s();
            if (const Status status = run.step(); !status.ok()) return fail(status.error());
            busy_s += now_s() - start;
            if (video && (i + 1) % o.every == 0)
                if (const Status status = video->add(scene, run); !status.ok()) return fail(status.error());
            bar.update(i + 1, steps, fmt::format("{:.1f} ms a step", 1000.0 * busy_s / (i + 1)));
        }
    }
    auto report = run.report();
    if (!report.ok()) return fail(report.error());

    nlohmann::ordered_json j = describe(scene, run);
    add_report(j, *report, busy_s);
    std::vector<std::string> notes = scene.notes;
    notes.insert(notes.end(), run.ground().notes.begin(), run.ground().notes.end());
    if (video) {
        if (video->writer().frame_count() == 0)
            return fail(Error{ErrorKind::usage, fmt::format("--every {}: no frame in {} steps", o.every, steps)});
        if (const Status status = video->finish(); !status.ok()) return fail(status.error());
        j["video"] = video->writer().path().string();
        if (!video->writer().note().empty()) notes.push_back(video->writer().note());
    }
    if (o.json || !o.out.empty()) {
        j["notes"] = notes;
        j["ignored_keys"] = scene.ignored;
    }
    if (!o.out.empty()) {
        const std::string title = fmt::format("{}, step {}, {} x {} cells of {} m", scene.name, run.steps(),
                                              run.width(), run.height(), scene.cell_m);
        if (const Status status = write_scene_pictures(o.out, scene, run, title); !status.ok())
            return fail(status.error());
        if (const Status status = write_file(std::filesystem::path(o.out) / "report.json", j.dump(2) + "\n");
            !status.ok())
            return fail(status.error());
    }
    if (o.json) {
        print_report(j, true);
    } else {
        j.erase("notes");
        j.erase("ignored_keys");
        print_report(j, false);
        for (const std::string& note : notes) fmt::print("note: {}\n", note);
    }
    if (o.profile) std::fputs(launch_table(launch_records()).c_str(), o.json ? stderr : stdout);
    if (report->drift_ticks != 0) // never: amounts are whole ticks and each transfer is rounded once
        return fail(Error{ErrorKind::corrupt, fmt::format("{}: the books do not balance: {} ticks of solids appeared",
                                                          scene.name, report->drift_ticks)});
    return 0;
}

} // namespace

void add_scene_command(CommandLine& line) {
    auto o = std::make_shared<Options>();
    CLI::App& app = line.add("scene", "Run a published scene file of Desertscape or Oasis: wind and sand",
                             [=] { return run_scene(*o); });
    app.add_option("FILE", o->file, "Scene, JSON; its maps lie beside it")->required();
    app.add_option("--size", o->size, "Cells along the longer side; 0: as published. Cells keep their size")
        ->check(CLI::Range(0, 16384))
        ->capture_default_str();
    app.add_option("--steps", o->steps, "Steps; without it as many as the file says, else 500")
        ->check(CLI::Range(0, 10000000));
    app.add_option("--out", o->out, "Folder for pictures, fields.exr and report.json");
    app.add_option("--video", o->video, "Time lapse: FILE.mp4, or a folder for pictures");
    app.add_option("--every", o->every, "Steps between two of its frames")
        ->check(CLI::Range(1, 1000000))
        ->capture_default_str();
    app.add_option("--fps", o->fps, "Its frames per second")->check(CLI::Range(1, 240))->capture_default_str();
    app.add_flag("--until-quiet", o->until_quiet, "Avalanches run until nothing slides, not for the file's sweeps");
    app.add_flag("--keep-sticky", o->keep_sticky,
                 "Take echo classes from the map, as the published program does: all cells of such scenes are sticky");
    app.add_option("--wind-every", o->wind_every, "Steps between two solutions of the wind")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
    app.add_option("--seed", o->seed, "Seed of what is random")->capture_default_str();
    app.add_option("--threads", o->threads, "Threads; 0: as many as the machine has")
        ->check(CLI::Range(0, 256))
        ->capture_default_str();
    app.add_flag("--profile", o->profile, "Print the time of each pass");
    app.add_flag("--json", o->json, "Report as JSON");
}

} // namespace sahel::tools
