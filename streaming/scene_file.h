#pragma once

#include "sim/sand_params.h"
#include "sim/wind_params.h"
#include "streaming/scene_species.h"
#include "streaming/scene_terrain.h"
#include "streaming/scene_values.h"
#include "world/result.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

/// The scene files that the authors of Desertscape (Nilles et al., GRAPP 2024, and its follow-up) and of Oasis
/// published: read as they are, and translated into the parameters of this program.
///
///     JSON text --parse--> SceneValues, generators, species --translate--> WindParams, SandParams, notes
///
/// What a file says per step becomes a rate, so that one step of fixedDeltaTime * timeScale moves what the published
/// rule moves:
///
///     saltationStrength, stickyStrength    m/step      divided by the step
///     reptationStrength                    s/m2        times the step (it meets a rate of bounced sand)
///     reptationSmoothingStrength, k_r                  as they are
///     abrasionStrength                                 as it is; by amount in files of 2023, not so later
///     windWarpingDivisor                               its reciprocal
///     venturiStrength                      1/m         with heights above the datum (venturi_radius_m = 0)
///     avalancheIterations                              as many sweeps; whatever the scheme of the file is called
///
/// Nothing that differs from the published program is passed over in silence: `notes` says it, one line each.
namespace sahel {

enum class SceneFormat : uint8_t { dunes_2023, dunes_2025, oasis };
std::string_view scene_format_name(SceneFormat format);

struct SceneLayers {
    SceneNoise bedrock{.flat = false, .scale = 100.0f};
    SceneNoise sand{.bias = 10.0f};
    SceneNoise vegetation;
    SceneNoise resistance;
    SceneNoise soil;     ///< Oasis
    SceneNoise water;    ///< Oasis: an absolute level
    SceneNoise moisture; ///< Oasis
};

struct Scene {
    std::string name;           ///< the file's name without its ending
    std::filesystem::path path; ///< empty if parsed from a text
    SceneFormat format = SceneFormat::dunes_2025;
    SceneValues values; ///< as read, defaults of the published program where keys are absent
    SceneLayers layers;
    std::vector<SceneSpecies> species;
    std::vector<std::string> ignored; ///< keys that were read past: of the viewer, of schemes not offered, unknown
    std::vector<std::string> notes;   ///< where the run differs from the published program, one line each

    WindParams wind;
    SandParams sand;
    double cell_m = 1.0;
    double step_s = 1.0;
};

/// Errors: corrupt (no JSON), usage (a missing, mistyped or unusable value: `where`, the key, its range).
Result<Scene> parse_scene(std::string_view text, std::string_view where);
/// Errors: not_found, io, and those of parse_scene.
Result<Scene> load_scene(const std::filesystem::path& file);

namespace detail {
/// Fills wind, sand and notes from the values. Errors: usage.
Status translate_scene(Scene& scene, std::string_view where);
} // namespace detail

} // namespace sahel
