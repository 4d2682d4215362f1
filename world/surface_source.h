#pragma once

#include "world/field.h"
#include "world/result.h"

/// Where the cells of a world come from: the base terrain, the store, or one over the other.
namespace sahel {

class SurfaceSource {
  public:
    virtual ~SurfaceSource() = default;

    /// Fills every layer of the block, halo included, for the block's level and rectangle. Layers that the source does
    /// not know are set to zero. The result is a pure function of the world's state: neither the rectangle's place in a
    /// tile nor the order of calls changes a bit. Thread safe.
    virtual Status read(LayerBlock& block) const = 0;

    /// Side of a level 0 cell, m.
    [[nodiscard]] virtual double cell_m() const = 0;
};

} // namespace sahel
