#include "world/dem_distance.h"
#include "world/dem_fill.h"
#include "world/dem_gdal.h"
#include "world/dem_import.h"
#include "world/dem_mosaic.h"
#include "world/dem_raster.h"
#include "world/dem_resample.h"
#include "world/dem_sea.h"
#include "world/executor.h"
#include "world/field.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace sahel {

namespace fs = std::filesystem;

namespace {

constexpr uint64_t k_least_memory = uint64_t{32} << 20;
constexpr double k_scratch_bytes_per_cell = 13.0;
constexpr int64_t k_block_columns = 4096, k_block_rows = 64; // whole rows of strips and of 64-row blocks at a time
constexpr double k_ticks = static_cast<double>(k_ticks_per_m);

/// The import as it goes: rasters of the data and its skirt, cell (0, 0) of the world at (margin, margin).
class Import {
  public:
    Import(DemSink& sink, fs::path scratch, const DemImportOptions& options, const DemProgress& progress,
           DemMosaic mosaic)
        : sink_(sink), scratch_(std::move(scratch)), options_(options), progress_(progress),
          mosaic_(std::move(mosaic)) {}

    Result<DemImportReport> run();

  private:
    Status prepare();
    Status read_heights();
    Status look_at_heights();
    Status fill();
    Status shape_skirt();
    Status write_tiles();
    Status build_tile(TileKey key, const DemCover& cover, LayerBlock& block) const;

    /// 1 at the data, 0 from the end of the skirt on.
    [[nodiscard]] double skirt_weight(float distance) const {
        return skirt_ > 0 ? 1.0 - smooth(std::min(1.0, static_cast<double>(distance) / static_cast<double>(skirt_)))
                          : 0.0;
    }
    static double smooth(double t) { return t * t * (3.0 - 2.0 * t); }

    Status step(std::string_view stage, double fraction) {
        if (!progress_ || progress_(stage, fraction)) return {};
        return Error{ErrorKind::io, "the import was stopped; nothing was changed"};
    }
    /// As the store rounds the heights of a description, so that the plain and the sea go on without a step.
    [[nodiscard]] int32_t world_ticks(double file_m) const {
        return ticks_of_metres(static_cast<float>(file_m - options_.datum_m));
    }

    DemSink& sink_;
    fs::path scratch_;
    const DemImportOptions& options_;
    const DemProgress& progress_;
    DemMosaic mosaic_;
    DemImportReport report_;
    int64_t margin_ = 0;
    CellRect data_;                 ///< cells of the world
    CellRect cells_;                ///< data_ and the widest skirt: what the rasters hold
    int64_t skirt_ = 0;             ///< width of the skirt, at most margin_
    ScratchRaster<float> distance_; ///< to the data, where there is a skirt
    std::optional<DemSea> sea_;
    ScratchRaster<int32_t> ticks_;
    ScratchRaster<DemMask> mask_;
    int32_t outside_ticks_ = 0;
    std::optional<int32_t> sea_ticks_;
};

Status Import::prepare() {
    const DemTarget& target = mosaic_.target();
    margin_ = options_.edge_cells >= 0 ? options_.edge_cells : std::min(256, options_.tile_cells);
    data_ = {0, 0, target.width, target.height};
    cells_ = data_.grown(margin_);
    const double count = static_cast<double>(cells_.width()) * static_cast<double>(cells_.height());
    std::error_code failed;
    const fs::space_info space = fs::space(scratch_, failed);
    if (!failed && count * k_scratch_bytes_per_cell > static_cast<double>(space.available))
        return Error{
            ErrorKind::budget,
            fmt::format("{} x {} cells need about {:.3g} GiB of scratch in {}, which has {:.3g} GiB free: give a "
                        "larger --cell, or import a part",
                        data_.width(), data_.height(), count * k_scratch_bytes_per_cell / 1073741824.0,
                        scratch_.string(), static_cast<double>(space.available) / 1073741824.0)};
    // Rows of rasters are handled whole: a few dozen of them must fit.
    if (static_cast<double>(cells_.width()) * 256.0 > static_cast<double>(options_.memory_bytes))
        return Error{ErrorKind::budget, fmt::format("{} cells in a row need {:.3g} GiB of memory", cells_.width(),
                                                    static_cast<double>(cells_.width()) * 256.0 / 1073741824.0)};
    if (options_.sea_m) {
        if (!(std::abs(*options_.sea_m - options_.datum_m) < 16000.0))
            return Error{ErrorKind::usage,
                         fmt::format("a sea at {} m is beyond +-16 km of the datum", *options_.sea_m)};
        sea_ticks_ = world_ticks(*options_.sea_m);
    }
    SAHEL_ASSIGN(ticks_, ScratchRaster<int32_t>::create(scratch_, cells_.width(), cells_.height()));
    SAHEL_ASSIGN(mask_, ScratchRaster<DemMask>::create(scratch_, cells_.width(), cells_.height()));
    report_.projection_name = target.projection_name;
    report_.georeference = {target.projection_wkt, target.origin_x, target.origin_y,
                            target.step,           -target.step,    options_.datum_m};
    report_.width = data_.width();
    report_.height = data_.height();
    report_.cell_m = target.cell_m;
    report_.notes = mosaic_.notes();
    return {};
}

Status Import::read_heights() {
    std::vector<int32_t> ticks;
    std::vector<DemMask> mask;
    for (int64_t y = cells_.y0; y < cells_.y1; y += k_block_rows) {
        SAHEL_TRY(step("reading", static_cast<double>(y - cells_.y0) / static_cast<double>(cells_.height())));
        for (int64_t x = cells_.x0; x < cells_.x1; x += k_block_columns) {
            const CellRect block = CellRect{x, y, x + k_block_columns, y + k_block_rows}.intersected(cells_);
            ticks.resize(static_cast<size_t>(block.area()));
            mask.resize(ticks.size());
            SAHEL_TRY(
                resample_dem(mosaic_, block, options_.datum_m, options_.memory_bytes / 8, ticks.data(), mask.data()));
            const CellRect place{block.x0 + margin_, block.y0 + margin_, block.x1 + margin_, block.y1 + margin_};
            SAHEL_TRY(ticks_.write(place, ticks.data()));
            SAHEL_TRY(mask_.write(place, mask.data()));
        }
    }
    return {};
}

/// Extent, gaps, and how high the rim of the data stands.
Status Import::look_at_heights() {
    const auto width = static_cast<size_t>(cells_.width());
    std::vector<int32_t> ticks(width), rim;
    std::vector<DemMask> above(width, static_cast<DemMask>(k_mask_outside)), mask(width), below(width);
    int32_t lo = INT32_MAX, hi = INT32_MIN;
    const auto out = [](DemMask m) { return (m & k_mask_outside) != 0; };
    SAHEL_TRY(mask_.read_row(0, mask.data()));
    for (int64_t y = 0; y < cells_.height(); ++y) {
        SAHEL_TRY(ticks_.read_row(y, ticks.data()));
        if (y + 1 < cells_.height())
            SAHEL_TRY(mask_.read_row(y + 1, below.data()));
        else
            std::fill(below.begin(), below.end(), static_cast<DemMask>(k_mask_outside));
        const bool in_data = data_.contains(Cell{0, y - margin_});
        for (size_t x = 0; x < width; ++x) {
            const DemMask m = mask[x];
            if (m & k_mask_filled) ++report_.filled_cells;
            if (out(m) && in_data && data_.contains(Cell{static_cast<int64_t>(x) - margin_, 0}))
                ++report_.uncovered_cells;
            if (m != 0) continue;
            lo = std::min(lo, ticks[x]);
            hi = std::max(hi, ticks[x]);
            if (x == 0 || x + 1 == width || out(mask[x - 1]) || out(mask[x + 1]) || out(above[x]) || out(below[x]))
                rim.push_back(ticks[x]);
        }
        std::swap(above, mask);
        std::swap(mask, below);
    }
    const std::string first = mosaic_.file(0).info().path.string();
    if (lo > hi) return Error{ErrorKind::corrupt, fmt::format("{}: no cell holds a height", first)};
    report_.min_m = static_cast<double>(lo) / k_ticks + options_.datum_m;
    report_.max_m = static_cast<double>(hi) / k_ticks + options_.datum_m;
    bool normalised = !options_.source.range;
    for (size_t i = 0; i < mosaic_.file_count(); ++i) {
        const DemSource& file = mosaic_.file(i);
        const DemSourceInfo& info = file.info();
        report_.files.push_back(
            {info.path, info.format, info.type, info.width, info.height, file.min_m(), file.max_m()});
        normalised = normalised && !info.whole_numbers && file.min_m() >= 0.0 && file.max_m() <= 1.0;
    }
    if (normalised && lo < hi)
        return Error{ErrorKind::usage,
                     fmt::format("{}: all heights lie in 0..1, so they look normalised: give the heights of 0 and 1 "
                                 "(--range LO,HI; metres: --range 0,1)",
                                 first)};
    double outside_m = report_.min_m, high_rim_m = outside_m;
    if (!rim.empty()) { // a low part of the rim: valleys run out into the plain, hills end above it
        const auto part = [&](size_t tenths) {
            const auto at = rim.begin() + static_cast<std::ptrdiff_t>((rim.size() - 1) * tenths / 10);
            std::nth_element(rim.begin(), at, rim.end());
            return static_cast<double>(*at) / k_ticks + options_.datum_m;
        };
        outside_m = part(1);
        high_rim_m = part(9);
    }
    if (options_.sea_m) outside_m = std::min(outside_m, *options_.sea_m - options_.shelf_m);
    outside_m = options_.outside_m.value_or(outside_m);
    if (!(std::abs(outside_m - options_.datum_m) < 16000.0))
        return Error{ErrorKind::usage, fmt::format("a plain at {} m is beyond +-16 km of the datum", outside_m)};
    outside_ticks_ = world_ticks(outside_m);
    report_.outside_m = static_cast<double>(static_cast<float>(outside_m - options_.datum_m));
    skirt_ = margin_;
    if (options_.edge_cells < 0) // a slope of about 1 in 2 at the steepest
        skirt_ = std::clamp<int64_t>(std::llround(3.0 * (high_rim_m - outside_m) / report_.cell_m),
                                     std::min<int64_t>(32, margin_), margin_);
    return {};
}

/// Beyond the data the ground runs from what the rim suggests to the plain. Where the nearest data is sea the bed goes
/// on, so that mountains elsewhere on the rim raise no dam before it.
Status Import::shape_skirt() {
    const auto outside = [](DemMask m) { return (m & k_mask_outside) != 0; };
    SAHEL_ASSIGN(distance_, distance_to(
                                mask_, [&](DemMask m) { return !outside(m); }, scratch_));
    ScratchRaster<float> land;
    const bool coast = sea_ && sea_->cells > 0;
    if (coast) {
        SAHEL_ASSIGN(land, distance_to(
                               mask_, [](DemMask m) { return (m & (k_mask_outside | k_mask_sea)) == 0; }, scratch_));
    }
    const auto width = static_cast<size_t>(cells_.width());
    std::vector<int32_t> ticks(width);
    std::vector<DemMask> mask(width);
    std::vector<float> d(width), shore(width);
    for (int64_t y = 0; y < cells_.height(); ++y) {
        SAHEL_TRY(mask_.read_row(y, mask.data()));
        if (std::none_of(mask.begin(), mask.end(), outside)) continue;
        SAHEL_TRY(ticks_.read_row(y, ticks.data()));
        SAHEL_TRY(distance_.read_row(y, d.data()));
        if (coast) SAHEL_TRY(land.read_row(y, shore.data()));
        for (size_t x = 0; x < width; ++x) {
            if (!outside(mask[x])) continue;
            double ground = outside_ticks_ + skirt_weight(d[x]) * (static_cast<double>(ticks[x]) - outside_ticks_);
            if (coast) {
                const float offshore_m = shore[x] * static_cast<float>(report_.cell_m);
                const double bed = *sea_ticks_ - ticks_of_metres(sea_bed_depth_m(offshore_m, options_.shelf_m));
                const double to_land = static_cast<double>(shore[x]), to_data = static_cast<double>(d[x]);
                const double nearer = std::isinf(to_land) ? 1.0 : std::min(1.0, 2.0 * (to_land - to_data) / to_land);
                ground -= smooth(nearer) * std::max(0.0, ground - bed);
            }
            ticks[x] = static_cast<int32_t>(std::llround(ground));
            if (sea_ticks_ && ticks[x] < *sea_ticks_) mask[x] = static_cast<DemMask>(mask[x] | k_mask_sea);
        }
        SAHEL_TRY(ticks_.write_row(y, ticks.data()));
        SAHEL_TRY(mask_.write_row(y, mask.data()));
    }
    return {};
}

Status Import::fill() {
    const bool outside = margin_ > 0 || report_.uncovered_cells > 0;
    if (report_.filled_cells > 0 || outside) {
        SAHEL_TRY(step("filling", 0.0));
        SAHEL_TRY(fill_dem(ticks_, mask_, scratch_));
    }
    if (sea_ticks_) {
        SAHEL_TRY(step("sea", 0.0));
        SAHEL_ASSIGN(sea_, flood_sea(ticks_, mask_, *sea_ticks_, options_.shelf_m, report_.cell_m, scratch_));
        report_.sea_cells = sea_->cells;
        report_.made_up_sea_bed = sea_->made_up_bed;
    }
    if (outside) {
        SAHEL_TRY(step("filling", 0.7));
        SAHEL_TRY(shape_skirt());
    }
    return {};
}

Status Import::build_tile(TileKey key, const DemCover& cover, LayerBlock& block) const {
    const CellRect tile = tile_rect(key, options_.tile_cells);
    const CellRect around = tile.grown(cover.reach()).intersected(cells_);
    const CellRect inside = tile.intersected(cells_);
    const bool skirt = distance_.width() > 0 && (report_.uncovered_cells > 0 || !data_.contains(inside));
    const CellRect place{around.x0 + margin_, around.y0 + margin_, around.x1 + margin_, around.y1 + margin_};
    std::vector<int32_t> ground(static_cast<size_t>(around.area()));
    std::vector<DemMask> mask(ground.size());
    SAHEL_TRY(ticks_.read(place, ground.data()));
    SAHEL_TRY(mask_.read(place, mask.data()));
    std::vector<float> distance(skirt ? ground.size() : 0);
    if (skirt) SAHEL_TRY(distance_.read(place, distance.data()));
    std::vector<int32_t> soil(static_cast<size_t>(inside.area())), sand(soil.size());
    cover.estimate(around, ground.data(), mask.data(), inside, soil.data(), sand.data());
    const auto bedrock = block.ints(Layer::bedrock), soils = block.ints(Layer::soil), sands = block.ints(Layer::sand),
               water = block.ints(Layer::water), masks = block.ints(Layer::mask);
    const bool plain_is_sea = sea_ticks_ && outside_ticks_ < *sea_ticks_;
    for (int32_t y = 0; y < options_.tile_cells; ++y)
        for (int32_t x = 0; x < options_.tile_cells; ++x) {
            const Cell cell{tile.x0 + x, tile.y0 + y};
            int32_t surface = outside_ticks_, soil_ticks = 0, sand_ticks = 0;
            int32_t bits = k_mask_outside | (plain_is_sea ? k_mask_sea : 0);
            if (inside.contains(cell)) {
                const auto i = static_cast<size_t>((cell.y - around.y0) * around.width() + (cell.x - around.x0));
                const auto j = static_cast<size_t>((cell.y - inside.y0) * inside.width() + (cell.x - inside.x0));
                surface = ground[i];
                soil_ticks = soil[j];
                sand_ticks = sand[j];
                bits = mask[i];
                if (skirt && (bits & k_mask_outside)) { // the plain around is bare
                    const double keep = skirt_weight(distance[i]);
                    soil_ticks = static_cast<int32_t>(soil_ticks * keep);
                    sand_ticks = static_cast<int32_t>(sand_ticks * keep);
                }
            }
            soils(x, y) = soil_ticks;
            sands(x, y) = sand_ticks;
            bedrock(x, y) = surface - soil_ticks - sand_ticks;
            water(x, y) = (bits & k_mask_sea) ? *sea_ticks_ - surface : 0;
            masks(x, y) = bits;
        }
    return {};
}

Status Import::write_tiles() {
    WorldDesc desc;
    desc.name = options_.name;
    desc.preset = "none";
    desc.tile_cells = options_.tile_cells;
    desc.cell_m = report_.cell_m;
    desc.outside_m = report_.outside_m;
    if (sea_ticks_) desc.sea_m = static_cast<double>(static_cast<float>(*options_.sea_m - options_.datum_m));
    desc.georeference = report_.georeference;
    SAHEL_TRY(sink_.begin(desc));

    const DemCover cover(options_.cover, report_.cell_m, sea_ticks_);
    const LayerSet layers{Layer::bedrock, Layer::soil, Layer::sand, Layer::water, Layer::mask};
    std::vector<TileKey> keys;
    for_each_tile(data_.grown(skirt_), 0, options_.tile_cells, [&](TileKey key) { keys.push_back(key); });
    const int64_t side = options_.tile_cells + 2 * cover.reach();
    const uint64_t tile_bytes = LayerBlock::bytes_needed(tile_rect(keys[0], options_.tile_cells), 0, layers) +
                                static_cast<uint64_t>(side * side) * (4 + 1 + 4 + 8 + 8 + 8);
    const uint64_t batch = std::max<uint64_t>(1, options_.memory_bytes / 2 / tile_bytes);
    for (size_t first = 0; first < keys.size(); first += batch) {
        SAHEL_TRY(step("writing", static_cast<double>(first) / static_cast<double>(keys.size())));
        const size_t count = std::min<size_t>(batch, keys.size() - first);
        std::vector<LayerBlock> blocks;
        for (size_t i = 0; i < count; ++i) {
            SAHEL_ASSIGN(auto block,
                         LayerBlock::allocate(0, tile_rect(keys[first + i], options_.tile_cells), 0, layers));
            blocks.push_back(std::move(block));
        }
        std::vector<Status> done(count);
        for_each_index("dem/tiles", static_cast<int64_t>(count), [&](int64_t index) {
            const auto i = static_cast<size_t>(index);
            done[i] = build_tile(keys[first + i], cover, blocks[i]);
        });
        std::vector<TileUpdate> updates(count);
        for (size_t i = 0; i < count; ++i) {
            SAHEL_TRY(done[i]);
            updates[i] = {keys[first + i], &blocks[i]};
        }
        SAHEL_TRY(sink_.commit(updates));
        report_.tiles += static_cast<int64_t>(count);
    }
    return step("writing", 1.0);
}

Result<DemImportReport> Import::run() {
    const auto start = std::chrono::steady_clock::now();
    SAHEL_TRY(prepare());
    SAHEL_TRY(read_heights());
    SAHEL_TRY(look_at_heights());
    SAHEL_TRY(fill());
    SAHEL_TRY(write_tiles());
    report_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return std::move(report_);
}

} // namespace

Result<DemImportReport> import_dem_tiles(DemSink& sink, const fs::path& scratch, std::span<const fs::path> files,
                                         const DemImportOptions& options, const DemProgress& progress) {
    const int n = options.tile_cells;
    if (n < 128 || n > 8192 || (n & (n - 1)) != 0)
        return Error{ErrorKind::usage, fmt::format("tiles of {} cells: a power of two from 128 to 8192 is needed", n)};
    if (!(options.cell_m == 0.0 || (options.cell_m >= 1e-3 && options.cell_m <= 1e5)))
        return Error{ErrorKind::usage, fmt::format("cells of {} m: 0.001 to 100000 can be", options.cell_m)};
    if (!std::isfinite(options.datum_m) || std::abs(options.datum_m) > 1e6)
        return Error{ErrorKind::usage, fmt::format("a datum of {} m: -1000000 to 1000000 can be", options.datum_m)};
    if (!(options.shelf_m >= 0.0 && options.shelf_m <= 10000.0))
        return Error{ErrorKind::usage, fmt::format("a shelf {} m deep: 0 to 10000 can be", options.shelf_m)};
    if (options.edge_cells > 16384) return Error{ErrorKind::usage, "the skirt is at most 16384 cells wide"};
    if (options.memory_bytes < k_least_memory)
        return Error{ErrorKind::budget,
                     fmt::format("{} bytes of memory are too few: 32 MiB are needed", options.memory_bytes)};
    gdal_start(options.memory_bytes / 8);
    DemSourceOptions source = options.source;
    source.datum_m = options.datum_m;
    SAHEL_ASSIGN(auto mosaic, DemMosaic::open(files, source, options.cell_m));
    try {
        return Import(sink, scratch, options, progress, std::move(mosaic)).run();
    } catch (const std::bad_alloc&) {
        return Error{ErrorKind::budget, "the machine has no more memory for the import"};
    }
}

} // namespace sahel
