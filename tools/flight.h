#pragma once

#include "render/camera_flights.h"
#include "render/camera_path.h"
#include "render/video_writer.h"
#include "tools/view_session.h"
#include "world/world.h"

#include <functional>
#include <string>

/// What `fly` and `demo` share: where a world is worth seeing, and frames of a flight into a file.
namespace sahel::tools {

/// Ground for cameras: the surface at 2 m cells, smooth enough to fly over and never below what is drawn.
GroundFunction camera_ground(GroundSampler& sampler);

/// Where a flight over a world starts when nothing is said: over the middle of imported data, else at a place that the
/// landscape suggests.
CameraPose default_start(const World& world, GroundSampler& ground);

/// A short flight round the start.
Result<CameraPath> default_path(const World& world, GroundSampler& ground, double seconds);

/// Frame description of a pose; look and haze follow the world.
FrameDesc frame_of(const World& world, const CameraPose& pose, const Vec3d& velocity_m_per_s, double time_s, int width,
                   int height);

struct RecordOptions {
    int frames = 0; ///< 0: as long as the path
    int frames_per_s = 24;
    int samples = 1;
    bool realtime = false; ///< show streaming as it is: no frame waits
    double max_s = 0.0;    ///< fewer samples from then on when frames show that it would take longer; 0: no limit
};

struct RecordReport {
    int frames = 0;
    int samples = 1; ///< of the last frame; no frame has fewer
    double seconds = 0.0;
    double worst_frame_ms = 0.0;
    int fallback_frames = 0; ///< frames in which a parent stood in for a child (realtime only)
    std::string path, note;
};

/// Renders a path into a video, or a folder of pictures.
Result<RecordReport> record(ViewSession& session, const World& world, const CameraPath& path,
                            const std::filesystem::path& out, const RecordOptions& options,
                            const std::function<void(int, int)>& progress);

/// One picture.
Result<Image> still(ViewSession& session, const World& world, const CameraPose& pose, double time_s, int samples,
                    DebugView debug = DebugView::none);

/// The interactive viewer; returns the exit code. `frames`: closes after so many, 0: when the user says so.
int fly_in_window(const World& world, const ViewSessionDesc& desc, const CameraPose& start, int frames);

} // namespace sahel::tools
