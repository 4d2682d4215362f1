#pragma once

#include "render/camera.h"
#include "world/surface_source.h"

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

/// What one sees all round from a point, found by the processor: cheap enough to look from hundreds of places.
///
/// For each azimuth a ray walks outwards over the surface with steps that grow with the distance and cells that grow
/// with the steps; what rises above all before it fills the pixels in between (the column caster of the height-field
/// games: Cohen-Or et al. 1996). Pixels are half a degree, so a view of 80 x 50 degrees is 160 x 100 of them, and a
/// turn of the head is a shift of columns.
namespace sahel {

enum class ViewMaterial : uint8_t { sky, rock, soil, sand, water };

/// Surface cells at several levels, read when first needed. Owner thread only.
class ViewTerrain {
  public:
    explicit ViewTerrain(const SurfaceSource& source, uint64_t max_bytes = uint64_t{96} << 20);

    struct Cell {
        float surface_m; ///< of the water where there is some
        ViewMaterial material;
    };
    /// The cell of `level` at world metres.
    Cell at(int level, double x_m, double y_m);
    /// Rise to the east and to the south at a cell, m/m.
    std::pair<float, float> slope(int level, double x_m, double y_m);
    [[nodiscard]] double cell_m(int level) const;
    /// Blocks that could not be read count as a plain; true once that happened.
    [[nodiscard]] bool failed() const { return failed_; }

  private:
    static constexpr int k_side = 64;
    struct Block {
        std::vector<float> surface_m;
        std::vector<ViewMaterial> material;
    };
    const Block& block(TileKey key);
    const SurfaceSource& source_;
    uint64_t max_blocks_;
    std::unordered_map<TileKey, std::unique_ptr<Block>> blocks_;
    TileKey last_key_{-1, 0, 0};
    const Block* last_ = nullptr;
    bool failed_ = false;
};

struct Panorama {
    static constexpr int k_columns = 720; ///< azimuth, half a degree each: 0 east, 90 south
    static constexpr int k_rows = 150;    ///< elevation from +35 (row 0) to -40 degrees
    static constexpr double k_top_deg = 35.0;
    static constexpr double k_step_deg = 0.5;

    struct Pixel {
        float distance_m = 0.0f; ///< 0: sky
        float east = 0.0f;       ///< rise of the surface to the east, m/m
        float south = 0.0f;
        ViewMaterial material = ViewMaterial::sky;
    };
    std::vector<Pixel> pixels;        ///< rows of columns
    std::vector<float> skyline_deg;   ///< elevation where the sky begins, by column
    std::vector<float> skyline_m;     ///< distance of what stands there
    std::vector<float> near_rise_deg; ///< highest elevation of what stands within 40 m, by column

    [[nodiscard]] const Pixel& at(int column, int row) const {
        const int c = ((column % k_columns) + k_columns) % k_columns;
        return pixels[static_cast<size_t>(row * k_columns + c)];
    }
};

Panorama cast_panorama(ViewTerrain& terrain, const Vec3d& eye_m, double reach_m = 40000.0);

} // namespace sahel
