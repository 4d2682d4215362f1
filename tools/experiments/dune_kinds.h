#pragma once

#include "tools/experiments/dune_run.h"

/// The kinds of dunes of experiment `dunes`: each runs, judges itself into the report and adds its picture.
namespace sahel::experiments {

/// Part of the work: from `share` on, over `part`.
struct Stretch {
    double share = 0.0;
    double part = 1.0;
};

// By wind and supply alone.
Status barchans(const Setup& setup, Stretch work, Report& report);
Status transverse_dunes(const Setup& setup, Stretch work, Report& report);
Status linear_dunes(const Setup& setup, Stretch work, Report& report);
Status star_dunes(const Setup& setup, Stretch work, Report& report);
// By what stands in the way.
Status nabkhas(const Setup& setup, Stretch work, Report& report);
Status echo_dune(const Setup& setup, Stretch work, Report& report);
Status dunes_round_obstacle(const Setup& setup, Stretch work, Report& report);

/// An obstacle as in the published scenes, scaled: a half disc of `radius` cells whose nose looks against a wind along
/// +x, then a block of the same width of `length` cells (Desertscape method 4.6).
struct Obstacle {
    int32_t centre_x = 0;
    int32_t centre_y = 0;
    int32_t radius = 0;
    int32_t length = 0;
    [[nodiscard]] bool holds(int32_t x, int32_t y, int32_t rim = 0) const;
};

} // namespace sahel::experiments
