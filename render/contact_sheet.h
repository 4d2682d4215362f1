#pragma once

#include "render/png_io.h"
#include "world/result.h"

#include <array>
#include <memory>
#include <string>
#include <vector>

/// Text and several pictures on one: captions drawn by the processor, without GL.
namespace sahel {

using PixelColour = std::array<uint8_t, 4>;

/// Letters of one size, made once.
class TextPainter {
  public:
    explicit TextPainter(float size_px);
    ~TextPainter();
    TextPainter(const TextPainter&) = delete;
    TextPainter& operator=(const TextPainter&) = delete;

    /// Top left corner of the first line at (x, y); what lies outside the picture is cut. RGB or RGBA pictures.
    void draw(Image& image, int x, int y, const std::string& utf8, PixelColour colour) const;
    [[nodiscard]] int width_px(const std::string& utf8) const;
    [[nodiscard]] int line_px() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Averages the pixels of each new one (box filter, in linear light).
Image shrink_image(const Image& image, int width_px, int height_px);

struct ContactSheetItem {
    const Image* image = nullptr; ///< RGB or RGBA
    std::string caption;
};
struct ContactSheetOptions {
    int columns = 2;
    int cell_width_px = 640; ///< pictures are made as wide as this and keep their shape
    int gap_px = 12;
    std::string title;
    PixelColour paper{24, 24, 26, 255};
    PixelColour ink{232, 228, 218, 255};
};
/// Pictures row by row, each with its caption of one or more lines below. Errors: usage (no picture, no pixels).
Result<Image> make_contact_sheet(const std::vector<ContactSheetItem>& items, const ContactSheetOptions& options = {});

} // namespace sahel
