#pragma once

#include "world/result.h"

#include <cstdint>
#include <string_view>

/// Programs from the shader sources that are built into the library (render/shaders/).
namespace sahel {

/// Text of a built-in shader file; empty when there is none of that name.
std::string_view shader_source(std::string_view name);

/// Compiles and links `vertex` and `fragment` behind common.glsl (and `shared`, if given). Our own sources: a failure
/// is our bug and aborts with the driver's log.
uint32_t link_program(std::string_view vertex, std::string_view fragment, std::string_view shared = {});

} // namespace sahel
