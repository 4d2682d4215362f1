#pragma once

#include "sim/pass.h"
#include "sim/sand_params.h"

#include <cstdint>

/// The sand's passes as the step plan takes them, made from parameters.
namespace sahel {

/// One part of a step: all of it, or less where a step is longer than a hop.
struct SandPart {
    uint64_t seed = 1;
    int64_t step = 0;
    int32_t index = 0;
    float dt_s = 1.0f;
    float share = 1.0f; ///< of the airborne sand that hops: dt / hop_s, at most 1
};

/// The way of a hop, the same for every tiling: it follows from the fastest wind of the whole region.
struct HopWay {
    int32_t legs = 1;
    float cells_per_speed = 0.0f;
    float longest = 0.0f;
    static HopWay of(const SandParams& p, double cell_m, float max_wind_m_per_s);
};

int32_t shadow_samples(const SandParams& p, double cell_m);
int32_t echo_steps(const SandParams& p, double cell_m);
/// Omega of smoothing over a flat open bed in a step of dt, were it one pass: stable up to k_most_smoothing.
float smoothing_omega(const SandParams& p, double cell_m, float dt_s, float wind_m_per_s);
/// Into how many parts smoothing divides a step of dt.
int32_t smoothing_parts(const SandParams& p, double cell_m, float dt_s, float max_wind_m_per_s);

Pass ground_pass();
Pass wind_shadow_pass(const SandParams& p, double cell_m);
Pass cliff_pass(const SandParams& p, double cell_m);
Pass echo_pass(const SandParams& p, double cell_m);
Pass no_echo_pass();
Pass lift_pass(const SandParams& p, const SandPart& part);
/// Leg number i: from hopping to hopping_next, or back.
Pass hop_leg_pass(const SandParams& p, const HopWay& way, int32_t leg);
/// After `legs` legs.
Pass deposit_pass(const SandParams& p, double cell_m, const SandPart& part, int32_t legs);
Pass smooth_pass(const SandParams& p, double cell_m, float dt_s);
Pass apply_smooth_pass();
Pass repose_pass(const SandParams& p);
Pass covered_pass(const SandParams& p);
/// Adds sand (or removes it); the region is the layout's.
Pass supply_pass(const SandParams& p, uint64_t seed, int64_t step, bool remove);

} // namespace sahel
