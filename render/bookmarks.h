#pragma once

#include "render/camera.h"
#include "world/result.h"

#include <filesystem>
#include <string>
#include <vector>

/// Places worth coming back to, kept as JSON beside a world:
///
///     { "format": 1, "bookmarks": [ { "name": "north shore", "position_m": [120.5, -3010, 322.1], "yaw_deg": 85,
///                                     "pitch_deg": -4, "vertical_fov_deg": 50 } ] }
namespace sahel {

struct Bookmark {
    std::string name;
    CameraPose pose;
};

inline constexpr size_t k_max_bookmarks = 1000;

/// Strict. Errors: not_found, corrupt, usage (naming file and key), unsupported (a newer format).
Result<std::vector<Bookmark>> load_bookmarks(const std::filesystem::path& file);
Status save_bookmarks(const std::filesystem::path& file, const std::vector<Bookmark>& bookmarks);

/// Puts a pose at place 1 .. 9 of the list (the first free place if the list is shorter), keeping the name there.
/// Returns the index.
size_t set_bookmark(std::vector<Bookmark>& bookmarks, int digit, const CameraPose& pose);

} // namespace sahel
