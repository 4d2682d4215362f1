#pragma once

#include "world/memory.h"
#include "world/result.h"
#include "world/tile_key.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

/// Which tiles are shown, which are wanted next and what stays in memory. Knows no GL: tests drive it on a fake clock.
namespace sahel {

/// A place in the node pool; a stale handle is detected by its generation.
struct NodeHandle {
    uint32_t slot = 0;
    uint32_t generation = 0; ///< 0 is null
    friend bool operator==(const NodeHandle&, const NodeHandle&) = default;
    explicit operator bool() const { return generation != 0; }
};

/// What a resident tile leaves on the host for the loads of its children (a coarse height grid to cast shadows from).
class TileContext {
  public:
    virtual ~TileContext() = default;
    [[nodiscard]] virtual uint64_t bytes() const = 0;
};

/// What a loaded tile is to its user (the renderer's tile textures on their way to the GPU). Made on a worker.
class TilePayload {
  public:
    virtual ~TilePayload() = default;
    [[nodiscard]] virtual uint64_t bytes() const = 0; ///< host bytes held until published
    [[nodiscard]] virtual float min_height_m() const = 0;
    [[nodiscard]] virtual float max_height_m() const = 0;
    /// Kept by the streamer while the tile is resident and handed to the loads of its children; may be null.
    [[nodiscard]] virtual std::shared_ptr<const TileContext> context() const { return nullptr; }
};

/// Position and view, world metres: x east, y south, z up.
struct ViewState {
    std::array<double, 3> eye_m{};
    std::array<double, 3> velocity_m_per_s{};
    std::array<double, 3> forward{0.0, 1.0, 0.0};
    std::array<double, 3> up{0.0, 0.0, 1.0};
    double vertical_fov_rad = 0.9;
    double aspect = 16.0 / 9.0;
    int viewport_height_px = 720;
    double ground_m = 0.0; ///< height of the ground below the eye; the vertical part of LOD distances
};

/// One tile to draw. A quadrant whose child is drawn instead is masked out; what remains is drawn from this tile.
struct VisibleTile {
    TileKey key;
    NodeHandle node;
    NodeHandle parent;         ///< null at the root level
    uint8_t quadrant_mask = 0; ///< bit i: quadrant i (as TileKey::child) is drawn from this tile
    uint8_t fallback_mask = 0; ///< bit i: quadrant i wants its child, which is not here yet
    float fade = 1.0f;         ///< 0 when the tile has just appeared, 1 after fade_s
    float min_height_m = 0.0f;
    float max_height_m = 0.0f;
};

} // namespace sahel
