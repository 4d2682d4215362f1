#include "render/bookmarks.h"
#include "render/hud.h"
#include "render/layer_map.h"
#include "render/window.h"
#include "tools/command.h"
#include "tools/flight.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace sahel::tools {

namespace {

/// The viewer: input, camera, streaming, picture, panels, once a frame.
class Viewer {
  public:
    Viewer(const World& world, Window& window, ViewSession& session, Hud& hud, const CameraPose& start)
        : world_(world), window_(window), session_(session), hud_(hud), ground_(world.surface(), 0), start_(start),
          bookmark_file_(world.folder() / "bookmarks.json") {
        camera_.place(start);
        controls_.atmosphere = session.renderer().atmosphere();
        controls_.look = frame_of(world, start, {}, 0.0, 16, 16).look;
        if (auto loaded = load_bookmarks(bookmark_file_); loaded.ok()) bookmarks_ = *loaded;
        say("F1 shows the keys");
    }

    void run(int frames) {
        double last = window_.now_s();
        for (int drawn = 0; !window_.should_close() && (frames == 0 || drawn < frames); ++drawn) {
            const double now = window_.now_s();
            const double dt = std::clamp(now - last, 0.0, 0.25);
            frame_ms_ = (now - last) * 1e3;
            last = now;
            const InputState input = window_.poll();
            if (window_.width_px() == 0) continue; // minimised
            for (const ActionEvent& e : input.pressed) act(e);
            camera_.update(fly_input(input), dt, camera_ground(ground_));
            if (!time_paused_) time_s_ += dt;
            draw(dt);
            window_.swap();
        }
    }

  private:
    void say(std::string text) {
        message_ = std::move(text);
        message_until_s_ = window_.now_s() + 4.0;
    }
    void draw(double dt);
    void fill_model();
    void act(const ActionEvent& e);
    void change_time(double hours);
    void screenshot();
    void update_map();
    void save() {
        if (const Status s = save_bookmarks(bookmark_file_, bookmarks_); !s.ok()) say(s.error().message);
    }

    const World& world_;
    Window& window_;
    ViewSession& session_;
    Hud& hud_;
    GroundSampler ground_;
    CameraPose start_;
    FlyCamera camera_;
    std::filesystem::path bookmark_file_;
    std::vector<Bookmark> bookmarks_;
    HudControls controls_;
    HudModel model_;
    LayerMap map_;
    uint64_t map_version_ = 0;
    std::optional<Layer> map_of_;
    double map_x_ = 1e300, map_y_ = 1e300;
    ViewState frozen_view_;
    bool lod_frozen_ = false, time_paused_ = false, atmosphere_dirty_ = false;
    double time_s_ = 0.0, frame_ms_ = 0.0, message_until_s_ = 0.0;
    std::string message_;
};

void Viewer::change_time(double hours) {
    Atmosphere& a = controls_.atmosphere;
    a.sun_azimuth_deg = static_cast<float>(wrap_degrees(static_cast<double>(a.sun_azimuth_deg) + 15.0 * hours));
    // A day without a date: the sun culminates 62 degrees high in the north-south plane of azimuth -90.
    const double from_noon = wrap_degrees(static_cast<double>(a.sun_azimuth_deg) + 90.0) * 0.017453292519943295;
    a.sun_elevation_deg = static_cast<float>(std::clamp(32.0 + 30.0 * std::cos(from_noon), 0.5, 90.0));
    session_.set_atmosphere(a);
    say(fmt::format("sun {:.0f} degrees high", a.sun_elevation_deg));
}

void Viewer::screenshot() {
    Image image(session_.renderer().width(), session_.renderer().height(), 4);
    session_.renderer().read_pixels(image.pixels);
    const auto stamp =
        std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch())
            .count();
    const std::string name = fmt::format("sahel-{}.png", stamp);
    const Status s = write_png(name, image, {{"Title", world_.desc().name}});
    say(s.ok() ? "saved " + name : s.error().message);
}

void Viewer::act(const ActionEvent& e) {
    const auto step_layer = [&] {
        const int next = controls_.map_layer ? static_cast<int>(*controls_.map_layer) + 1 : 0;
        controls_.map_layer = next < k_layer_count ? std::optional(static_cast<Layer>(next)) : std::nullopt;
    };
    switch (e.action) {
    case Action::toggle_help:
        controls_.show_help = !controls_.show_help;
        break;
    case Action::toggle_hud:
        controls_.show_hud = !controls_.show_hud;
        break;
    case Action::toggle_map:
        controls_.show_map = !controls_.show_map;
        break;
    case Action::toggle_panels:
        controls_.show_panels = !controls_.show_panels;
        break;
    case Action::next_view:
        controls_.view =
            static_cast<DebugView>((static_cast<int>(controls_.view) + 1) % static_cast<int>(DebugView::count_));
        say(std::string("view: ") + name_of(controls_.view));
        break;
    case Action::plain_view:
        controls_.view = DebugView::none;
        break;
    case Action::next_layer:
        step_layer();
        break;
    case Action::toggle_wireframe:
        controls_.wireframe = !controls_.wireframe;
        break;
    case Action::screenshot:
        screenshot();
        break;
    case Action::bookmark: {
        if (e.set) {
            say(fmt::format("place {} set", set_bookmark(bookmarks_, e.digit, camera_.pose()) + 1));
            save();
        } else if (static_cast<size_t>(e.digit) <= bookmarks_.size()) {
            camera_.place(bookmarks_[static_cast<size_t>(e.digit) - 1].pose);
        }
        break;
    }
    case Action::pause_time:
        time_paused_ = !time_paused_;
        break;
    case Action::freeze_lod:
        lod_frozen_ = !lod_frozen_;
        say(lod_frozen_ ? "detail frozen where it is" : "detail follows the eye");
        break;
    case Action::earlier:
        change_time(-0.5);
        break;
    case Action::later:
        change_time(0.5);
        break;
    case Action::toggle_walk:
        camera_.set_mode(camera_.mode() == MoveMode::fly ? MoveMode::walk : MoveMode::fly);
        say(camera_.mode() == MoveMode::fly ? "flying" : "walking");
        break;
    case Action::go_home:
        camera_.place(start_);
        break;
    default:
        break;
    }
}

void Viewer::update_map() {
    const Vec3d& eye = camera_.pose().eye_m;
    constexpr double k_side_m = 8192.0;
    const bool moved = std::abs(eye[0] - map_x_) > k_side_m / 4 || std::abs(eye[1] - map_y_) > k_side_m / 4;
    if (!controls_.map_layer || (!moved && map_of_ == controls_.map_layer)) return;
    map_x_ = eye[0];
    map_y_ = eye[1];
    map_of_ = controls_.map_layer;
    auto made = make_layer_map(world_.surface(), *controls_.map_layer, eye[0], eye[1], k_side_m);
    if (!made.ok()) return say(made.error().message);
    map_ = std::move(made).value();
    ++map_version_;
}

void Viewer::fill_model() {
    const Renderer& r = session_.renderer();
    const StreamSettings& s = session_.streamer().settings();
    model_.title = world_.desc().name;
    model_.device = window_.context().info().renderer;
    model_.pose = camera_.pose();
    model_.speed_m_per_s = camera_.speed_m_per_s();
    model_.ground_m = ground_.surface_m(model_.pose.eye_m[0], model_.pose.eye_m[1]);
    model_.mode = camera_.mode();
    model_.frame_ms = frame_ms_;
    model_.render = r.stats();
    model_.stream = session_.streamer().stats();
    const auto resident = static_cast<uint64_t>(model_.stream.nodes_in_state[static_cast<size_t>(NodeState::resident)]);
    model_.budgets = {{"tile slots", resident, static_cast<uint64_t>(s.slots), false},
                      {"tile memory", resident * Renderer::slot_bytes(),
                       static_cast<uint64_t>(s.slots) * Renderer::slot_bytes(), true},
                      {"in flight", model_.stream.in_flight_bytes, static_cast<uint64_t>(s.in_flight_mib) << 20, true}};
    session_.streamer().list_nodes(model_.nodes);
    model_.view_cells = s.view_cells;
    model_.cell_m = world_.desc().cell_m;
    model_.map = {controls_.map_layer && !map_.image.pixels.empty() ? &map_.image : nullptr,
                  map_version_,
                  map_.x0_m,
                  map_.y0_m,
                  map_.side_m,
                  map_.legend};
    model_.bookmarks = bookmarks_;
    model_.message = window_.now_s() < message_until_s_ ? message_ : std::string();
    model_.time_paused = time_paused_;
    model_.lod_frozen = lod_frozen_;
}

void Viewer::draw(double dt) {
    Renderer& r = session_.renderer();
    r.resize(window_.width_px(), window_.height_px());
    FrameDesc frame = frame_of(world_, camera_.pose(), camera_.velocity_m_per_s(), time_s_, r.width(), r.height());
    frame.look = controls_.look;
    frame.debug = controls_.view;
    frame.wireframe = controls_.wireframe;
    session_.render_now(frame, dt, lod_frozen_ ? &frozen_view_ : nullptr);
    if (!lod_frozen_) frozen_view_ = session_.last_view();
    if (controls_.show_map) update_map();
    fill_model();
    glBindFramebuffer(GL_FRAMEBUFFER, r.framebuffer());
    const HudEvents events = hud_.draw(model_, controls_, r.width(), r.height(), dt, !window_.mouse_captured());
    glBlitNamedFramebuffer(r.framebuffer(), 0, 0, 0, r.width(), r.height(), 0, 0, r.width(), r.height(),
                           GL_COLOR_BUFFER_BIT, GL_NEAREST);
    if (events.atmosphere_changed) session_.set_air(controls_.atmosphere);
    if (events.sun_settled) session_.set_atmosphere(controls_.atmosphere);
    if (events.add_bookmark) {
        bookmarks_.push_back({fmt::format("place {}", bookmarks_.size() + 1), camera_.pose()});
        save();
    }
    if (events.go_to_bookmark && *events.go_to_bookmark < bookmarks_.size())
        camera_.place(bookmarks_[*events.go_to_bookmark].pose);
    if (events.remove_bookmark && *events.remove_bookmark < bookmarks_.size()) {
        bookmarks_.erase(bookmarks_.begin() + static_cast<std::ptrdiff_t>(*events.remove_bookmark));
        save();
    }
    if (events.rename_bookmark && events.rename_bookmark->first < bookmarks_.size()) {
        bookmarks_[events.rename_bookmark->first].name = events.rename_bookmark->second;
        save();
    }
}

} // namespace

int fly_in_window(const World& world, const ViewSessionDesc& desc, const CameraPose& start, int frames) {
    auto window = Window::create(desc.width, desc.height, "Sahel: " + world.desc().name);
    if (!window.ok()) return fail(window.error());
    auto session = ViewSession::create(world.surface(), desc);
    if (!session.ok()) return fail(session.error());
    const auto hud = Hud::create((*window)->glfw());
    Viewer viewer(world, **window, **session, *hud, start);
    viewer.run(frames);
    return 0;
}

} // namespace sahel::tools
