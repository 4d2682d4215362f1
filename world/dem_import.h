#pragma once

#include "world/dem_cover.h"
#include "world/dem_source.h"
#include "world/world.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Elevation models become worlds.
///
///     files --open--> sheets --resample--> heights + mask --fill--> --sea--> --cover--> tiles --commit--> world
///                     (windows)            (scratch rasters as large as the data, on disk)    (batches)
///
/// Heights: the surface (bedrock + soil + sand, and water on the sea) of a cell is the height of the file minus the
/// datum, to the tick. Cell (0, 0) is the north-west corner of the data, x east, y south. Around the data lies a skirt
/// of `edge_cells` cells, in which the ground runs from the rim to the plain around the world; its cells and the
/// corners that no file covers have k_mask_outside.
///
/// Memory: about `memory_bytes`, whatever the size of the files; disk: at most 13 bytes of scratch per cell beside the
/// world while the import runs. The world is built in `WORLD.importing-PID` and renamed at the end: after an error
/// there is no trace of it, and WORLD is what it was.
namespace sahel {

struct DemImportOptions {
    DemSourceOptions source;         ///< raw layout, range, no data, band, coordinate system (datum_m below counts)
    double cell_m = 0.0;             ///< side of the world's cells; 0: that of the finest file
    double datum_m = 0.0;            ///< height of the files that becomes 0 in the world
    std::optional<double> sea_m;     ///< sea level, as a height of the files
    double shelf_m = 60.0;           ///< greatest depth of a sea bed that has to be made up, m
    std::optional<double> outside_m; ///< plain around the data, as a height of the files; default: near the lowest rim
    int64_t edge_cells = -1;         ///< width of the skirt; -1: by the relief, at most 256 and a tile; 0: none
    int tile_cells = 512;
    std::string name; ///< of the world; empty: that of the folder
    DemCoverParams cover;
    uint64_t memory_bytes = uint64_t{512} << 20;
};

struct DemFileReport {
    std::filesystem::path path;
    std::string format, type;
    int64_t width = 0, height = 0;
    double min_m = 0.0, max_m = 0.0; ///< heights of the file itself; min > max: nothing but no data
};

struct DemImportReport {
    std::vector<DemFileReport> files;
    GeoReference georeference;
    std::string projection_name; ///< empty: none
    int64_t width = 0, height = 0;
    double cell_m = 1.0;
    double min_m = 0.0, max_m = 0.0; ///< heights of the files' datum, before filling and sea bed
    int64_t filled_cells = 0;        ///< no data inside a file, drawn in from the rim
    int64_t uncovered_cells = 0;     ///< inside the data's rectangle, in no file
    int64_t sea_cells = 0;
    bool made_up_sea_bed = false;
    double outside_m = 0.0; ///< height of the plain around, in the world
    int64_t tiles = 0;
    std::vector<std::string> notes;
    double seconds = 0.0;
};

/// Called now and then with what is done ("reading", "filling", "sea", "writing") and the fraction of it; false stops
/// the import with an error.
using DemProgress = std::function<bool(std::string_view stage, double fraction)>;

/// Where the tiles go.
class DemSink {
  public:
    virtual ~DemSink() = default;
    virtual Status begin(const WorldDesc& desc) = 0;
    virtual Status commit(std::span<const TileUpdate> tiles) = 0;
};

/// Makes the world of the files. Errors: usage (options, a world that is not empty, 8-bit or 0..1 heights without a
/// range), not_found, corrupt (broken, cut short, infinite or absurd heights, no data at all), budget (disk or memory
/// too small for it), io. One line each; the world is untouched.
Result<DemImportReport> import_dem(const std::filesystem::path& world, std::span<const std::filesystem::path> files,
                                   const DemImportOptions& options, const DemProgress& progress = {});

/// The same into any sink; scratch rasters lie in `scratch`, which must exist.
Result<DemImportReport> import_dem_tiles(DemSink& sink, const std::filesystem::path& scratch,
                                         std::span<const std::filesystem::path> files, const DemImportOptions& options,
                                         const DemProgress& progress = {});

} // namespace sahel
