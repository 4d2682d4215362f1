#pragma once

#include "tools/experiments/dune_run.h"

/// Pictures of runs from above: relief shaded from the north-west, sand on rock, plants, objects.
namespace sahel::experiments {

/// A relief of one material, coloured by height.
Image relief_picture(const Plane& height_m);
/// The ground of a run: rock grey, thin sand between rock and sand, plants green, objects red.
Image ground_picture(const DuneRun& run);
/// Values over a shaded relief, from blue (low) over white to red (high).
Image value_picture(const Plane& height_m, const Plane& values, double low, double high);

} // namespace sahel::experiments
