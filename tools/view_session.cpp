#include "tools/view_session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <thread>

namespace sahel::tools {

struct ViewSession::Shared {
    std::mutex mutex;
    SunDirection sun;
    std::string error;
};

ViewSession::ViewSession(const SurfaceSource& surface, const ViewSessionDesc& desc)
    : lod_ground_(surface, 4), shared_(std::make_shared<Shared>()) {
    shared_->sun = sun_direction(desc.atmosphere);
}

ViewSession::~ViewSession() = default;

Result<std::unique_ptr<ViewSession>> ViewSession::create(const SurfaceSource& surface, const ViewSessionDesc& desc) {
    auto session = std::unique_ptr<ViewSession>(new ViewSession(surface, desc));
    RendererDesc render;
    render.width = desc.width;
    render.height = desc.height;
    render.slots = desc.stream.slots;
    render.cell_m = surface.cell_m();
    render.lod_factor = desc.stream.lod_factor;
    SAHEL_ASSIGN(session->renderer_, Renderer::create(render));
    session->renderer_->set_atmosphere(desc.atmosphere);
    const int machine = static_cast<int>(std::thread::hardware_concurrency());
    session->workers_ = std::make_unique<WorkerPool>(desc.workers > 0 ? desc.workers : std::max(1, machine));

    StreamExternals externals;
    externals.cell_m = surface.cell_m();
    externals.max_payload_bytes = view_tile_max_bytes();
    externals.max_context_bytes = ViewTileContext::max_bytes();
    externals.slot_bytes = Renderer::slot_bytes();
    externals.load = [&surface, shared = session->shared_](
                         TileKey key,
                         const std::shared_ptr<const TileContext>& parent) -> Result<std::unique_ptr<TilePayload>> {
        SunDirection sun;
        {
            const std::lock_guard lock(shared->mutex);
            sun = shared->sun;
        }
        auto tile = build_view_tile(surface, key, sun, parent);
        if (!tile.ok()) {
            const std::lock_guard lock(shared->mutex);
            shared->error = tile.error().message;
            return tile.error();
        }
        return std::unique_ptr<TilePayload>(std::move(tile).value());
    };
    externals.publish = [renderer = session->renderer_.get()](NodeHandle node, TileKey, TilePayload& payload) {
        renderer->upload(node.slot, static_cast<const ViewTile&>(payload));
    };
    externals.submit = [workers = session->workers_.get()](std::function<void()> job) {
        workers->submit(std::move(job));
    };
    externals.now_s = [] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
    };
    session->streamer_ = std::make_unique<TileStreamer>(desc.stream, std::move(externals));
    return session;
}

void ViewSession::complete(FrameDesc& frame) {
    frame.view.ground_m = std::min(lod_ground_m(frame.view.eye_m[0], frame.view.eye_m[1]), frame.view.eye_m[2] - 1.0);
    frame.view.aspect = static_cast<double>(renderer_->width()) / static_cast<double>(renderer_->height());
    frame.view.viewport_height_px = renderer_->height();
}

Status ViewSession::render_settled(FrameDesc frame) {
    complete(frame);
    if (!streamer_->settle(frame.view)) {
        const std::string why = last_load_error();
        return Error{ErrorKind::io, why.empty() ? "some tiles of the view could not be loaded" : why};
    }
    last_shown_ = frame;
    renderer_->render(frame, streamer_->frame().visible);
    return {};
}

void ViewSession::render_now(FrameDesc frame, double dt_s, const ViewState* lod_view) {
    complete(frame);
    last_view_ = frame.view;
    const FrameResult result = streamer_->update(lod_view ? *lod_view : frame.view, dt_s);
    if (!result.stats.held) last_shown_ = frame; // after a jump the last picture stays until there is ground to show
    renderer_->render(last_shown_, result.visible);
}

void ViewSession::set_atmosphere(const Atmosphere& atmosphere) {
    const SunDirection sun = sun_direction(atmosphere);
    bool moved = false;
    {
        const std::lock_guard lock(shared_->mutex);
        constexpr float k_half_degree = 0.0087266f;
        moved = std::fabs(sun.azimuth_rad - shared_->sun.azimuth_rad) * std::cos(sun.elevation_rad) > k_half_degree ||
                std::fabs(sun.elevation_rad - shared_->sun.elevation_rad) > k_half_degree;
        if (moved) shared_->sun = sun;
    }
    renderer_->set_atmosphere(atmosphere);
    if (moved) streamer_->invalidate_all();
}

std::string ViewSession::last_load_error() const {
    const std::lock_guard lock(shared_->mutex);
    return shared_->error;
}

SurfaceLook look_for(const std::string& preset, double ground_m) {
    SurfaceLook look;
    const auto base = static_cast<float>(ground_m);
    if (preset == "dunes") look.sand_hue = 0.45f;
    if (preset == "canyon") {
        look.sand_hue = 0.7f;
        look.grey_rock_from_m = base + 1500.0f;
        look.grey_rock_to_m = base + 2500.0f;
        look.snow_from_m = base + 3000.0f;
    } else if (preset == "mountains") {
        look.grey_rock_from_m = base + 60.0f;
        look.grey_rock_to_m = base + 350.0f;
        look.snow_from_m = base + 1150.0f;
        look.strata = 0.5f;
    } else if (preset == "islands" || preset == "wetland") {
        look.sand_hue = 0.05f;
        look.grey_rock_from_m = 20.0f;
        look.grey_rock_to_m = 260.0f;
        look.snow_from_m = 2500.0f;
        look.strata = 0.35f;
    } else {
        look.grey_rock_from_m = base + 220.0f;
        look.grey_rock_to_m = base + 620.0f;
        look.snow_from_m = base + 1500.0f;
    }
    return look;
}

} // namespace sahel::tools
