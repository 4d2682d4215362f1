#pragma once

#include "world/surface_source.h"

#include <cstdint>
#include <list>
#include <unordered_map>
#include <vector>

/// Heights at single points of a SurfaceSource, for cameras and searches: blocks of cells are read when first needed
/// and the last few hundred are kept. Owner thread only.
namespace sahel {

struct GroundSample {
    double ground_m = 0.0; ///< rock + soil + sand
    double water_m = 0.0;  ///< depth of water above it
    double sand_m = 0.0;
    [[nodiscard]] double surface_m() const { return ground_m + water_m; }
};

class GroundSampler {
  public:
    /// Samples cells of `level`: 2^level cells of level 0 across, so the result is smooth at that scale.
    GroundSampler(const SurfaceSource& source, int32_t level);

    /// Bilinear between cell centres at world metres (x east, y south). A source that fails gives the last good value
    /// nearby (zero at first): cameras go on.
    [[nodiscard]] GroundSample at(double x_m, double y_m);
    [[nodiscard]] double surface_m(double x_m, double y_m) { return at(x_m, y_m).surface_m(); }

    [[nodiscard]] double cell_m() const { return cell_m_; }

  private:
    struct Block {
        std::vector<float> ground_m, water_m, sand_m; ///< k_side^2
    };
    static constexpr int k_side = 64;
    static constexpr size_t k_max_blocks = 512; // 24 MiB

    const Block& block(TileKey key);
    [[nodiscard]] GroundSample cell(int64_t x, int64_t y);

    const SurfaceSource& source_;
    int32_t level_;
    double cell_m_;
    std::list<std::pair<TileKey, Block>> blocks_; ///< most recently used first
    std::unordered_map<TileKey, std::list<std::pair<TileKey, Block>>::iterator> index_;
};

} // namespace sahel
