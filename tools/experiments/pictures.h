#pragma once

#include "tools/experiments/dune_run.h"

#include <string>

/// Pictures of runs from above, by render/field_picture.h.
namespace sahel::experiments {

/// A relief of one material.
Image relief_picture(const Plane& height_m);
/// The ground of a run: rock, sand, plants, objects.
Image ground_picture(const DuneRun& run);
/// Values in colours with a scale: around 0 from blue to red, else from dark to bright.
Image value_picture(const Plane& values, double low, double high, const std::string& title, const std::string& unit);

} // namespace sahel::experiments
