#pragma once

#include "streaming/node_pool.h"
#include "streaming/view_geometry.h"

#include <array>
#include <cmath>
#include <vector>

/// What a view wants, whatever is there. CDLOD (Strugar 2010) over tiles: the quadrant of a tile, a square of side s,
/// is drawn from its child where its distance is below lod_factor s; lod_factor > sqrt 2 keeps neighbours within one
/// level. lod_factor_for (streamer.h) says what that means in pixels.
///
///     +-----------+-----------+      one tile of level k: four quadrants, each either drawn from this tile
///     |     |     |           |      or replaced by the child of level k - 1 that covers it
///     |  child 0  |quadrant 1 |
///     |     |     |           |      Roots: every tile of root_level within root_radius of the eye's own, and, so that
///     +-----------+-----------+      they are there in time, those that come next within 1/16 of a root's side.
///     |quadrant 2 |quadrant 3 |
///     +-----------+-----------+
namespace sahel {

struct Want {
    WantGroup group;
    float cost; ///< distance over side, the inverse of the error seen: coarse and near first
    TileKey key;
    uint32_t slot; ///< in the pool, k_no_slot when it is not there
};

/// The total order of requests: group, cost, coarse before fine, key. A parent always stands before its children.
bool goes_before(const Want& a, const Want& b);

struct HeightRange {
    float low, high;
};

class Selector {
  public:
    Selector(const StreamSettings& settings, double cell_m);

    [[nodiscard]] double side_m(int level) const { return side_m_[static_cast<size_t>(level)]; }
    [[nodiscard]] GroundSquare square(TileKey key, HeightRange heights) const;
    /// The quadrant of `key` is to be drawn from its child.
    [[nodiscard]] bool wants_child(const ViewState& view, TileKey key, int quadrant) const;
    /// Heights that may be drawn within a quadrant of a tile: its own range with a margin, since a child may rise above
    /// what the coarser lattice of its parent shows, and the child's where that is known.
    [[nodiscard]] static HeightRange quadrant_heights(const NodePool& pool, HeightRange tile, double tile_side_m,
                                                      uint32_t child_slot);

    /// Calls f(root) for every root that is drawn, row by row; with `ahead` also for those that come next.
    template <class F> void for_each_root(const ViewState& view, bool ahead, F&& f) const {
        const double side = side_m(settings_.root_level);
        const double more = ahead ? side / 16.0 : 0.0;
        const auto at = [&](double v) { return static_cast<int64_t>(std::floor(v / side)); };
        const int64_t r = settings_.root_radius;
        for (int64_t y = at(view.eye_m[1] - more) - r; y <= at(view.eye_m[1] + more) + r; ++y)
            for (int64_t x = at(view.eye_m[0] - more) - r; x <= at(view.eye_m[0] + more) + r; ++x)
                f(TileKey{settings_.root_level, x, y});
    }

    /// Appends everything `view` wants; heights come from the pool where a node is resident, else from its ancestors.
    /// `prefetch`: all of it belongs to that group.
    void collect(const ViewState& view, const NodePool& pool, bool prefetch, std::vector<Want>& wants) const;

  private:
    struct Walk;
    const StreamSettings& settings_;
    std::array<double, 21> side_m_{}; ///< by level
    double lod_factor2_;
};

} // namespace sahel
