#include "world/dem_source.h"

#include "world/layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace sahel {

namespace fs = std::filesystem;

namespace {

constexpr double k_height_limit_m = 16384.0 - 1.0; // int32 ticks end at 16384 m

std::string lower_extension(const fs::path& path) {
    std::string e = path.extension().string();
    std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return e;
}

} // namespace

namespace detail {

void dem_scaling(const std::optional<DemRange>& range, double stored_lo, double stored_hi, double& scale,
                 double& offset) {
    if (!range) return;
    scale = (range->hi_m - range->lo_m) / (stored_hi - stored_lo);
    offset = range->lo_m - stored_lo * scale;
}

} // namespace detail

Status DemSource::read(const CellRect& window, double* out) {
    SAHEL_CHECK(!window.empty() && (CellRect{0, 0, info_.width, info_.height}.contains(window)));
    SAHEL_TRY(read_samples(window, out));
    const int64_t width = window.width();
    const int64_t count = window.area();
    const double bad_lo = options_.datum_m - k_height_limit_m;
    const double bad_hi = options_.datum_m + k_height_limit_m;
    for (int64_t i = 0; i < count; ++i) {
        const double stored = out[i];
        if (std::isnan(stored)) continue;
        const double h = stored * scale_ + offset_;
        const bool outside_unit = unit_range_ && !(stored >= -1e-6 && stored <= 1.0 + 1e-6);
        if (outside_unit || !(h >= bad_lo && h <= bad_hi)) {
            const std::string place =
                fmt::format("{}: column {}, row {}", info_.path.string(), window.x0 + i % width, window.y0 + i / width);
            if (outside_unit)
                return Error{
                    ErrorKind::usage,
                    fmt::format("{} holds {}, but a range maps 0..1: leave the range out, or normalise the file", place,
                                stored)};
            return Error{ErrorKind::corrupt,
                         fmt::format("{} holds {} m, beyond +-16 km of the datum {} m; if it means no data, name it "
                                     "(--nodata {})",
                                     place, h, options_.datum_m, stored)};
        }
        min_m_ = std::min(min_m_, h);
        max_m_ = std::max(max_m_, h);
        out[i] = h;
    }
    return {};
}

Result<std::unique_ptr<DemSource>> open_dem(const fs::path& path, const DemSourceOptions& options) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status))
        return Error{ErrorKind::not_found, fmt::format("{}: no such elevation file", path.string())};
    if (fs::is_directory(status))
        return Error{ErrorKind::usage, fmt::format("{} is a folder: name the elevation files in it", path.string())};
    const uintmax_t bytes = fs::file_size(path, error);
    if (!error && bytes == 0) return Error{ErrorKind::corrupt, fmt::format("{} is empty (0 bytes)", path.string())};
    if (options.range && !(options.range->lo_m < options.range->hi_m))
        return Error{ErrorKind::usage, fmt::format("the range {}..{} m is empty: give the lower height first",
                                                   options.range->lo_m, options.range->hi_m)};
    const std::string e = lower_extension(path);
    if (e == ".exr") return detail::open_dem_exr(path, options);
    if (e == ".raw" || e == ".r16" || e == ".r32" || e == ".r8") return detail::open_dem_raw(path, options);
    return detail::open_dem_gdal(path, options);
}

} // namespace sahel
