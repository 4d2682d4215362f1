#pragma once

#include "world/result.h"
#include "world/tile_key.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

/// One elevation file, read window by window in metres.
///
/// GDAL reads what it knows (GeoTIFF, HGT, ASCII grid, PNG, ...), OpenEXR reads EXR (Debian's GDAL has no driver for
/// it), and files without a header (.raw, .r16, .r32) are read as they lie. All three answer the same questions, so the
/// rest of the import does not know which it was.
namespace sahel {

/// The layout of a file of bare samples. Width and height 0: the square that the size of the file allows.
struct RawLayout {
    int64_t width = 0;
    int64_t height = 0;
    int bits = 0; ///< 8, 16 or 32; 0: 32 for .r32, 8 for .r8, else 16
    bool is_signed = false;
    bool is_float = false; ///< 32 bits only; .r32 without a layout is float
    bool big_endian = false;
    int64_t header_bytes = 0; ///< skipped at the start
};

/// Height of the least and the greatest stored value, m: for 8-bit and normalised (0..1) files.
struct DemRange {
    double lo_m = 0.0;
    double hi_m = 1.0;
};

/// How samples become metres.
struct DemSourceOptions {
    RawLayout raw;
    std::optional<DemRange> range;
    std::optional<double> nodata;        ///< stored value that means "nothing here", besides what the file says
    int band = 1;                        ///< counted from 1
    std::string crs;                     ///< coordinate system of files that name none, for example "EPSG:32611"
    std::optional<double> source_cell_m; ///< cell side of files that do not say, m
    double datum_m = 0.0;                ///< only to refuse heights beyond +-16 km of it
};

struct DemSourceInfo {
    std::filesystem::path path;
    std::string format; ///< "GTiff", "SRTMHGT", "EXR", "RAW", ...
    std::string type;   ///< "Int16", "Float32", ...
    int64_t width = 0;
    int64_t height = 0;
    /// X = t[0] + col t[1] + row t[2], Y = t[3] + col t[4] + row t[5]; (0, 0) is the corner of the first sample's cell.
    std::array<double, 6> transform{0, 1, 0, 0, 0, -1};
    bool placed = false;        ///< the file says where it lies
    bool whole_numbers = false; ///< stored as integers
    std::string projection_wkt; ///< empty: none
};

class DemSource {
  public:
    virtual ~DemSource() = default;

    [[nodiscard]] const DemSourceInfo& info() const { return info_; }

    /// Heights in metres of columns and rows `window`, row after row; NaN where there is no data. The window lies
    /// inside. Errors: corrupt (cannot be decoded, infinite, beyond +-16 km, outside the range), io.
    Status read(const CellRect& window, double* out);

    /// Frees file handles; the next read opens again.
    virtual void close() = 0;

    /// Least and greatest height read so far, m (least > greatest: none).
    [[nodiscard]] double min_m() const { return min_m_; }
    [[nodiscard]] double max_m() const { return max_m_; }

  protected:
    /// Stored values as doubles; NaN for no data.
    virtual Status read_samples(const CellRect& window, double* out) = 0;

    DemSourceInfo info_;
    DemSourceOptions options_;
    double scale_ = 1.0;      ///< metres per stored unit
    double offset_ = 0.0;     ///< metres at stored 0
    bool unit_range_ = false; ///< stored values must be 0..1

  private:
    double min_m_ = 1e300;
    double max_m_ = -1e300;
};

/// Opens any of them. Errors: not_found, usage (a directory, 8-bit without a range, a wrong size), corrupt, io.
Result<std::unique_ptr<DemSource>> open_dem(const std::filesystem::path& path, const DemSourceOptions& options);

namespace detail {
Result<std::unique_ptr<DemSource>> open_dem_gdal(const std::filesystem::path& path, const DemSourceOptions& options);
Result<std::unique_ptr<DemSource>> open_dem_exr(const std::filesystem::path& path, const DemSourceOptions& options);
Result<std::unique_ptr<DemSource>> open_dem_raw(const std::filesystem::path& path, const DemSourceOptions& options);
/// Linear map of stored values [stored_lo, stored_hi] to the range; without a range the values are metres.
void dem_scaling(const std::optional<DemRange>& range, double stored_lo, double stored_hi, double& scale,
                 double& offset);
} // namespace detail

} // namespace sahel
