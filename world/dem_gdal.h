#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <cpl_error.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

/// GDAL behind a quiet door: drivers registered once, messages kept instead of printed.
namespace sahel {

/// Registers the drivers; the block cache then holds at most `cache_bytes`.
void gdal_start(uint64_t cache_bytes);

/// While it lives, GDAL's and PROJ's messages of this thread land here and not on the terminal.
class GdalScope {
  public:
    GdalScope();
    ~GdalScope();
    GdalScope(const GdalScope&) = delete;
    GdalScope& operator=(const GdalScope&) = delete;

    /// The last error (a warning if there was none) as one line; `otherwise` if GDAL said nothing.
    [[nodiscard]] std::string message(const std::string& otherwise) const;

  private:
    static void handle(CPLErr kind, CPLErrorNum code, const char* text);
    std::string error_;
    std::string warning_;
};

struct GdalClose {
    void operator()(GDALDataset* d) const {
        if (d) GDALClose(GDALDataset::ToHandle(d));
    }
};
using GdalDataset = std::unique_ptr<GDALDataset, GdalClose>;

/// Coordinate system of a WKT or of any text PROJ knows ("EPSG:32611"), horizontal part only, x = east. False: not one.
bool gdal_crs(const std::string& text, OGRSpatialReference& crs);

} // namespace sahel
