#include "tools/experiments/presets.h"

namespace sahel::experiments {

WindParams plain_wind(float speed_m_per_s, float angle_deg) {
    WindParams wind;
    wind.speed_m_per_s = speed_m_per_s;
    wind.angle_deg = angle_deg;
    wind.venturi_per_m = 0.0f;
    wind.warp = false;
    wind.project = false;
    return wind;
}

WindParams published_wind(float speed_m_per_s, float angle_deg) {
    WindParams wind;
    wind.speed_m_per_s = speed_m_per_s;
    wind.angle_deg = angle_deg;
    wind.venturi_radius_m = 0.0f;
    wind.project = false;
    return wind;
}

SandParams published_sand(int sweeps, float smoothing) {
    SandParams sand;
    sand.avalanche_sweeps = sweeps;
    sand.reptation_smooth = smoothing;
    return sand;
}

Ground noisy_sheet(double least_m, double most_m, uint64_t seed) {
    Ground ground;
    ground.sand_m = [=](int32_t x, int32_t y) { return least_m + (most_m - least_m) * cell_noise(seed, x, y); };
    return ground;
}

} // namespace sahel::experiments
