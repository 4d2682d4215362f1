#pragma once

#include "world/result.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

/// Named planes of numbers as one OpenEXR picture: single part, scan lines, row 0 first. For maps that accompany a
/// scene and for fields that are handed to other programs; tiles of a world have their own form (exr_tile.h).
namespace sahel {

struct ExrPlane {
    std::string name; ///< the channel, for example "R" or "wind.x"
    std::vector<float> values;
};

struct ExrImage {
    int32_t width = 0;
    int32_t height = 0;
    std::vector<ExrPlane> planes;

    /// The plane of that name, or null.
    [[nodiscard]] const std::vector<float>* find(std::string_view name) const;
};

/// No side of a picture is longer: what a header claims is not believed before memory is taken.
inline constexpr int32_t k_exr_image_max_side = 16384;

/// Every HALF, FLOAT or UINT channel as floats, whatever the order of channels and lines in the file. Errors:
/// not_found, corrupt (cut short, damaged, not a picture), unsupported (deep, subsampled, tiled in levels, too large).
Result<ExrImage> read_exr_image(const std::filesystem::path& path);

/// FLOAT channels, ZIP compression. Written aside and renamed. Errors: usage (no planes, a plane of a wrong size), io.
Status write_exr_image(const std::filesystem::path& path, const ExrImage& image);

} // namespace sahel
