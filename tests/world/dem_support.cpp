#include "tests/world/dem_support.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfVecAttribute.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <unistd.h>

namespace sahel::dem_test {

namespace fs = std::filesystem;

TempFolder::TempFolder() {
    std::string name = (fs::temp_directory_path() / "sahel-dem-XXXXXX").string();
    SAHEL_CHECK(::mkdtemp(name.data()) != nullptr);
    path_ = name;
}
TempFolder::~TempFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

Grid::Grid(int w, int hgt, const std::function<double(int, int)>& f) : width(w), height(hgt) {
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) h.push_back(f(x, y));
}

void write_gdal(const fs::path& path, const std::string& driver, const std::string& type, const Grid& grid,
                const GridPlace& place, std::optional<double> nodata, int bands) {
    GDALAllRegister();
    const GDALDataType data_type = GDALGetDataTypeByName(type.c_str());
    GDALDriver* want = GetGDALDriverManager()->GetDriverByName(driver.c_str());
    ASSERT_NE(want, nullptr) << driver;
    const bool direct = want->GetMetadataItem(GDAL_DCAP_CREATE) != nullptr;
    GDALDriver* maker = direct ? want : GetGDALDriverManager()->GetDriverByName("MEM");
    GDALDataset* made = maker->Create(path.c_str(), grid.width, grid.height, bands, data_type, nullptr);
    ASSERT_NE(made, nullptr);
    if (place.placed) {
        double t[6] = {place.x, place.cell_x, 0, place.y, 0, place.cell_y};
        made->SetGeoTransform(t);
        if (!place.crs.empty()) {
            OGRSpatialReference crs;
            crs.SetFromUserInput(place.crs.c_str());
            crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
            made->SetSpatialRef(&crs);
        }
    }
    std::vector<double> values = grid.h;
    for (double& v : values)
        if (std::isnan(v) && nodata) v = *nodata;
    for (int b = 1; b <= bands; ++b) {
        if (nodata) made->GetRasterBand(b)->SetNoDataValue(*nodata);
        ASSERT_EQ(made->GetRasterBand(b)->RasterIO(GF_Write, 0, 0, grid.width, grid.height, values.data(), grid.width,
                                                   grid.height, GDT_Float64, 0, 0, nullptr),
                  CE_None);
    }
    if (!direct) GDALClose(want->CreateCopy(path.c_str(), made, FALSE, nullptr, nullptr, nullptr));
    GDALClose(made);
}

void write_bytes(const fs::path& path, std::span<const uint8_t> bytes) {
    std::ofstream out(path, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}
std::vector<uint8_t> read_bytes(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void write_raw16(const fs::path& path, const Grid& grid, bool big_endian) {
    std::vector<uint8_t> bytes;
    for (const double h : grid.h) {
        const auto v = static_cast<uint16_t>(std::isnan(h) ? -32768 : static_cast<int>(std::lround(h)));
        const auto hi = static_cast<uint8_t>(v >> 8), lo = static_cast<uint8_t>(v & 255);
        bytes.push_back(big_endian ? hi : lo);
        bytes.push_back(big_endian ? lo : hi);
    }
    write_bytes(path, bytes);
}
void write_hgt(const fs::path& path, const Grid& grid) {
    write_raw16(path, grid, true);
}

void write_exr(const fs::path& path, const Grid& grid, const std::string& channel, float cell_m) {
    Imf::Header header(grid.width, grid.height);
    header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
    header.insert("cellSize", Imf::V2fAttribute({cell_m, cell_m}));
    header.compression() = Imf::ZIP_COMPRESSION;
    std::vector<float> values(grid.h.begin(), grid.h.end());
    Imf::FrameBuffer frame;
    frame.insert(channel, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float),
                                     sizeof(float) * static_cast<size_t>(grid.width)));
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(frame);
    file.writePixels(grid.height);
}

Status MemorySink::commit(std::span<const TileUpdate> updates) {
    ++commits;
    for (const TileUpdate& u : updates) {
        EXPECT_FALSE(tiles.contains(u.key)) << "a tile came twice";
        u.block->layers().for_each([&](Layer layer) {
            const auto view = u.block->ints(layer);
            auto& cells = tiles[u.key][layer];
            for (int y = 0; y < desc.tile_cells; ++y)
                cells.insert(cells.end(), view.row(y), view.row(y) + desc.tile_cells);
        });
    }
    return {};
}

int32_t MemorySink::ticks(Layer layer, int64_t x, int64_t y) const {
    const TileKey key = tile_of({x, y}, 0, desc.tile_cells);
    const auto tile = tiles.find(key);
    SAHEL_CHECK(tile != tiles.end());
    const auto column = tile->second.find(layer);
    if (column == tile->second.end()) return 0;
    return column
        ->second[static_cast<size_t>(floor_mod(y, desc.tile_cells) * desc.tile_cells + floor_mod(x, desc.tile_cells))];
}
int32_t MemorySink::surface_ticks(int64_t x, int64_t y) const {
    return ticks(Layer::bedrock, x, y) + ticks(Layer::soil, x, y) + ticks(Layer::sand, x, y);
}
std::vector<int32_t> MemorySink::all(const CellRect& rect) const {
    std::vector<int32_t> out;
    for (const Layer layer : {Layer::bedrock, Layer::soil, Layer::sand, Layer::water, Layer::mask})
        for (int64_t y = rect.y0; y < rect.y1; ++y)
            for (int64_t x = rect.x0; x < rect.x1; ++x) out.push_back(ticks(layer, x, y));
    return out;
}

Imported import_files(const std::vector<fs::path>& files, DemImportOptions options) {
    const TempFolder scratch;
    Imported out;
    out.report = import_dem_tiles(out.sink, scratch.path(), files, options);
    EXPECT_TRUE(fs::is_empty(scratch.path())) << "scratch files stayed behind";
    return out;
}

DemImportOptions plain_options() {
    DemImportOptions options;
    options.tile_cells = 128;
    options.edge_cells = 0;
    options.name = "test";
    options.memory_bytes = uint64_t{64} << 20;
    return options;
}

fs::path sample_dem(const std::string& name) {
    return fs::path(SAHEL_SOURCE_DIR) / ".." / "shared" / "data" / "dem" / name;
}

} // namespace sahel::dem_test
