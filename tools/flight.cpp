#include "tools/flight.h"

#include "tools/command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sahel::tools {

namespace {

constexpr double k_overtime = 1.05; ///< of the time that a recording is given

/// Highest ground in a ring of points: a cheap guard against starting inside a hill.
double highest_near(GroundSampler& ground, double x, double y, double radius_m) {
    double high = ground.surface_m(x, y);
    for (int i = 0; i < 16; ++i) {
        const double a = i * 0.3927;
        high = std::max(high, ground.surface_m(x + radius_m * std::cos(a), y + radius_m * std::sin(a)));
    }
    return high;
}

} // namespace

GroundFunction camera_ground(GroundSampler& sampler) {
    return [&sampler](double x, double y) { return sampler.surface_m(x, y); };
}

CameraPose default_start(const World& world, GroundSampler& ground) {
    CameraPose pose;
    double x = 0.0, y = 0.0, height = 25.0;
    const auto info = world.info();
    if (world.desc().preset == "none" && info.ok() && info->tile_count > 0) {
        const double cell = world.desc().cell_m;
        const CellRect b = info->bounds;
        const double side = static_cast<double>(std::max(b.width(), b.height())) * cell;
        x = static_cast<double>(b.x0 + b.x1) * 0.5 * cell;
        y = static_cast<double>(b.y0) * cell + static_cast<double>(b.height()) * cell * 0.80;
        height = std::max(20.0, side * 0.06);
        pose.yaw_deg = -90.0; // north, over the data
        pose.pitch_deg = -12.0;
    } else {
        // The point of a coarse grid that sees most relief without standing on it.
        double best = -1e30;
        for (int j = -8; j <= 8; ++j)
            for (int i = -8; i <= 8; ++i) {
                const double cx = i * 1000.0, cy = j * 1000.0;
                const GroundSample here = ground.at(cx, cy);
                double score = here.sand_m * 0.2 - 0.02 * (std::abs(cx) + std::abs(cy)) * 0.01;
                double far_high = -1e30;
                for (int k = 0; k < 8; ++k) {
                    const double a = k * 0.7854;
                    const GroundSample s = ground.at(cx + 700.0 * std::cos(a), cy + 700.0 * std::sin(a));
                    score += std::min(s.water_m, 3.0) * 4.0;
                    const double h = ground.surface_m(cx + 4000.0 * std::cos(a), cy + 4000.0 * std::sin(a));
                    if (h > far_high) {
                        far_high = h;
                        if (score > best) pose.yaw_deg = k * 45.0;
                    }
                }
                score += std::min(far_high - here.ground_m, 600.0) * 0.05 - std::min(here.water_m, 5.0) * 10.0;
                if (score > best) {
                    best = score;
                    x = cx;
                    y = cy;
                }
            }
        pose.pitch_deg = -4.0;
    }
    pose.eye_m = {x, y, highest_near(ground, x, y, 12.0) + height};
    return pose;
}

Result<CameraPath> default_path(const World& world, GroundSampler& ground, double seconds) {
    const CameraPose start = default_start(world, ground);
    FlyoverOptions options;
    const double yaw = start.yaw_deg * 0.017453292519943295;
    for (int i = 0; i < 5; ++i) {
        const double along = i * 250.0, aside = 90.0 * std::sin(i * 1.3);
        options.waypoints_m.push_back({start.eye_m[0] + along * std::cos(yaw) - aside * std::sin(yaw),
                                       start.eye_m[1] + along * std::sin(yaw) + aside * std::cos(yaw)});
    }
    options.duration_s = seconds;
    options.height_m = 40.0;
    return flyover_path(options, camera_ground(ground));
}

FrameDesc frame_of(const World& world, const CameraPose& pose, const Vec3d& velocity, double time_s, int width,
                   int height) {
    FrameDesc frame;
    frame.view = make_view_state(pose, velocity, width, height, 0.0);
    frame.time_s = time_s;
    const double base =
        world.desc().preset == "none" ? world.desc().outside_m : static_cast<double>(world.desc().terrain.base_m);
    frame.haze_base_m = static_cast<float>(base);
    frame.look = look_for(world.desc().preset, base);
    if (world.desc().preset != "none")
        frame.look.wind_azimuth_deg =
            static_cast<float>(std::atan2(world.desc().terrain.wind_y, world.desc().terrain.wind_x) * 57.29577951);
    return frame;
}

Result<Image> still(ViewSession& session, const World& world, const CameraPose& pose, double time_s, int samples,
                    DebugView debug) {
    Renderer& r = session.renderer();
    FrameDesc frame = frame_of(world, pose, {}, time_s, r.width(), r.height());
    frame.samples = samples;
    frame.debug = debug;
    SAHEL_TRY(session.render_settled(frame));
    Image image(r.width(), r.height(), 4);
    r.read_pixels(image.pixels);
    return image;
}

Result<RecordReport> record(ViewSession& session, const World& world, const CameraPath& path,
                            const std::filesystem::path& out, const RecordOptions& options,
                            const std::function<void(int, int)>& progress) {
    Renderer& r = session.renderer();
    VideoSettings video;
    video.width_px = r.width();
    video.height_px = r.height();
    video.frames_per_s = options.frames_per_s;
    video.encoder_speed = "veryfast"; // it shares the processor with the drawing
    video.title = world.desc().name;
    SAHEL_ASSIGN(VideoWriter writer, VideoWriter::open(out, video));
    RecordReport report;
    report.samples = options.samples;
    const int frames = options.frames > 0
                           ? options.frames
                           : std::max(1, static_cast<int>(std::lround(path.duration_s() * options.frames_per_s)));
    Image image(r.width(), r.height(), 4);
    const double begin = now_s();
    double since = begin; // the first frame also waits for the tiles: it tells nothing
    int frames_since = 0;
    for (int i = 0; i < frames; ++i) {
        const double frame_begin = now_s();
        if (i == 1) since = frame_begin;
        frames_since = i < 1 ? 0 : frames_since + 1;
        if (options.max_s > 0.0 && report.samples > 1 && (i == 5 || (i > 5 && frames_since > options.frames_per_s))) {
            // What was seen last decides how many samples the rest can afford. A little over the time is allowed: a
            // flight whose sharpness changes on the way is worse than one that takes a little longer. The first frames
            // are dear, since tiles ahead still load beside them: they get the credit of a fifth of a sample.
            const double per_sample = (frame_begin - since) / (frames_since - 1) / report.samples;
            const double left = k_overtime * options.max_s - (frame_begin - begin);
            const double affordable = left / (per_sample * (frames - i)) + (i == 5 ? 0.2 : 0.0);
            report.samples = std::clamp(static_cast<int>(affordable), 1, report.samples);
            since = frame_begin;
            frames_since = 1;
        }
        const double t = path.start_s() + (frames > 1 ? static_cast<double>(i) / options.frames_per_s : 0.0);
        FrameDesc frame = frame_of(world, path.pose_at(t), path.velocity_at(t), t, r.width(), r.height());
        frame.samples = report.samples;
        if (options.realtime)
            session.render_now(frame, 1.0 / options.frames_per_s);
        else
            SAHEL_TRY(session.render_settled(frame));
        report.fallback_frames += session.streamer().stats().fallbacks > 0 ? 1 : 0;
        r.read_pixels(image.pixels);
        SAHEL_TRY(writer.add_frame(image));
        ++report.frames;
        report.worst_frame_ms = std::max(report.worst_frame_ms, (now_s() - frame_begin) * 1e3);
        if (progress) progress(i + 1, frames);
    }
    SAHEL_TRY(writer.finish());
    report.seconds = now_s() - begin;
    report.path = writer.path().string();
    report.note = writer.note();
    return report;
}

} // namespace sahel::tools
