#include "render/contact_sheet.h"

#include "render/ui_font.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace sahel {

/// ImGui's font atlas needs no context: letters come from it as coverage.
struct TextPainter::Impl {
    ImFontAtlas atlas;
    ImFont* font = nullptr;
    unsigned char* coverage = nullptr;
    int width = 0, height = 0;
};

TextPainter::TextPainter(float size_px) : impl_(std::make_unique<Impl>()) {
    const std::string file = ui_font_file();
    ImFontConfig config;
    config.OversampleH = config.OversampleV = 1; // drawn at whole pixels
    config.PixelSnapH = true;
    if (!file.empty()) impl_->font = impl_->atlas.AddFontFromFileTTF(file.c_str(), size_px, &config);
    if (!impl_->font) {
        config.SizePixels = size_px;
        impl_->font = impl_->atlas.AddFontDefault(&config);
    }
    impl_->atlas.GetTexDataAsAlpha8(&impl_->coverage, &impl_->width, &impl_->height);
}
TextPainter::~TextPainter() = default;

namespace {

/// Calls f for every character; letters that the font lacks become its "?".
template <class F> void for_each_character(const std::string& utf8, F&& f) {
    for (size_t i = 0; i < utf8.size();) {
        const auto lead = static_cast<unsigned char>(utf8[i]);
        const size_t length = lead < 0x80 ? 1 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
        unsigned code = length == 1 ? lead : lead & (0xFFu >> (length + 1));
        for (size_t k = 1; k < length && i + k < utf8.size(); ++k)
            code = (code << 6) | (static_cast<unsigned char>(utf8[i + k]) & 0x3Fu);
        f(static_cast<ImWchar>(code));
        i += length;
    }
}

float linear_of(uint8_t v) {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> t{};
        for (size_t i = 0; i < t.size(); ++i) {
            const float s = static_cast<float>(i) / 255.0f;
            t[i] = s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f);
        }
        return t;
    }();
    return table[v];
}

/// Lines of a caption: at its line ends, and where a line would be wider than there is room, between words.
std::vector<std::string> lines_of(const std::string& caption, const TextPainter& painter, int width_px) {
    std::vector<std::string> lines(1);
    std::string word;
    const auto end_word = [&] {
        const std::string longer = lines.back().empty() ? word : lines.back() + " " + word;
        if (!lines.back().empty() && painter.width_px(longer) > width_px)
            lines.push_back(word);
        else
            lines.back() = longer;
        word.clear();
    };
    for (const char c : caption) {
        if (c != ' ' && c != '\n')
            word += c;
        else
            end_word();
        if (c == '\n') lines.emplace_back();
    }
    end_word();
    return lines;
}

uint8_t encoded(float linear) {
    const float s = linear <= 0.0031308f ? linear * 12.92f : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
    return static_cast<uint8_t>(std::lround(std::clamp(s, 0.0f, 1.0f) * 255.0f));
}

} // namespace

int TextPainter::width_px(const std::string& utf8) const {
    float width = 0.0f;
    for_each_character(utf8, [&](ImWchar c) { width += impl_->font->FindGlyph(c)->AdvanceX; });
    return static_cast<int>(std::ceil(width));
}
int TextPainter::line_px() const {
    return static_cast<int>(std::ceil(impl_->font->FontSize));
}

void TextPainter::draw(Image& image, int x, int y, const std::string& utf8, PixelColour colour) const {
    SAHEL_CHECK(image.channels >= 3);
    auto pen = static_cast<float>(x);
    for_each_character(utf8, [&](ImWchar c) {
        const ImFontGlyph& glyph = *impl_->font->FindGlyph(c);
        const int u0 = static_cast<int>(std::lround(glyph.U0 * static_cast<float>(impl_->width)));
        const int v0 = static_cast<int>(std::lround(glyph.V0 * static_cast<float>(impl_->height)));
        const int w = static_cast<int>(std::lround((glyph.U1 - glyph.U0) * static_cast<float>(impl_->width)));
        const int h = static_cast<int>(std::lround((glyph.V1 - glyph.V0) * static_cast<float>(impl_->height)));
        const int left = static_cast<int>(std::lround(pen + glyph.X0));
        const int top = y + static_cast<int>(std::lround(glyph.Y0));
        for (int j = 0; j < h; ++j)
            for (int i = 0; i < w; ++i) {
                const int px = left + i, py = top + j;
                if (px < 0 || py < 0 || px >= image.width_px || py >= image.height_px) continue;
                const int cover = impl_->coverage[(v0 + j) * impl_->width + u0 + i] * colour[3] / 255;
                uint8_t* p = image.at(px, py);
                for (int k = 0; k < 3; ++k)
                    p[k] = static_cast<uint8_t>(p[k] + (colour[static_cast<size_t>(k)] - p[k]) * cover / 255);
                if (image.channels == 4) p[3] = static_cast<uint8_t>(std::max<int>(p[3], cover));
            }
        pen += glyph.AdvanceX;
    });
}

Image shrink_image(const Image& image, int width_px, int height_px) {
    SAHEL_CHECK(width_px > 0 && height_px > 0);
    Image out(width_px, height_px, image.channels);
    const double sx = static_cast<double>(image.width_px) / width_px;
    const double sy = static_cast<double>(image.height_px) / height_px;
    for (int y = 0; y < height_px; ++y)
        for (int x = 0; x < width_px; ++x) {
            const double x0 = x * sx, x1 = (x + 1) * sx, y0 = y * sy, y1 = (y + 1) * sy;
            std::array<double, 4> sum{};
            double weight = 0.0;
            for (int j = static_cast<int>(y0); j < std::min<double>(std::ceil(y1), image.height_px); ++j)
                for (int i = static_cast<int>(x0); i < std::min<double>(std::ceil(x1), image.width_px); ++i) {
                    const double w = (std::min<double>(x1, i + 1) - std::max<double>(x0, i)) *
                                     (std::min<double>(y1, j + 1) - std::max<double>(y0, j));
                    if (w <= 0.0) continue;
                    const uint8_t* p = image.at(i, j);
                    for (int c = 0; c < image.channels; ++c)
                        sum[static_cast<size_t>(c)] +=
                            w * (c == 3 ? p[c] / 255.0 : static_cast<double>(linear_of(p[c])));
                    weight += w;
                }
            uint8_t* p = out.at(x, y);
            for (int c = 0; c < image.channels; ++c) {
                const double mean = sum[static_cast<size_t>(c)] / weight;
                p[c] = c == 3 ? static_cast<uint8_t>(std::lround(mean * 255.0)) : encoded(static_cast<float>(mean));
            }
        }
    return out;
}

Result<Image> make_contact_sheet(const std::vector<ContactSheetItem>& items, const ContactSheetOptions& o) {
    if (items.empty()) return Error{ErrorKind::usage, "a contact sheet needs a picture"};
    if (o.columns < 1 || o.cell_width_px < 16 || o.gap_px < 0)
        return Error{ErrorKind::usage,
                     fmt::format("contact sheet of {} columns, {} pixels each", o.columns, o.cell_width_px)};
    for (const ContactSheetItem& item : items)
        if (!item.image || item.image->width_px < 1 || item.image->height_px < 1 || item.image->channels < 3)
            return Error{ErrorKind::usage, fmt::format("contact sheet: '{}' has no colour picture", item.caption)};

    const auto columns = std::min<size_t>(static_cast<size_t>(o.columns), items.size());
    const size_t rows = (items.size() + columns - 1) / columns;
    const TextPainter caption(std::max(12.0f, static_cast<float>(o.cell_width_px) / 36.0f));
    const TextPainter title(std::max(16.0f, static_cast<float>(o.cell_width_px) / 24.0f));
    const auto scaled_height = [&](const Image& image) {
        return std::max(
            1, static_cast<int>(std::lround(static_cast<double>(image.height_px) * o.cell_width_px / image.width_px)));
    };
    std::vector<std::vector<std::string>> captions;
    for (const ContactSheetItem& item : items) captions.push_back(lines_of(item.caption, caption, o.cell_width_px));
    const int width_px = o.gap_px + static_cast<int>(columns) * (o.cell_width_px + o.gap_px);
    const std::vector<std::string> title_lines = lines_of(o.title, title, width_px - 2 * o.gap_px);
    const int title_px = o.title.empty() ? 0 : static_cast<int>(title_lines.size()) * title.line_px() + o.gap_px;
    std::vector<int> row_top(rows + 1, o.gap_px + title_px);
    for (size_t r = 0; r < rows; ++r) {
        int height = 0;
        for (size_t i = r * columns; i < std::min(items.size(), (r + 1) * columns); ++i)
            height = std::max(height, scaled_height(*items[i].image) +
                                          static_cast<int>(captions[i].size()) * caption.line_px());
        row_top[r + 1] = row_top[r] + height + o.gap_px / 2 + o.gap_px;
    }

    Image sheet(width_px, row_top[rows], 4);
    for (size_t p = 0; p < sheet.pixels.size(); ++p) sheet.pixels[p] = o.paper[p % 4];
    for (size_t k = 0; k < title_lines.size(); ++k)
        title.draw(sheet, o.gap_px, o.gap_px + static_cast<int>(k) * title.line_px(), title_lines[k], o.ink);
    for (size_t i = 0; i < items.size(); ++i) {
        const Image small = shrink_image(*items[i].image, o.cell_width_px, scaled_height(*items[i].image));
        const int left = o.gap_px + static_cast<int>(i % columns) * (o.cell_width_px + o.gap_px);
        const int top = row_top[i / columns];
        for (int y = 0; y < small.height_px; ++y)
            for (int x = 0; x < small.width_px; ++x) {
                uint8_t* to = sheet.at(left + x, top + y);
                std::copy_n(small.at(x, y), 3, to);
                to[3] = 255;
            }
        for (size_t k = 0; k < captions[i].size(); ++k)
            caption.draw(sheet, left, top + small.height_px + o.gap_px / 3 + static_cast<int>(k) * caption.line_px(),
                         captions[i][k], o.ink);
    }
    return sheet;
}

} // namespace sahel
