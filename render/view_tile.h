#pragma once

#include "streaming/streamer.h"
#include "world/surface_source.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

/// What the renderer needs of one tile, made on a worker from the cells of a SurfaceSource; no GL here.
///
/// A view tile has 512 x 512 cells of its level whatever the store's tile size is, and reads a halo around them.
///
///   lattice   heights at cell *corners*: spacing 2, 4 and 8 cells (257^2, 129^2, 65^2 values; 2 and 4 only at level
///   0).
///             A coarser lattice is the tent-filtered finer one, so geometry is band-limited; two tiles give the same
///             floats on their shared edge, because each value depends on the same cells in the same order.
///   textures  528 x 528 texels: 512 plus a border of 8, so that 4 mip levels (528, 264, 132, 66) filter across the
///             tile's edge without seams. Texel (0, 0) is cell (-8, -8) of the tile.
namespace sahel {

inline constexpr int k_view_cells = 512;
inline constexpr int k_view_border = 8;
inline constexpr int k_view_texels = k_view_cells + 2 * k_view_border; // 528 = 16 x 33: four exact halvings
inline constexpr int k_view_mips = 4;
inline constexpr float k_least_water_m = -0.05f; // water is drawn where it is above the ground by more; see water.frag
inline constexpr int k_lattice_count = 3;        ///< spacing 2, 4, 8 cells
inline constexpr std::array<int, k_lattice_count> k_lattice_spacing = {2, 4, 8};
inline constexpr std::array<int, k_lattice_count> k_lattice_side = {257, 129, 65};

/// Sun for the baked visibility; a tile is baked again when it moves by more than half a degree.
struct SunDirection {
    float azimuth_rad = 0.0f;   ///< of the direction to the sun, from +x (east) towards +y (south)
    float elevation_rad = 0.2f; ///< above the horizon
};

/// Mip chain of a texture, level 0 first, tightly packed.
template <class Texel> using MipChain = std::array<std::vector<Texel>, k_view_mips>;

struct Rgba8 {
    uint8_t r = 0, g = 0, b = 0, a = 0;
};
struct Snorm16x2 {
    int16_t x = 0, y = 0;
};

/// Heights of a tile, kept for the loads of its children: the mean ground of every 4 x 4 cells, 132 x 132 values from
/// cell (-8, -8) on, and the chain of parents up to the root.
class ViewTileContext final : public TileContext {
  public:
    static constexpr int k_side = k_view_texels / 4;
    TileKey key;
    double cell_m = 1.0; ///< of the tile's level
    float max_m = 0.0f;  ///< highest ground of the tile
    std::vector<float> ground_m;
    std::shared_ptr<const ViewTileContext> parent;

    [[nodiscard]] uint64_t bytes() const override { return sizeof(*this) + ground_m.size() * sizeof(float); }
    static constexpr uint64_t max_bytes() { return sizeof(ViewTileContext) + sizeof(float) * k_side * k_side; }
};

/// Where in a tile there may be water to draw, by blocks of 32 x 32 cells.
class WaterBlocks {
  public:
    /// Water at a cell of the tile or of its border. The blocks around count too: coarse mip levels spread it by 16
    /// cells.
    void add(int cell_x, int cell_y);
    /// Whether any may be in the square of `side` cells, 32 at least, from a corner of blocks on.
    [[nodiscard]] bool any(int cell_x, int cell_y, int side) const;

  private:
    static constexpr int k_block = 32;
    std::array<uint16_t, k_view_cells / k_block> rows_{}; ///< bit x of row y: block (x, y)
};

class ViewTile final : public TilePayload {
  public:
    TileKey key;
    double cell_m = 1.0; ///< of this level

    /// Ground (rock + soil + sand) and water surface heights at lattice corners, m; index k_lattice_*; empty where the
    /// level has no such lattice. Where there is no water near, the water surface lies below the ground.
    std::array<std::vector<float>, k_lattice_count> ground_m;
    std::array<std::vector<float>, k_lattice_count> water_m;

    MipChain<Snorm16x2> normal; ///< x (east) and y (south) of the unit normal of the ground
    MipChain<Rgba8> material; ///< sand thickness (255 = 0.5 m), soil and litter, moisture, shore distance (-20 .. 60 m)
    MipChain<Rgba8> bake; ///< half size (264, 132, 66, 33): sun visibility, sky visibility, canopy shadow, canopy cover
    MipChain<Snorm16x2> water; ///< x: water surface minus ground, 1/256 m (clamped); y: rock exposure 0..32767
    MipChain<Rgba8> wind;      ///< half size; empty: nothing was simulated here. Wind east and south (encode_wind),
                               ///< shelter, sand in the air (255 = 0.5 m)
    WaterBlocks water_blocks;

    float min_m = 0.0f, max_m = 0.0f; ///< over ground and water lattices
    std::shared_ptr<const ViewTileContext> height_context;

    [[nodiscard]] uint64_t bytes() const override;
    [[nodiscard]] float min_height_m() const override { return min_m; }
    [[nodiscard]] float max_height_m() const override { return max_m; }
    [[nodiscard]] std::shared_ptr<const TileContext> context() const override;
};

/// Wind in a texel: 128 is calm, and 255 is 20 m/s.
inline constexpr float k_wind_unit_per_m_per_s = 127.0f / 20.0f;

/// Largest host bytes any ViewTile takes, for budgets.
uint64_t view_tile_max_bytes();

/// Builds the view tile of a key. `parent` is the context of the parent tile (null at the root level): shadows are cast
/// through it from beyond the tile's own cells. A pure function of (source, key, sun, chain of parents). Thread safe.
Result<std::unique_ptr<ViewTile>> build_view_tile(const SurfaceSource& source, TileKey key, const SunDirection& sun,
                                                  const std::shared_ptr<const TileContext>& parent);

} // namespace sahel
