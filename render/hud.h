#pragma once

#include "render/atmosphere.h"
#include "render/bookmarks.h"
#include "render/camera.h"
#include "render/png_io.h"
#include "render/renderer.h"
#include "streaming/streamer.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

struct GLFWwindow;

/// Panels over the picture: statistics, tile map, sun and air, views, bookmarks, help. Drawn by Dear ImGui into the
/// bound framebuffer, with a window or without one.
///
///     +-----------+                                     +-----------+
///     | frame     |                                     | tile map  |
///     | streaming |                                     |           |
///     |           |                                     +-----------+
///     +-----------+                                     | sun, air, |
///     | bookmarks |        one line of messages         | views     |
///     +-----------+     +-----------------------+       +-----------+
namespace sahel {

/// How full something is against its limit.
struct HudBudget {
    std::string name;
    uint64_t used = 0;
    uint64_t limit = 0;
    bool bytes = true; ///< else a count
};

/// A picture of the ground below the tile map.
struct HudMapImage {
    const Image* image = nullptr; ///< RGBA, north up; null: none
    uint64_t version = 0;         ///< changes with the picture
    double x0_m = 0.0, y0_m = 0.0, side_m = 1.0;
    std::string legend; ///< "sand 0 to 12 m"
};

/// What the panels show. The caller fills it each frame; nothing is kept but the curve of frame times.
struct HudModel {
    std::string title;  ///< of the world
    std::string device; ///< of GL
    CameraPose pose;
    double speed_m_per_s = 0.0;
    double ground_m = 0.0; ///< surface below the eye
    MoveMode mode = MoveMode::fly;
    double frame_ms = 0.0; ///< the last frame, start to start
    RenderStats render;
    StreamStats stream;
    std::vector<HudBudget> budgets;
    std::vector<std::pair<std::string, std::string>> rows; ///< more lines for the statistics: name, value
    std::vector<NodeInfo> nodes;
    int view_cells = 512;
    double cell_m = 1.0;
    HudMapImage map;
    std::span<const Bookmark> bookmarks;
    std::string message; ///< shown at the bottom
    bool time_paused = false;
    bool lod_frozen = false;
};

/// What the user can change; the caller gives the present values, the panels change them.
struct HudControls {
    bool show_help = false;
    bool show_hud = true;
    bool show_map = true;
    bool show_panels = true;
    Atmosphere atmosphere;
    SurfaceLook look;
    DebugView view = DebugView::none;
    bool wireframe = false;
    std::optional<Layer> map_layer; ///< picture below the tile map
};

/// What the user did in this frame.
struct HudEvents {
    bool atmosphere_changed = false; ///< at once, while a slider moves
    bool sun_settled = false;        ///< a slider of the sun was let go: baked shadows may be made again
    bool look_changed = false;
    bool add_bookmark = false;
    std::optional<size_t> go_to_bookmark;
    std::optional<size_t> remove_bookmark;
    std::optional<std::pair<size_t, std::string>> rename_bookmark;
};

struct HudRect {
    float x = 0, y = 0, width = 0, height = 0;
};
/// Where the panels stand for a picture of some size; pure. `scale` as Hud::scale_for.
struct HudLayout {
    HudRect stats, bookmarks, map, controls, message, help;
};
HudLayout hud_layout(int width_px, int height_px, float scale, bool map, bool controls);

class Hud {
  public:
    /// `window` null: no keys and mouse. A GL context must be current, here and in draw(). One Hud at a time.
    static std::unique_ptr<Hud> create(GLFWwindow* window);
    ~Hud();
    Hud(const Hud&) = delete;
    Hud& operator=(const Hud&) = delete;

    /// Draws into the bound framebuffer of the given size. `mouse_free`: the pointer is not captured by the flight.
    /// Panels that fit their contents settle at the second call: draw twice for a still picture.
    HudEvents draw(const HudModel& model, HudControls& controls, int width_px, int height_px, double dt_s,
                   bool mouse_free = true);

    /// Panels of the last draw(), as they stand in the picture.
    struct Panel {
        std::string name;
        HudRect rect;
    };
    [[nodiscard]] const std::vector<Panel>& panels() const;

    /// Size of text against 720 lines: 1 up to 900 lines, 2 at 2160.
    static float scale_for(int height_px);

  private:
    struct Impl;
    explicit Hud(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// Colour of a node's state on the map, RGBA.
std::array<uint8_t, 4> colour_of(NodeState state);

} // namespace sahel
