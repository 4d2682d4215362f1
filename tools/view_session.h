#pragma once

#include "render/gl_context.h"
#include "render/renderer.h"
#include "streaming/streamer.h"
#include "streaming/worker_pool.h"
#include "world/ground_sampler.h"
#include "world/surface_source.h"

#include <memory>
#include <string>

/// Joins a surface, the streamer and the renderer into a view that can be flown through.
///
///     SurfaceSource --build_view_tile on workers--> TileStreamer --publish--> Renderer slots --> picture
namespace sahel::tools {

struct ViewSessionDesc {
    int width = 1280;
    int height = 720;
    StreamSettings stream;
    Atmosphere atmosphere;
    int workers = 0; ///< 0: one less than the machine has threads, at least one
};

class ViewSession {
  public:
    /// The context must be current; `surface` must outlive the session.
    static Result<std::unique_ptr<ViewSession>> create(const SurfaceSource& surface, const ViewSessionDesc& desc);
    ~ViewSession();
    ViewSession(const ViewSession&) = delete;
    ViewSession& operator=(const ViewSession&) = delete;

    /// Loads until the view can be drawn as it should be, then draws it.
    Status render_settled(FrameDesc frame);
    /// Draws what is there now.
    /// `lod_view`: detail is chosen for this view instead (to look at it from elsewhere).
    void render_now(FrameDesc frame, double dt_s, const ViewState* lod_view = nullptr);
    /// The view of the last frame as the streamer saw it.
    [[nodiscard]] const ViewState& last_view() const { return last_view_; }

    /// Moves the sun: all bakes are renewed in the background when it moved by more than half a degree.
    void set_atmosphere(const Atmosphere& atmosphere);
    /// Sky, haze and exposure at once, baked shadows as they are: while a slider moves.
    void set_air(const Atmosphere& atmosphere) { renderer_->set_atmosphere(atmosphere); }

    [[nodiscard]] Renderer& renderer() { return *renderer_; }
    [[nodiscard]] TileStreamer& streamer() { return *streamer_; }
    /// Ground under the eye as the LOD distances see it: smooth over some tens of metres.
    [[nodiscard]] double lod_ground_m(double x_m, double y_m) { return lod_ground_.surface_m(x_m, y_m); }
    [[nodiscard]] std::string last_load_error() const;

  private:
    struct Shared;
    ViewSession(const SurfaceSource& surface, const ViewSessionDesc& desc);
    void complete(FrameDesc& frame);

    GroundSampler lod_ground_;
    ViewState last_view_;
    FrameDesc last_shown_;
    std::shared_ptr<Shared> shared_; ///< what workers read
    std::unique_ptr<Renderer> renderer_;
    std::unique_ptr<WorkerPool> workers_;
    std::unique_ptr<TileStreamer> streamer_; ///< destroyed first: waits for running loads
};

/// Look of a landscape: heights of rock and snow, hue of the sand.
SurfaceLook look_for(const std::string& preset, double ground_m);

} // namespace sahel::tools
