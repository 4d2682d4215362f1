#include "world/dem_source.h"

#include <fmt/format.h>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <OpenEXR/openexr.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <vector>

namespace sahel {

namespace fs = std::filesystem;

namespace {

constexpr int64_t k_band_bytes = int64_t{256} << 20; // decoded rows kept at once

/// Scan lines are decoded in whole rows: the last band of rows is kept, because windows come row of windows by row.
class ExrSource final : public DemSource {
  public:
    Status open_first(const fs::path& path, const DemSourceOptions& options);
    void close() override {
        file_.reset();
        band_ = {};
        band_y0_ = band_y1_ = 0;
    }

  protected:
    Status read_samples(const CellRect& window, double* out) override;

  private:
    [[nodiscard]] Error error(ErrorKind kind, const std::string& what) const {
        std::string line = fmt::format("{}: {}", info_.path.string(), what);
        std::replace(line.begin(), line.end(), '\n', ' ');
        return {kind, line};
    }
    Status check_header();
    Status read_band(int64_t y0, int64_t y1);

    std::unique_ptr<Imf::InputFile> file_;
    std::string channel_;
    int64_t first_column_ = 0, first_row_ = 0;
    std::vector<float> band_;
    int64_t band_y0_ = 0, band_y1_ = 0;
};

void quiet(exr_const_context_t, exr_result_t, const char*) {}

/// The C library reads the header alone, so a header that claims more rows than the file could index is refused before
/// anything is allocated for them.
Status ExrSource::check_header() {
    exr_context_initializer_t how = EXR_DEFAULT_CONTEXT_INITIALIZER;
    how.error_handler_fn = quiet;
    exr_context_t context = nullptr;
    const exr_result_t opened = exr_start_read(&context, info_.path.c_str(), &how);
    if (opened != EXR_ERR_SUCCESS) {
        exr_finish(&context);
        return error(ErrorKind::corrupt,
                     fmt::format("not an EXR file that can be read ({})", exr_get_default_error_message(opened)));
    }
    exr_attr_box2i_t window{};
    int32_t chunks = 0;
    int parts = 0;
    exr_storage_t storage = EXR_STORAGE_SCANLINE;
    exr_get_count(context, &parts);
    const bool ok = exr_get_data_window(context, 0, &window) == EXR_ERR_SUCCESS &&
                    exr_get_chunk_count(context, 0, &chunks) == EXR_ERR_SUCCESS &&
                    exr_get_storage(context, 0, &storage) == EXR_ERR_SUCCESS;
    exr_finish(&context);
    if (!ok) return error(ErrorKind::corrupt, "its header is incomplete");
    if (storage == EXR_STORAGE_DEEP_SCANLINE || storage == EXR_STORAGE_DEEP_TILED)
        return error(ErrorKind::usage, "deep EXR pictures hold no elevation model");
    std::error_code failed;
    const auto bytes = static_cast<int64_t>(fs::file_size(info_.path, failed));
    if (failed || chunks <= 0 || int64_t{chunks} * 8 > bytes)
        return error(ErrorKind::corrupt, "its header claims more than the file holds: broken or cut short");
    info_.width = int64_t{window.max.x} - window.min.x + 1;
    info_.height = int64_t{window.max.y} - window.min.y + 1;
    first_column_ = window.min.x;
    first_row_ = window.min.y;
    if (info_.width <= 0 || info_.height <= 0) return error(ErrorKind::corrupt, "its data window is empty");
    if (info_.width * 4 * 256 > k_band_bytes)
        return error(ErrorKind::unsupported,
                     fmt::format("{} columns are too many for EXR: use a tiled GeoTIFF", info_.width));
    return {};
}

Status ExrSource::open_first(const fs::path& path, const DemSourceOptions& options) {
    info_.path = path;
    options_ = options;
    SAHEL_TRY(check_header());
    try {
        file_ = std::make_unique<Imf::InputFile>(path.c_str());
        const Imf::Header& header = file_->header();
        const Imf::ChannelList& channels = header.channels();
        const auto usable = [](const Imf::Channel& c) {
            return (c.type == Imf::FLOAT || c.type == Imf::HALF) && c.xSampling == 1 && c.ySampling == 1;
        };
        if (const Imf::Channel* y = channels.findChannel("Y"); y && usable(*y)) channel_.assign(1, 'Y');
        for (auto c = channels.begin(); channel_.empty() && c != channels.end(); ++c)
            if (usable(c.channel())) channel_ = c.name();
        if (channel_.empty()) return error(ErrorKind::usage, "holds no channel of floating point heights");
        info_.type = channels[channel_.c_str()].type == Imf::HALF ? "Half" : "Float32";
        double cell_x = options.source_cell_m.value_or(1.0), cell_y = cell_x;
        if (const auto* size = header.findTypedAttribute<Imf::V2fAttribute>("cellSize");
            size && !options.source_cell_m) {
            cell_x = static_cast<double>(size->value().x);
            cell_y = static_cast<double>(size->value().y);
            if (!(cell_x > 0 && cell_y > 0 && std::isfinite(cell_x) && std::isfinite(cell_y)))
                return error(ErrorKind::corrupt, "its cellSize attribute is no size");
        }
        info_.transform = {0, cell_x, 0, 0, 0, -cell_y};
    } catch (const std::exception& e) {
        return error(ErrorKind::corrupt, e.what());
    }
    info_.format = "EXR";
    detail::dem_scaling(options.range, 0.0, 1.0, scale_, offset_);
    unit_range_ = options.range.has_value();
    return {};
}

Status ExrSource::read_band(int64_t y0, int64_t y1) {
    if ((y1 - y0) * info_.width * 4 > k_band_bytes)
        return error(ErrorKind::unsupported, "too many rows are needed at once: use a tiled GeoTIFF");
    try {
        if (!file_) file_ = std::make_unique<Imf::InputFile>(info_.path.c_str());
        band_.resize(static_cast<size_t>((y1 - y0) * info_.width));
        band_y0_ = band_y1_ = 0; // stays so if the read throws
        const auto columns = static_cast<size_t>(info_.width);
        Imf::FrameBuffer frame;
        frame.insert(channel_,
                     Imf::Slice::Make(Imf::FLOAT, band_.data(),
                                      Imath::V2i(static_cast<int>(first_column_), static_cast<int>(first_row_ + y0)),
                                      info_.width, y1 - y0, sizeof(float), sizeof(float) * columns));
        file_->setFrameBuffer(frame);
        file_->readPixels(static_cast<int>(first_row_ + y0), static_cast<int>(first_row_ + y1 - 1));
    } catch (const std::exception& e) {
        return error(ErrorKind::corrupt, fmt::format("rows {}..{} cannot be read: {}", y0, y1 - 1, e.what()));
    }
    band_y0_ = y0;
    band_y1_ = y1;
    return {};
}

Status ExrSource::read_samples(const CellRect& window, double* out) {
    if (window.y0 < band_y0_ || window.y1 > band_y1_) SAHEL_TRY(read_band(window.y0, window.y1));
    for (int64_t y = window.y0; y < window.y1; ++y) {
        const float* row = band_.data() + (y - band_y0_) * info_.width;
        for (int64_t x = window.x0; x < window.x1; ++x) {
            const auto v = static_cast<double>(row[x]);
            *out++ = options_.nodata && v == *options_.nodata ? std::nan("") : v;
        }
    }
    return {};
}

} // namespace

Result<std::unique_ptr<DemSource>> detail::open_dem_exr(const fs::path& path, const DemSourceOptions& options) {
    auto source = std::make_unique<ExrSource>();
    SAHEL_TRY(source->open_first(path, options));
    return std::unique_ptr<DemSource>(std::move(source));
}

} // namespace sahel
