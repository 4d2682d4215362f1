#pragma once

#include "render/atmosphere.h"
#include "render/sky_table.h"
#include "render/view_tile.h"
#include "streaming/streamer.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

/// Draws view tiles with OpenGL 4.5: terrain, sky, water, exposure. A GL context must be current in the calling thread
/// for the life of the Renderer.
///
///     tiles -> nodes (CDLOD) -> terrain -> sky -> copy -> water -> bloom -> tone curve -> sum of samples -> encode
///
/// Pictures are deterministic: the same tiles, view, time and sample count give the same bytes on one driver.
namespace sahel {

struct RendererDesc {
    int width = 1280;
    int height = 720;
    int slots = 96;          ///< tiles that can be resident
    double cell_m = 1.0;     ///< of level 0
    float lod_factor = 2.1f; ///< must be the streamer's
};

enum class DebugView : int {
    none,
    normals,
    slope,
    sand,
    litter,
    moisture,
    shore,
    sun,
    sky,
    level,
    morph,
    water,
    rock,
    slot,
    wind,
    shelter,
    airborne,
    count_
};
const char* name_of(DebugView view);

struct FrameDesc {
    ViewState view;
    double time_s = 0.0;
    float haze_base_m = 0.0f; ///< height at which Atmosphere::haze_per_m holds
    SurfaceLook look;
    DebugView debug = DebugView::none;
    bool wireframe = false;
    bool depth_only = false; ///< only the depth of the ground (read_depth); the picture stays as it was
    int samples = 1;         ///< jittered pictures that are averaged
};

struct RenderStats {
    int tiles = 0;
    int nodes = 0;
    int triangles = 0;
    double terrain_ms = 0.0, sky_ms = 0.0, water_ms = 0.0, post_ms = 0.0; ///< only with time_passes(true)
};

class Renderer {
  public:
    static Result<std::unique_ptr<Renderer>> create(const RendererDesc& desc);
    ~Renderer();
    Renderer(const Renderer&) = delete;
    Renderer& operator=(const Renderer&) = delete;

    /// Video memory of one slot and of everything else, exactly what is allocated, bytes.
    static uint64_t slot_bytes();
    [[nodiscard]] uint64_t fixed_bytes() const;

    void upload(uint32_t slot, const ViewTile& tile);
    void set_atmosphere(const Atmosphere& atmosphere);
    [[nodiscard]] const Atmosphere& atmosphere() const;
    [[nodiscard]] const SkyTable& sky() const;

    /// Draws into the renderer's own picture.
    void render(const FrameDesc& frame, std::span<const VisibleTile> tiles);
    /// The picture, RGBA, rows from the top.
    void read_pixels(std::vector<uint8_t>& rgba) const;
    /// Depth of the last sample, rows from the top; 0 is nothing.
    void read_depth(std::vector<float>& depth) const;
    /// Framebuffer object that holds the picture, to draw panels onto or to copy to a window.
    [[nodiscard]] uint32_t framebuffer() const;
    void resize(int width, int height);
    [[nodiscard]] int width() const;
    [[nodiscard]] int height() const;

    void time_passes(bool on);
    [[nodiscard]] const RenderStats& stats() const;

  private:
    struct Impl;
    explicit Renderer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

} // namespace sahel
