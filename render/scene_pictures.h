#pragma once

#include "render/field_picture.h"
#include "streaming/scene_run.h"

#include <filesystem>
#include <string>

/// What a running scene looks like, in the colours of its file.
namespace sahel {

GroundColours scene_colours(const Scene& scene);

/// The lit ground. Errors: those of reading fields.
Result<Image> make_scene_picture(const Scene& scene, const SceneRun& run, int least_side_px = 512);

/// Writes into `folder`: height.png, sand.png, shadow.png, wind.png, plants.png (where there are any), sheet.png with
/// all of them under `title`, and fields.exr with the fields as numbers (channels bedrock, soil, sand, airborne, water
/// in m; wind.x, wind.y in m/s; shadow, vegetation, object; repose as tangent). Before the first step the working
/// fields are left out. Errors: io.
Status write_scene_pictures(const std::filesystem::path& folder, const Scene& scene, const SceneRun& run,
                            const std::string& title);

} // namespace sahel
