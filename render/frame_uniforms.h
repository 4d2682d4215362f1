#pragma once

#include "render/renderer.h"

#include <glm/glm.hpp>

#include <array>

/// What every shader knows of a frame, from the view, the air and the look.
namespace sahel {

inline constexpr int k_ripple_directions = 24;  ///< that ripples of a simulated wind may have; as in common.glsl
inline constexpr int k_contour_directions = 12; ///< that streaks are laid out along, in half a turn; as there

/// The uniform block of common.glsl: matrices and vec4 only, so std140 and C++ agree.
struct FrameUniforms {
    glm::mat4 view_projection, inverse_view_projection;
    glm::vec4 eye, lod, sun, sun_light, light_up, light_side, light_ground, haze, screen, wind, look, rock;
    std::array<glm::vec4, 4> noise_phase;
    glm::vec4 wall_phase, grain_phase;
    std::array<glm::vec4, k_contour_directions / 4> contour_phase;
    std::array<glm::vec4, k_ripple_directions / 2> ripple_phase;
    glm::ivec4 mode;
};
static_assert(sizeof(FrameUniforms) ==
              2 * 64 + 12 * 16 + 6 * 16 + k_contour_directions / 4 * 16 + k_ripple_directions / 2 * 16 + 16);

/// The block of one jittered sample of a picture. Where patterns of the ground are is computed in double, relative to
/// the eye: they stay in place a million kilometres away.
FrameUniforms frame_uniforms(const RendererDesc& desc, const Atmosphere& atmosphere, const SkyTable& table,
                             const FrameDesc& frame, int sample);

} // namespace sahel
