#pragma once

#include "render/view_tile.h"

#include <vector>

/// The one noise texture of the renderer: 512 x 512, periodic, RGBA8. R, G: gradient (0.5 is none), B: fractal sum of
/// six octaves, A: ridged sum. Shaders fetch it at several sizes, each turned by another angle, so that no repeat
/// shows.
namespace sahel {

inline constexpr int k_noise_texels = 512;

/// Level 0, rows from the top.
std::vector<Rgba8> make_noise_texture();

} // namespace sahel
