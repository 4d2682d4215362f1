#include "sim/reptation.h"
#include "sim/sand_passes.h"
#include "streaming/scene_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sahel {

namespace {

void translate_wind(const SceneValues& v, Scene& scene) {
    WindParams& w = scene.wind;
    w.speed_m_per_s = v.wind_speed;
    w.angle_deg = std::fmod(v.wind_angle, 360.0f);
    w.bidirectional = v.bidirectional;
    w.strength_based = v.bidirectional_strength_based;
    w.second_angle_deg = std::fmod(v.second_wind_angle, 360.0f);
    w.ratio = v.bidirectional_r;
    w.period_s = v.bidirectional_base_time;
    w.venturi_per_m = v.venturi_strength;
    w.venturi_radius_m = 0.0f;
    w.warp = v.warping_mode == "Standard" && v.warping_count > 0;
    w.warp_count = v.warping_count;
    w.warp_gain = 1.0f / v.warping_divisor;
    float* radii[] = {&w.warp_radius_1_m, &w.warp_radius_2_m, &w.warp_radius_3_m, &w.warp_radius_4_m};
    float* weights[] = {&w.warp_weight_1, &w.warp_weight_2, &w.warp_weight_3, &w.warp_weight_4};
    float* strengths[] = {&w.warp_strength_1_m_per_s, &w.warp_strength_2_m_per_s, &w.warp_strength_3_m_per_s,
                          &w.warp_strength_4_m_per_s};
    for (size_t g = 0; g < 4; ++g) {
        if (static_cast<int>(g) < v.warping_count) *radii[g] = v.warping_radii[g]; // unused ones are 0 in files
        *weights[g] = v.warping_strengths[g];
        *strengths[g] = v.warping_gradient_strengths[g];
    }
    w.project = v.projection_mode != 0 && scene.format != SceneFormat::dunes_2023;
    w.epoch_steps = 1; // the published program solves the wind in every step
}

void translate_sand(const SceneValues& v, Scene& scene) {
    const auto dt = static_cast<float>(scene.step_s);
    const bool old = scene.format == SceneFormat::dunes_2023;
    const bool oasis = scene.format == SceneFormat::oasis;
    SandParams& s = scene.sand;
    s.step_s = dt;
    s.hop_s = dt;
    s.shadow_curved = v.shadow_mode == "Curved";
    s.shadow_length_m = v.shadow_distance;
    s.shadow_min_deg = v.shadow_min_angle;
    s.shadow_max_deg = v.shadow_max_angle;
    s.echo_rate_m_per_s = oasis ? 0.0f : v.sticky_strength / dt;
    s.echo_cliff_deg = v.sticky_angle;
    s.echo_erosion_range = v.sticky_range[0];
    s.echo_sticky_range = v.sticky_range[1];
    s.echo_max_cliff_m = v.sticky_max_height;
    s.bilinear = v.bilinear;
    s.lift_rate_m_per_s = v.saltation_strength / dt;
    s.bounce_threshold_m = oasis ? v.abrasion_threshold : 0.0f;
    s.abrasion = v.abrasion_strength;
    s.soil_abrasion = oasis ? v.soil_abrasion_strength : 0.0f;
    s.abrasion_by_amount = old;
    s.abrasion_threshold_m = v.abrasion_threshold;
    const bool holds_water = oasis && v.moisture_thickness >= 1.0e-3f; // else the capacity is 0 (Oasis 1.6)
    s.moisture_capacity_m = holds_water ? v.moisture_capacity : 0.0f;
    s.moisture_depth_m = holds_water ? v.moisture_thickness : 1.0f;
    s.reptation_smooth = old ? v.reptation_strength : 0.0f;
    s.reptation_smooth_wind_s_per_m = old ? 0.0f : v.reptation_smoothing_strength;
    s.reptation_repose_s2_per_m2 = old ? 0.0f : v.reptation_strength * dt;
    s.reptation_shadowed = v.reptation_use_wind_shadow;
    s.avalanche_sweeps = v.avalanche_iterations;
    s.avalanche_strength = oasis ? 1.0f : v.avalanche_strength;
    s.avalanche_soft_every = v.avalanche_soft_modulus;
    s.avalanche_soft_last = v.avalanche_final_soft;
    s.repose_deg = v.avalanche_angle;
    s.repose_plants_deg = v.vegetation_angle;
    s.soil_sweeps = oasis ? v.soil_iterations : 0;
    s.soil_repose_deg = v.soil_angle;
    s.soil_repose_plants_deg = v.vegetation_soil_angle;
    s.bedrock_sweeps = std::max(v.bedrock_iterations, 0);
    s.bedrock_repose_deg = v.bedrock_angle;
    s.bedrock_to_sand = v.bedrock_mode != "To Bedrock";
    s.supply = v.calc_coverage && v.constant_coverage; // without the measurement the control never acts (3.3)
    s.supply_removes = v.constant_coverage_remove;
    s.supply_uniform = v.coverage_uniform;
    s.supply_target = v.target_coverage;
    s.supply_threshold_m = v.coverage_threshold;
    s.supply_add_m = v.coverage_spawn;
    s.supply_remove_m = v.coverage_subtract;
    s.supply_radius_cells = v.coverage_radius;
    s.supply_every_steps = v.spawn_steps;
}

/// A text that the published program does not know selects its fallback.
void note_text(Scene& scene, std::string_view key, const std::string& text,
               std::initializer_list<std::string_view> known, std::string_view fallback) {
    if (std::find(known.begin(), known.end(), text) == known.end())
        scene.notes.push_back(fmt::format("'{}' is the unknown text \"{}\": {} is used, as in the published program",
                                          key, text, fallback));
}

void note_differences(const SceneValues& v, Scene& scene) {
    auto& notes = scene.notes;
    const bool oasis = scene.format == SceneFormat::oasis;
    note_text(scene, "timeMode", v.time_mode, {"Fixed Delta Time", "Delta Time"}, "Fixed Delta Time");
    note_text(scene, "windWarpingMode", v.warping_mode, {"None", "Standard"}, "None");
    note_text(scene, "windShadowMode", v.shadow_mode, {"Linear", "Curved"}, "Linear");
    note_text(scene, "saltationMode", v.saltation_mode, {"Forward", "Backward", "Continuous"}, "Forward");
    note_text(scene, "bedrockAvalancheMode", v.bedrock_mode, {"To Sand", "To Bedrock"}, "To Sand");
    note_text(
        scene, "avalancheMode", v.avalanche_mode,
        {"Atomic In-Place", "Atomic Buffered", "Shared In-Place", "Mixed In-Place", "Multigrid", "Taylor", "Jacobi"},
        "Atomic In-Place");
    if (v.time_mode == "Delta Time")
        notes.emplace_back("timeMode is Delta Time: run with fixedDeltaTime, a frame's time cannot be repeated");
    if (scene.format == SceneFormat::dunes_2023 && v.reptation_strength > 0.0f)
        notes.push_back(
            fmt::format("a file of 2023: reptationStrength {} is the smoothing k_r, not the lowering of repose",
                        v.reptation_strength));
    if (v.saltation_mode == "Backward")
        notes.emplace_back("saltationMode Backward is run forward: the published backward form loses sand");
    if (!oasis && v.avalanche_mode != "Atomic In-Place")
        notes.push_back(fmt::format("avalancheMode {}: its {} iterations run as sweeps of the one scheme offered",
                                    v.avalanche_mode, v.avalanche_iterations));
    if (v.warping_mode == "Standard" && v.warping_count == 0)
        notes.emplace_back("windWarpingCount 0 leaves the wind as it is: the published program stops it");
    if (v.constant_coverage && !v.calc_coverage)
        notes.emplace_back("constantCoverage without calcCoverage is inactive, as in the published program");
    if (v.projection_mode == 1)
        notes.emplace_back("projectionMode 1 (Jacobi): divergence is removed exactly, not by so many iterations");
    if (scene.format == SceneFormat::dunes_2023) notes.emplace_back("a file of 2023: the wind is not projected");
    if (oasis) {
        notes.emplace_back("water, moisture and plants are loaded and stay as they are: only wind and sand are run");
        if (!scene.species.empty())
            notes.push_back(fmt::format("{} plant species are read; none grows yet", scene.species.size()));
        if (v.soil_abrasion_strength > 0.0f)
            notes.push_back(fmt::format("soilAbrasionStrength {} is applied: the published loader ignores it",
                                        v.soil_abrasion_strength));
    }
}

/// Smoothing that one stable pass cannot do is brought down to one: all of it, run in parts, would level a sheet before
/// its first dunes, which the published pass, oscillating, does not (method 3.10.4).
void limit_smoothing(Scene& scene) {
    SandParams& s = scene.sand;
    const float omega = smoothing_omega(s, scene.cell_m, s.step_s, scene.wind.speed_m_per_s);
    if (!(omega > k_most_smoothing)) return;
    s.reptation_smooth *= k_most_smoothing / omega;
    s.reptation_smooth_wind_s_per_m *= k_most_smoothing / omega;
    scene.notes.push_back(fmt::format("reptation would smooth {:.1f} times as much as one stable pass can, where the "
                                      "published program {}: it smooths as much as one pass can",
                                      omega / k_most_smoothing, omega > 1.66f ? "makes ripples" : "oscillates"));
}

} // namespace

Status detail::translate_scene(Scene& scene, std::string_view where) {
    const SceneValues& v = scene.values;
    scene.cell_m = v.grid_scale;
    scene.step_s = static_cast<double>(v.fixed_delta_time * v.time_scale);
    const auto usage = [&](std::string what) { return Error{ErrorKind::usage, fmt::format("{}: {}", where, what)}; };
    if (!(scene.step_s >= 1.0e-3 && scene.step_s <= 100.0))
        return usage(
            fmt::format("'fixedDeltaTime' times 'timeScale' is {} s; a step is from 0.001 to 100 s", scene.step_s));
    if (!(v.shadow_max_angle > v.shadow_min_angle))
        return usage(fmt::format("'maxWindShadowAngle' ({}) must be above 'minWindShadowAngle' ({})",
                                 v.shadow_max_angle, v.shadow_min_angle));
    if (!(v.sticky_range[1] > v.sticky_range[0]))
        return usage(fmt::format("'stickyRange[1]' ({}) must be above 'stickyRange[0]' ({})", v.sticky_range[1],
                                 v.sticky_range[0]));
    float weights = 0.0f;
    for (int g = 0; g < v.warping_count; ++g) {
        const auto i = static_cast<size_t>(g);
        weights += v.warping_strengths[i];
        if (v.warping_mode == "Standard" && !(v.warping_radii[i] >= 1.0f))
            return usage(fmt::format("'windWarpingRadii[{}]' is {}; a radius in use is from 1 to 10000 m", g,
                                     v.warping_radii[i]));
    }
    if (v.warping_mode == "Standard" && v.warping_count > 0 && !(weights > 0.0f))
        return usage("the 'windWarpingStrengths' in use add up to 0");
    for (const auto& [noise, key] : {std::pair{&scene.layers.bedrock, "Bedrock"}, std::pair{&scene.layers.sand, "Sand"},
                                     std::pair{&scene.layers.soil, "Soil"}, std::pair{&scene.layers.water, "Water"}})
        if (std::abs(noise->bias) + std::abs(noise->scale) > 12000.0f)
            return usage(fmt::format("'initializationParameters.{}' reaches {} m; heights stay within 12000 m", key,
                                     std::abs(noise->bias) + std::abs(noise->scale)));
    translate_wind(v, scene);
    translate_sand(v, scene);
    if (!scene.wind.warp)
        for (float* r : {&scene.wind.warp_radius_1_m, &scene.wind.warp_radius_2_m, &scene.wind.warp_radius_3_m,
                         &scene.wind.warp_radius_4_m})
            *r = std::max(*r, 1.0f);
    SAHEL_TRY(check_ranges(scene.wind, where, "wind"));
    SAHEL_TRY(check_ranges(scene.sand, where, "sand"));
    note_differences(v, scene);
    limit_smoothing(scene);
    return {};
}

} // namespace sahel
