#include "world/dem_gdal.h"
#include "world/dem_source.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

namespace sahel {

namespace fs = std::filesystem;

namespace {

/// Metres per unit of a band's heights; 0 for a unit that is no length known here.
double metres_per_unit(std::string unit) {
    for (char& c : unit) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (unit.empty() || unit == "m" || unit == "metre" || unit == "meter" || unit == "metres" || unit == "meters")
        return 1.0;
    if (unit == "ft" || unit == "foot" || unit == "feet" || unit == "international foot") return 0.3048;
    if (unit == "us survey foot" || unit == "us-ft" || unit == "ftus" || unit == "foot_us") return 1200.0 / 3937.0;
    if (unit == "cm") return 0.01;
    if (unit == "dm") return 0.1;
    if (unit == "km") return 1000.0;
    return 0.0;
}

class GdalSource final : public DemSource {
  public:
    Status open_first(const fs::path& path, const DemSourceOptions& options);
    void close() override { dataset_.reset(); }

  protected:
    Status read_samples(const CellRect& window, double* out) override;

  private:
    Status reopen();
    [[nodiscard]] Error error(ErrorKind kind, const std::string& what) const {
        return {kind, fmt::format("{}: {}", info_.path.string(), what)};
    }

    GdalDataset dataset_;
    std::optional<double> file_nodata_;
    bool use_mask_ = false;
    std::vector<GByte> mask_;
};

Status GdalSource::reopen() {
    if (dataset_) return {};
    GdalScope scope;
    dataset_.reset(
        GDALDataset::Open(info_.path.string().c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR));
    if (dataset_) return {};
    return error(ErrorKind::corrupt, scope.message("not a raster file that GDAL can read"));
}

Status GdalSource::open_first(const fs::path& path, const DemSourceOptions& options) {
    info_.path = path;
    options_ = options;
    SAHEL_TRY(reopen());
    GdalScope scope;
    info_.format = dataset_->GetDriverName();
    info_.width = dataset_->GetRasterXSize();
    info_.height = dataset_->GetRasterYSize();
    const int bands = dataset_->GetRasterCount();
    if (bands == 0 || info_.width <= 0 || info_.height <= 0)
        return error(ErrorKind::corrupt, "holds no raster band (a container? name one of its parts)");
    if (options.band < 1 || options.band > bands)
        return error(ErrorKind::usage, fmt::format("has {} band(s), there is no band {}", bands, options.band));
    GDALRasterBand* band = dataset_->GetRasterBand(options.band);
    const GDALDataType type = band->GetRasterDataType();
    info_.type = GDALGetDataTypeName(type);
    if (GDALDataTypeIsComplex(type)) return error(ErrorKind::usage, "complex numbers are no heights");
    if (band->GetColorInterpretation() == GCI_PaletteIndex || band->GetColorTable())
        return error(ErrorKind::usage, "a picture with a colour palette is no elevation model");
    info_.whole_numbers = GDALDataTypeIsInteger(type) != 0;

    int has = 0;
    const double nodata = band->GetNoDataValue(&has);
    if (has) file_nodata_ = nodata;
    const int mask_flags = band->GetMaskFlags();
    use_mask_ = (mask_flags & (GMF_ALL_VALID | GMF_NODATA)) == 0;

    scale_ = band->GetScale();
    offset_ = band->GetOffset();
    const double unit = metres_per_unit(band->GetUnitType());
    if (unit == 0.0)
        return error(ErrorKind::usage,
                     fmt::format("heights in '{}': only metres and feet are known", band->GetUnitType()));
    scale_ *= unit;
    offset_ *= unit;
    if (type == GDT_Byte && !options.range)
        return error(ErrorKind::usage,
                     "8-bit values say nothing about metres: give the heights of 0 and 255 (--range LO,HI)");
    if (options.range) {
        double lo = 0.0, hi = 1.0;
        switch (type) {
        case GDT_Byte:
            hi = 255.0;
            break;
        case GDT_UInt16:
            hi = 65535.0;
            break;
        case GDT_Int16:
            lo = -32768.0, hi = 32767.0;
            break;
        case GDT_UInt32:
            hi = 4294967295.0;
            break;
        case GDT_Int32:
            lo = -2147483648.0, hi = 2147483647.0;
            break;
        default:
            unit_range_ = true;
        }
        detail::dem_scaling(options.range, lo, hi, scale_, offset_);
    }

    std::array<double, 6> t{};
    if (dataset_->GetGeoTransform(t.data()) == CE_None) {
        for (const double v : t)
            if (!std::isfinite(v)) return error(ErrorKind::corrupt, "its georeference is not finite");
        if (t[1] * t[5] - t[2] * t[4] == 0.0) return error(ErrorKind::corrupt, "its georeference has cells of no area");
        info_.transform = t;
        info_.placed = true;
        const OGRSpatialReference* found = dataset_->GetSpatialRef();
        OGRSpatialReference crs;
        if (found) {
            crs = *found;
            if (crs.IsCompound()) crs.StripVertical();
        } else if (!options.crs.empty() && !gdal_crs(options.crs, crs)) {
            return error(ErrorKind::usage, fmt::format("'{}' is no coordinate system that PROJ knows", options.crs));
        }
        if (!crs.IsEmpty()) {
            char* wkt = nullptr;
            const char* how[] = {"FORMAT=WKT2_2019", nullptr};
            if (crs.exportToWkt(&wkt, how) == OGRERR_NONE && wkt) info_.projection_wkt = wkt;
            CPLFree(wkt);
        }
    } else {
        const double cell = options.source_cell_m.value_or(1.0);
        info_.transform = {0, cell, 0, 0, 0, -cell};
    }
    return {};
}

Status GdalSource::read_samples(const CellRect& window, double* out) {
    SAHEL_TRY(reopen());
    GdalScope scope;
    GDALRasterBand* band = dataset_->GetRasterBand(options_.band);
    const int x = static_cast<int>(window.x0), y = static_cast<int>(window.y0);
    const int w = static_cast<int>(window.width()), h = static_cast<int>(window.height());
    if (band->RasterIO(GF_Read, x, y, w, h, out, w, h, GDT_Float64, 0, 0, nullptr) != CE_None)
        return error(ErrorKind::corrupt, fmt::format("rows {}..{} cannot be read: {}", y, y + h - 1,
                                                     scope.message("the file is broken or cut short")));
    const int64_t count = window.area();
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    // A Float32 file states its no-data value in double: compare as the file stores it.
    const bool as_float = band->GetRasterDataType() == GDT_Float32;
    for (const std::optional<double>& nodata : {file_nodata_, options_.nodata}) {
        if (!nodata || std::isnan(*nodata)) continue;
        const double value = as_float ? static_cast<double>(static_cast<float>(*nodata)) : *nodata;
        for (int64_t i = 0; i < count; ++i)
            if (out[i] == value || out[i] == *nodata) out[i] = nan;
    }
    if (use_mask_) {
        mask_.resize(static_cast<size_t>(count));
        if (band->GetMaskBand()->RasterIO(GF_Read, x, y, w, h, mask_.data(), w, h, GDT_Byte, 0, 0, nullptr) != CE_None)
            return error(ErrorKind::corrupt,
                         fmt::format("its mask cannot be read: {}", scope.message("unknown reason")));
        for (int64_t i = 0; i < count; ++i)
            if (mask_[static_cast<size_t>(i)] == 0) out[i] = nan;
    }
    return {};
}

} // namespace

Result<std::unique_ptr<DemSource>> detail::open_dem_gdal(const fs::path& path, const DemSourceOptions& options) {
    auto source = std::make_unique<GdalSource>();
    SAHEL_TRY(source->open_first(path, options));
    return std::unique_ptr<DemSource>(std::move(source));
}

} // namespace sahel
