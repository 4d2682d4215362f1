#pragma once

#include "streaming/node_pool.h"
#include "streaming/view_geometry.h"

#include <vector>

/// What a view wants, whatever is there: the quadtree is refined where a quadrant lies nearer than lod_factor of its
/// sides. With cells of c metres, a tile of n cells and a pixel of angle a, a refined cell is seen under at most
/// 1 / (lod_factor n / 2 a) pixels: 1.4 at lod_factor 2.1, 512 cells and 50 degrees over 720 lines.
namespace sahel {

struct Want {
    WantGroup group;
    float cost; ///< distance over side: coarse and near first
    TileKey key;
};

/// The total order of requests: group, cost, coarse before fine, key. A parent always stands before its children.
bool goes_before(const Want& a, const Want& b);

struct HeightRange {
    float low, high;
};

class Selector {
  public:
    Selector(const StreamSettings& settings, double cell_m) : settings_(settings), cell_m_(cell_m) {}

    [[nodiscard]] GroundSquare square(TileKey key, HeightRange heights) const;
    [[nodiscard]] TileKey root_of(const ViewState& view) const;
    /// The quadrant of `key` is to be drawn from its child.
    [[nodiscard]] bool wants_child(const ViewState& view, TileKey key, int quadrant) const;

    /// Appends everything `view` wants; heights come from the pool where a node is resident, else from its ancestors.
    /// `prefetch`: all of it belongs to that group.
    void collect(const ViewState& view, const NodePool& pool, bool prefetch, std::vector<Want>& wants) const;

  private:
    struct Walk;
    const StreamSettings& settings_;
    double cell_m_;
};

} // namespace sahel
