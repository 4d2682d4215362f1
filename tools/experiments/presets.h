#pragma once

#include "tools/experiments/dune_run.h"

/// Parameters and grounds that several experiments share.
namespace sahel::experiments {

/// One wind over level ground: neither warped nor growing with height.
WindParams plain_wind(float speed_m_per_s, float angle_deg);
/// The wind of the published scenes of 2023: venturi above the datum, warped by both scales, not projected.
WindParams published_wind(float speed_m_per_s, float angle_deg = 0.0f);
/// The sand of the published scenes of 2023: a fixed count of sweeps, all of full strength, smoothing k_r for each step
/// of one second.
SandParams published_sand(int sweeps, float smoothing);
/// Loose sand everywhere, uniform noise between two thicknesses.
Ground noisy_sheet(double least_m, double most_m, uint64_t seed = 1);

} // namespace sahel::experiments
