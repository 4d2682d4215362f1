#pragma once

#include "tools/experiments/plane.h"

/// The earlier GPU scheme of avalanching, for comparison alone (Desertscape method 3.11.5): a cell gives a fixed share
/// of its excess over its steepest neighbour, split among the neighbours that lie below repose by their slopes.
namespace sahel::experiments {

class TaylorSlide {
  public:
    /// Heights of a sheet that is sand all through: the amount is not limited.
    TaylorSlide(Plane height_m, double repose_tangent, double strength);
    /// One race-free sweep.
    void sweep();
    [[nodiscard]] const Plane& height() const { return h_; }

  private:
    Plane h_;
    Plane next_;
    float repose_;
    float strength_;
};

} // namespace sahel::experiments
