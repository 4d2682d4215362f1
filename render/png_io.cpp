#include "render/png_io.h"

#include "world/file_io.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstring>

namespace sahel {

template <class T> void BasicImage<T>::flip_rows() {
    const size_t n = row_elements();
    for (int y = 0; y < height_px / 2; ++y) {
        T* a = pixels.data() + static_cast<size_t>(y) * n;
        T* b = pixels.data() + static_cast<size_t>(height_px - 1 - y) * n;
        std::swap_ranges(a, a + n, b);
    }
}
template struct BasicImage<uint8_t>;
template struct BasicImage<uint16_t>;

namespace {

constexpr uint32_t k_max_side_px = 32768;

// libpng leaves by longjmp: everything that owns memory lives outside the functions that it can leave.
struct PngTrouble {
    char what[160] = {};
};

void on_png_error(png_structp png, png_const_charp what) {
    auto* trouble = static_cast<PngTrouble*>(png_get_error_ptr(png));
    std::strncpy(trouble->what, what, sizeof trouble->what - 1);
    png_longjmp(png, 1);
}
void on_png_warning(png_structp, png_const_charp) {}

void append_bytes(png_structp png, png_bytep data, size_t size) {
    auto* out = static_cast<std::vector<uint8_t>*>(png_get_io_ptr(png));
    out->insert(out->end(), data, data + size);
}
void no_flush(png_structp) {}

struct ByteSource {
    const uint8_t* next;
    size_t left;
};
void take_bytes(png_structp png, png_bytep data, size_t size) {
    auto* source = static_cast<ByteSource*>(png_get_io_ptr(png));
    if (source->left < size) png_error(png, "the file ends too early");
    std::memcpy(data, source->next, size);
    source->next += size;
    source->left -= size;
}

struct WriteJob {
    int width, height, channels, bits, level;
    png_text* text;
    int text_count;
    png_bytep* rows;
    std::vector<uint8_t>* out;
};

bool run_write(png_structp png, png_infop info, const WriteJob& job) {
    if (setjmp(png_jmpbuf(png))) return false; // NOLINT: libpng's way
    png_set_write_fn(png, job.out, append_bytes, no_flush);
    const int type = job.channels == 1   ? PNG_COLOR_TYPE_GRAY
                     : job.channels == 3 ? PNG_COLOR_TYPE_RGB
                                         : PNG_COLOR_TYPE_RGB_ALPHA;
    png_set_IHDR(png, info, static_cast<png_uint_32>(job.width), static_cast<png_uint_32>(job.height), job.bits, type,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_compression_level(png, job.level);
    // One filter: choosing per row costs more time than it saves bytes at level 1.
    if (job.level <= 2) png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    if (job.text_count > 0) png_set_text(png, info, job.text, job.text_count);
    png_write_info(png, info);
    if (job.bits == 16 && std::endian::native == std::endian::little) png_set_swap(png);
    png_write_image(png, job.rows);
    png_write_end(png, nullptr);
    return true;
}

template <class T> Result<std::vector<uint8_t>> encode(const BasicImage<T>& image, const PngText& text, int level) {
    if (image.width_px <= 0 || image.height_px <= 0)
        return Error{ErrorKind::usage, fmt::format("picture of {} x {} pixels", image.width_px, image.height_px)};
    if (image.channels != 1 && image.channels != 3 && image.channels != 4)
        return Error{ErrorKind::usage, fmt::format("a PNG has 1, 3 or 4 channels, not {}", image.channels)};
    SAHEL_CHECK_EQ(image.pixels.size(), image.row_elements() * static_cast<size_t>(image.height_px));
    for (const auto& [key, value] : text)
        if (key.empty() || key.size() > 79)
            return Error{ErrorKind::usage, fmt::format("PNG text key '{}' must have 1 to 79 characters", key)};

    std::vector<uint8_t> out;
    std::vector<png_bytep> rows;
    for (int y = 0; y < image.height_px; ++y)
        rows.push_back(reinterpret_cast<png_bytep>(const_cast<T*>(image.at(0, y)))); // libpng only reads them
    std::vector<png_text> chunks;
    for (const auto& [key, value] : text) {
        png_text chunk{};
        chunk.compression = PNG_ITXT_COMPRESSION_NONE;
        chunk.key = const_cast<char*>(key.c_str());
        chunk.text = const_cast<char*>(value.c_str());
        chunk.itxt_length = value.size();
        chunks.push_back(chunk);
    }
    PngTrouble trouble;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &trouble, on_png_error, on_png_warning);
    png_infop info = png ? png_create_info_struct(png) : nullptr;
    if (!info) {
        png_destroy_write_struct(&png, nullptr);
        return Error{ErrorKind::budget, "no memory for the PNG encoder"};
    }
    const WriteJob job{image.width_px,
                       image.height_px,
                       image.channels,
                       static_cast<int>(8 * sizeof(T)),
                       level,
                       chunks.data(),
                       static_cast<int>(chunks.size()),
                       rows.data(),
                       &out};
    const bool ok = run_write(png, info, job);
    png_destroy_write_struct(&png, &info);
    if (!ok) return Error{ErrorKind::io, fmt::format("PNG encoder: {}", trouble.what)};
    return out;
}

bool read_header(png_structp png, png_infop info, ByteSource* source) {
    if (setjmp(png_jmpbuf(png))) return false; // NOLINT
    png_set_read_fn(png, source, take_bytes);
    png_set_user_limits(png, k_max_side_px, k_max_side_px);
    png_read_info(png, info);
    png_set_expand(png);
    png_set_scale_16(png);
    if (png_get_color_type(png, info) == PNG_COLOR_TYPE_GRAY_ALPHA) png_set_gray_to_rgb(png);
    if (png_get_color_type(png, info) == PNG_COLOR_TYPE_GRAY && png_get_valid(png, info, PNG_INFO_tRNS))
        png_set_gray_to_rgb(png);
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
    return true;
}
bool read_rows(png_structp png, png_infop info, png_bytep* rows) {
    if (setjmp(png_jmpbuf(png))) return false; // NOLINT
    png_read_image(png, rows);
    png_read_end(png, info);
    return true;
}

bool decode(png_structp png, png_infop info, ByteSource& source, PngFile& file) {
    if (!read_header(png, info, &source)) return false;
    file.image = Image(static_cast<int>(png_get_image_width(png, info)),
                       static_cast<int>(png_get_image_height(png, info)), png_get_channels(png, info));
    std::vector<png_bytep> rows;
    for (int y = 0; y < file.image.height_px; ++y) rows.push_back(file.image.at(0, y));
    if (!read_rows(png, info, rows.data())) return false;
    png_textp chunks = nullptr;
    int count = 0;
    png_get_text(png, info, &chunks, &count);
    for (int i = 0; i < count; ++i) file.text.emplace_back(chunks[i].key, chunks[i].text ? chunks[i].text : "");
    return true;
}

} // namespace

Result<std::vector<uint8_t>> encode_png(const Image& image, const PngText& text, int level) {
    return encode(image, text, level);
}
Result<std::vector<uint8_t>> encode_png(const Image16& image, const PngText& text, int level) {
    return encode(image, text, level);
}

namespace {
template <class T>
Status write_image(const std::filesystem::path& path, const BasicImage<T>& image, const PngText& text, int level) {
    SAHEL_ASSIGN(const std::vector<uint8_t> bytes, encode(image, text, level));
    return write_file(path, bytes);
}
} // namespace

Status write_png(const std::filesystem::path& path, const Image& image, const PngText& text, int level) {
    return write_image(path, image, text, level);
}
Status write_png(const std::filesystem::path& path, const Image16& image, const PngText& text, int level) {
    return write_image(path, image, text, level);
}

Result<PngFile> read_png(const std::filesystem::path& path) {
    SAHEL_ASSIGN(const std::vector<uint8_t> bytes, read_file(path));
    const auto corrupt = [&](std::string_view what) {
        return Error{ErrorKind::corrupt, fmt::format("{}: not a whole PNG: {}", path.string(), what)};
    };
    if (bytes.size() < 8 || png_sig_cmp(bytes.data(), 0, 8) != 0) return corrupt("the signature is missing");
    PngTrouble trouble;
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &trouble, on_png_error, on_png_warning);
    png_infop info = png ? png_create_info_struct(png) : nullptr;
    if (!info) {
        png_destroy_read_struct(&png, nullptr, nullptr);
        return Error{ErrorKind::budget, "no memory for the PNG decoder"};
    }
    PngFile file;
    ByteSource source{bytes.data(), bytes.size()};
    const bool ok = decode(png, info, source, file);
    png_destroy_read_struct(&png, &info, nullptr);
    if (!ok) return corrupt(trouble.what);
    return file;
}

} // namespace sahel
