#pragma once

#include "world/dem_import.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// Small elevation files made by the tests, and a world that is nothing but tiles in memory.
namespace sahel::dem_test {

/// A fresh folder, removed at the end.
class TempFolder {
  public:
    TempFolder();
    ~TempFolder();
    TempFolder(const TempFolder&) = delete;
    TempFolder& operator=(const TempFolder&) = delete;
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  private:
    std::filesystem::path path_;
};

struct Grid {
    int width = 0, height = 0;
    std::vector<double> h; ///< NaN: no data
    Grid() = default;
    Grid(int w, int hgt, const std::function<double(int, int)>& f);
    [[nodiscard]] double at(int x, int y) const {
        return h[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
    }
};

struct GridPlace {
    double x = 500000.0, y = 4000000.0; ///< north-west corner
    double cell_x = 1.0, cell_y = -1.0;
    std::string crs = "EPSG:32611"; ///< empty: none
    bool placed = true;
};

/// Any GDAL driver that can create or copy ("GTiff", "AAIGrid", "PNG"); `type` is GDAL's name, for example "Float32".
void write_gdal(const std::filesystem::path& path, const std::string& driver, const std::string& type, const Grid& grid,
                const GridPlace& place = {}, std::optional<double> nodata = {}, int bands = 1);
/// 1201 x 1201 big-endian Int16; NaN becomes -32768.
void write_hgt(const std::filesystem::path& path, const Grid& grid);
void write_raw16(const std::filesystem::path& path, const Grid& grid, bool big_endian);
void write_exr(const std::filesystem::path& path, const Grid& grid, const std::string& channel, float cell_m);
void write_bytes(const std::filesystem::path& path, std::span<const uint8_t> bytes);
std::vector<uint8_t> read_bytes(const std::filesystem::path& path);

/// Keeps every tile, and can be asked for cells.
class MemorySink final : public DemSink {
  public:
    Status begin(const WorldDesc& d) override {
        desc = d;
        return {};
    }
    Status commit(std::span<const TileUpdate> updates) override;

    [[nodiscard]] int32_t ticks(Layer layer, int64_t x, int64_t y) const;
    [[nodiscard]] int32_t surface_ticks(int64_t x, int64_t y) const; ///< ground, without water
    [[nodiscard]] double surface_m(int64_t x, int64_t y) const { return surface_ticks(x, y) / 131072.0; }
    [[nodiscard]] int32_t mask(int64_t x, int64_t y) const { return ticks(Layer::mask, x, y); }
    /// Every layer of every cell of the rectangle, in world order.
    [[nodiscard]] std::vector<int32_t> all(const CellRect& rect) const;

    WorldDesc desc;
    std::map<TileKey, std::map<Layer, std::vector<int32_t>>> tiles;
    int commits = 0;
};

/// Imports into a MemorySink with a scratch folder of its own; the folder must be empty again afterwards.
struct Imported {
    MemorySink sink;
    Result<DemImportReport> report = Error{};
};
Imported import_files(const std::vector<std::filesystem::path>& files, DemImportOptions options);
/// Small tiles, no skirt: what most tests want.
DemImportOptions plain_options();

/// "dem" folder of the sample data beside the repository.
std::filesystem::path sample_dem(const std::string& name);

} // namespace sahel::dem_test
