#pragma once

#include "render/view_tile.h"

#include <span>
#include <vector>

/// Light baked into a tile: how much of the sun and of the sky its ground sees. Rays march through the tile's own
/// cells, then through the ever coarser heights of its ancestors, so a mountain far outside the tile still throws its
/// shadow.
namespace sahel {

/// Square grids of heights around one tile, fine to coarse; coordinates in cells of the tile, from its corner.
class HeightChain {
  public:
    struct Grid {
        const float* data;
        int side;
        float x0, y0;  ///< position of sample (0, 0)
        float inverse; ///< samples per cell
        float spacing; ///< cells per sample
        float max_m;
    };

    /// `ground` is the full resolution, `side` x `side` samples, the first at cell centre (first, first).
    HeightChain(std::span<const float> ground, int side, int first, const ViewTileContext& own);

    /// Bilinear height at (x, y), from the finest grid of at least `level` that reaches there; false beyond the root.
    bool sample(float x, float y, size_t level, float& height) const {
        for (size_t i = level; i < grids_.size(); ++i) {
            const Grid& g = grids_[i];
            const float u = (x - g.x0) * g.inverse, v = (y - g.y0) * g.inverse;
            const auto limit = static_cast<float>(g.side - 1);
            if (!(u >= 0.0f && v >= 0.0f && u < limit && v < limit)) continue;
            const int iu = static_cast<int>(u), iv = static_cast<int>(v);
            const float a = u - static_cast<float>(iu), b = v - static_cast<float>(iv);
            const float* p = g.data + iv * g.side + iu;
            const float top = p[0] + a * (p[1] - p[0]);
            const float bottom = p[g.side] + a * (p[g.side + 1] - p[g.side]);
            height = top + b * (bottom - top);
            return true;
        }
        return false;
    }
    [[nodiscard]] size_t size() const { return grids_.size(); }
    [[nodiscard]] const Grid& grid(size_t i) const { return grids_[i]; }
    [[nodiscard]] float highest_m() const { return highest_m_; }

  private:
    std::vector<Grid> grids_;
    float highest_m_;
};

/// Sun visibility at half resolution (264 x 264, texel (0, 0) covers cells -8 and -7), 0..1. The sun is drawn 1.4
/// degrees wide: soft penumbrae.
void bake_sun(const HeightChain& chain, double cell_m, const SunDirection& sun, std::vector<float>& visibility);

/// Sky visibility at half resolution: 8 directions, 5 distances.
void bake_sky(const HeightChain& chain, double cell_m, std::vector<float>& visibility);

} // namespace sahel
