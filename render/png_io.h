#pragma once

#include "world/result.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

/// Pictures in memory and as PNG files. Row 0 is the top row; pixels are interleaved, without padding between rows.
namespace sahel {

template <class T> struct BasicImage {
    int width_px = 0;
    int height_px = 0;
    int channels = 4; ///< 1 grey, 3 RGB, 4 RGBA
    std::vector<T> pixels;

    BasicImage() = default;
    BasicImage(int width, int height, int channel_count)
        : width_px(width), height_px(height), channels(channel_count),
          pixels(static_cast<size_t>(width) * static_cast<size_t>(height) * static_cast<size_t>(channel_count)) {}

    [[nodiscard]] size_t row_elements() const { return static_cast<size_t>(width_px) * static_cast<size_t>(channels); }
    [[nodiscard]] T* at(int x, int y) {
        return pixels.data() + static_cast<size_t>(y) * row_elements() + static_cast<size_t>(x * channels);
    }
    [[nodiscard]] const T* at(int x, int y) const {
        return pixels.data() + static_cast<size_t>(y) * row_elements() + static_cast<size_t>(x * channels);
    }
    /// OpenGL reads pictures from the bottom row up.
    void flip_rows();
};
using Image = BasicImage<uint8_t>;
using Image16 = BasicImage<uint16_t>;
extern template struct BasicImage<uint8_t>;
extern template struct BasicImage<uint16_t>;

/// Keys and values of PNG text chunks: what a picture shows, so that it can be made again. Keys: 1 to 79 characters.
using PngText = std::vector<std::pair<std::string, std::string>>;

/// zlib level: 1 is quick (a 1280x720 frame in some 30 ms) and about a tenth larger than 6.
inline constexpr int k_png_level_fast = 1;
inline constexpr int k_png_level_small = 6;

/// The bytes of a PNG file. Errors: usage (no pixels, wrong count of channels).
Result<std::vector<uint8_t>> encode_png(const Image& image, const PngText& text = {}, int level = k_png_level_fast);
Result<std::vector<uint8_t>> encode_png(const Image16& image, const PngText& text = {}, int level = k_png_level_fast);

/// Writes aside, syncs and renames: the file is whole or not there. Errors: usage, io.
Status write_png(const std::filesystem::path& path, const Image& image, const PngText& text = {},
                 int level = k_png_level_fast);
Status write_png(const std::filesystem::path& path, const Image16& image, const PngText& text = {},
                 int level = k_png_level_fast);

struct PngFile {
    Image image; ///< palettes are expanded, 16 bits are reduced to 8
    PngText text;
};
/// Errors: not_found, corrupt (truncated, not a PNG, larger than 32768 pixels a side), io.
Result<PngFile> read_png(const std::filesystem::path& path);

} // namespace sahel
