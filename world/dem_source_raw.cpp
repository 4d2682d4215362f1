#include "world/dem_source.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>
#include <vector>

namespace sahel {

namespace fs = std::filesystem;

namespace {

class RawSource final : public DemSource {
  public:
    ~RawSource() override { close_file(); }
    Status open_first(const fs::path& path, const DemSourceOptions& options);
    void close() override { close_file(); }

  protected:
    Status read_samples(const CellRect& window, double* out) override;

  private:
    void close_file() {
        if (fd_ >= 0) ::close(fd_);
        fd_ = -1;
    }
    [[nodiscard]] Error error(ErrorKind kind, const std::string& what) const {
        return {kind, fmt::format("{}: {}", info_.path.string(), what)};
    }
    [[nodiscard]] double sample(const unsigned char* p) const;

    RawLayout layout_;
    int fd_ = -1;
    std::vector<unsigned char> row_;
};

Status RawSource::open_first(const fs::path& path, const DemSourceOptions& options) {
    info_.path = path;
    options_ = options;
    layout_ = options.raw;
    const std::string e = path.extension().string();
    if (layout_.bits == 0) {
        const bool r32 = e == ".r32" || e == ".R32";
        layout_.bits = r32 ? 32 : e == ".r8" || e == ".R8" ? 8 : 16;
        layout_.is_float = layout_.is_float || r32;
    }
    const int bits = layout_.bits;
    if (bits != 8 && bits != 16 && bits != 32)
        return error(ErrorKind::usage, fmt::format("raw samples of {} bits: 8, 16 or 32 are known", bits));
    if (layout_.is_float && bits != 32) return error(ErrorKind::usage, "raw floats have 32 bits");
    if (layout_.header_bytes < 0 || layout_.width < 0 || layout_.height < 0)
        return error(ErrorKind::usage, "a raw layout has no negative sizes");

    std::error_code failed;
    const auto file_bytes = static_cast<int64_t>(fs::file_size(path, failed));
    if (failed) return error(ErrorKind::io, failed.message());
    const int64_t data_bytes = file_bytes - layout_.header_bytes;
    const int64_t sample_bytes = bits / 8;
    if (layout_.width == 0 && layout_.height == 0 && data_bytes > 0) {
        const auto side = static_cast<int64_t>(std::llround(std::sqrt(static_cast<double>(data_bytes / sample_bytes))));
        if (side > 0 && side * side * sample_bytes == data_bytes) layout_.width = layout_.height = side;
    }
    if (layout_.width == 0 || layout_.height == 0)
        return error(ErrorKind::usage, fmt::format("{} bytes are no square of {}-bit samples: give the size "
                                                   "(--raw WIDTHxHEIGHT)",
                                                   file_bytes, bits));
    const double needed =
        static_cast<double>(layout_.width) * static_cast<double>(layout_.height) * static_cast<double>(sample_bytes);
    if (needed != static_cast<double>(data_bytes))
        return error(
            ErrorKind::corrupt,
            fmt::format("{} x {} samples of {} bits take {:.0f} bytes, the file holds {}: wrong size, or cut short",
                        layout_.width, layout_.height, bits, needed, data_bytes));
    info_.format = "RAW";
    info_.type = layout_.is_float ? "Float32" : fmt::format("{}Int{}", layout_.is_signed ? "" : "U", bits);
    info_.whole_numbers = !layout_.is_float;
    info_.width = layout_.width;
    info_.height = layout_.height;
    const double cell = options.source_cell_m.value_or(1.0);
    info_.transform = {0, cell, 0, 0, 0, -cell};
    if (bits == 8 && !options.range)
        return error(ErrorKind::usage,
                     "8-bit values say nothing about metres: give the heights of 0 and 255 (--range LO,HI)");
    const double steps = std::ldexp(1.0, bits);
    if (layout_.is_float)
        detail::dem_scaling(options.range, 0.0, 1.0, scale_, offset_);
    else if (layout_.is_signed)
        detail::dem_scaling(options.range, -steps / 2, steps / 2 - 1, scale_, offset_);
    else
        detail::dem_scaling(options.range, 0.0, steps - 1, scale_, offset_);
    unit_range_ = layout_.is_float && options.range.has_value();
    return {};
}

double RawSource::sample(const unsigned char* p) const {
    const int n = layout_.bits / 8;
    uint32_t v = 0;
    for (int i = 0; i < n; ++i) v |= static_cast<uint32_t>(p[layout_.big_endian ? n - 1 - i : i]) << (8 * i);
    if (layout_.is_float) return static_cast<double>(std::bit_cast<float>(v));
    if (!layout_.is_signed) return static_cast<double>(v);
    const int shift = 32 - layout_.bits;
    return static_cast<double>(static_cast<int32_t>(v << shift) >> shift);
}

Status RawSource::read_samples(const CellRect& window, double* out) {
    if (fd_ < 0) fd_ = ::open(info_.path.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd_ < 0) return error(ErrorKind::io, std::strerror(errno));
    const int64_t sample_bytes = layout_.bits / 8;
    const auto row_bytes = static_cast<size_t>(window.width() * sample_bytes);
    row_.resize(row_bytes);
    for (int64_t y = window.y0; y < window.y1; ++y) {
        const int64_t at = layout_.header_bytes + (y * layout_.width + window.x0) * sample_bytes;
        size_t got = 0;
        while (got < row_bytes) {
            const ssize_t n = ::pread(fd_, row_.data() + got, row_bytes - got, at + static_cast<int64_t>(got));
            if (n < 0 && errno == EINTR) continue;
            if (n <= 0)
                return error(ErrorKind::io, fmt::format("row {}: {}", y, n < 0 ? std::strerror(errno) : "cut short"));
            got += static_cast<size_t>(n);
        }
        for (int64_t x = 0; x < window.width(); ++x) {
            const double v = sample(row_.data() + x * sample_bytes);
            *out++ = options_.nodata && v == *options_.nodata ? std::nan("") : v;
        }
    }
    return {};
}

} // namespace

Result<std::unique_ptr<DemSource>> detail::open_dem_raw(const fs::path& path, const DemSourceOptions& options) {
    auto source = std::make_unique<RawSource>();
    SAHEL_TRY(source->open_first(path, options));
    return std::unique_ptr<DemSource>(std::move(source));
}

} // namespace sahel
