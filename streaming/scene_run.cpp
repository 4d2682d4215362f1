#include "streaming/scene_run.h"

#include "sim/directions.h"
#include "sim/domain_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

namespace sahel {

namespace {

constexpr float k_covered_m = 0.1f; // of the reports, whatever the scene's supply counts

Status fill(TileDomain& domain, const SceneGround& g) {
    const auto at = [&](int64_t x, int64_t y) {
        return static_cast<size_t>(y) * static_cast<size_t>(g.width) + static_cast<size_t>(x);
    };
    const auto ticks = [&](SimLayer layer, const std::vector<float>& metres) -> Status {
        return domain.fill(layer, [&](int64_t x, int64_t y) { return ticks_of_metres(metres[at(x, y)]); });
    };
    SAHEL_TRY(ticks(SimLayer::bedrock, g.bedrock_m));
    SAHEL_TRY(ticks(SimLayer::soil, g.soil_m));
    SAHEL_TRY(ticks(SimLayer::sand, g.sand_m));
    SAHEL_TRY(ticks(SimLayer::water, g.water_m));
    SAHEL_TRY(ticks(SimLayer::moisture, g.moisture_m));
    SAHEL_TRY(domain.fill(SimLayer::airborne_sand, [](int64_t, int64_t) { return int32_t{0}; }));
    SAHEL_TRY(domain.fill(SimLayer::vegetation, [&](int64_t x, int64_t y) { return g.vegetation[at(x, y)]; }));
    SAHEL_TRY(domain.fill(SimLayer::resistance, [&](int64_t x, int64_t y) { return g.resistance[at(x, y)]; }));
    if (!g.echo.empty()) SAHEL_TRY(domain.fill(SimLayer::echo, [&](int64_t x, int64_t y) { return g.echo[at(x, y)]; }));
    return domain.fill(SimLayer::object, [&](int64_t x, int64_t y) { return int32_t{g.object[at(x, y)]}; });
}

double quantile(std::vector<float>& values, double share) {
    if (values.empty()) return 0.0;
    const auto k = static_cast<ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + k, values.end());
    return values[static_cast<size_t>(k)];
}

} // namespace

Result<TileLayout> scene_layout(int32_t width, int32_t height, int32_t least_halo, int32_t most_tile_cells) {
    int32_t tile = most_tile_cells;
    while (tile > k_scene_side_step && (width % tile != 0 || height % tile != 0)) tile /= 2;
    if (width % tile != 0 || height % tile != 0)
        return Error{ErrorKind::usage, fmt::format("a grid of {} x {} cells cannot be cut into tiles of {}", width,
                                                   height, k_scene_side_step)};
    // Wide halos last for more sweeps; small tiles cannot afford them.
    const int32_t wanted = tile >= 256 ? 32 : 16;
    const int32_t halo = std::max(wanted, (least_halo + 7) / 8 * 8);
    if (halo > tile)
        return Error{
            ErrorKind::usage,
            fmt::format("a grid of {} x {} cells is cut into tiles of {}; this scene looks {} cells far: choose "
                        "a size that a larger power of two divides",
                        width, height, tile, least_halo)};
    return TileLayout::rectangle(tile, halo, width / tile, height / tile, Border::periodic);
}

Result<SceneRun> SceneRun::create(const Scene& scene, const SceneRunOptions& options) {
    SAHEL_ASSIGN(SceneGround ground, make_scene_ground(scene, options.ground));
    Aeolian::Desc desc;
    desc.wind = scene.wind;
    desc.wind.epoch_steps = options.wind_every;
    desc.sand = scene.sand;
    if (options.until_quiet) {
        desc.sand.avalanche_sweeps = 0;
        desc.sand.avalanche_max_sweeps = k_sweeps_until_quiet;
    }
    if (ground.scale != 1.0 && scene.sand.supply && !scene.sand.supply_uniform) {
        // The disc keeps its share of the grid: one event adds the same mean thickness.
        desc.sand.supply_radius_cells =
            std::max(1, static_cast<int>(std::lround(ground.scale * scene.sand.supply_radius_cells)));
        ground.notes.push_back(fmt::format("discs of supply have a radius of {} cells instead of {}: the same share of "
                                           "the grid",
                                           desc.sand.supply_radius_cells, scene.sand.supply_radius_cells));
    }
    if (!ground.echo.empty() && scene.sand.echo_rate_m_per_s == 0.0f) {
        desc.echo_given = true;
        desc.sand.echo_rate_m_per_s = 1.0e-9f; // any rate switches classes on; a map holds none that erodes
        ground.notes.emplace_back("echo classes are those of the map, as in the published program");
    } else {
        ground.echo.clear();
    }
    desc.cell_m = scene.cell_m;
    desc.seed = options.seed;
    SAHEL_ASSIGN(TileLayout layout,
                 scene_layout(ground.width, ground.height, Aeolian::least_halo(desc), options.most_tile_cells));
    SAHEL_ASSIGN(TileDomain domain, TileDomain::create(std::move(layout), Aeolian::layers(desc)));
    SAHEL_TRY(fill(domain, ground));
    SAHEL_ASSIGN(Aeolian aeolian, Aeolian::create(desc, domain));
    SceneRun run(std::move(ground), std::move(domain), std::move(aeolian));
    run.cell_m_ = scene.cell_m;
    SAHEL_ASSIGN(run.start_ticks_, run.solids());
    if (options.ledger) {
        SAHEL_ASSIGN(run.ledger_, Ledger::open(run.domain_));
    }
    return run;
}

Result<LedgerCheck> SceneRun::ledger_check() {
    if (!ledger_) return Error{ErrorKind::usage, "this run keeps no ledger"};
    SAHEL_TRY(ledger_->close(domain_));
    return ledger_->check();
}

Status SceneRun::step() {
    SAHEL_TRY(aeolian_.step(domain_, steps_));
    ++steps_;
    const AvalancheStats& slides = aeolian_.stats().sand;
    sweeps_ += slides.sweeps;
    cells_swept_ += slides.cells_swept;
    cells_all_ += slides.cells_all;
    return {};
}

Result<std::vector<float>> SceneRun::field(SimLayer layer) const {
    return field_of(domain_, layer);
}

Result<int64_t> SceneRun::solids() const {
    int64_t sum = 0;
    for (const SimLayer layer : {SimLayer::bedrock, SimLayer::soil, SimLayer::sand, SimLayer::airborne_sand}) {
        SAHEL_ASSIGN(const std::vector<int64_t> sums, domain_.sums(layer));
        for (const int64_t s : sums) sum += s;
    }
    return sum;
}

Result<SceneReport> SceneRun::report() const {
    SceneReport r;
    r.steps = steps_;
    r.max_wind_m_per_s = static_cast<double>(aeolian_.stats().max_wind_m_per_s);
    if (steps_ > 0) r.sweeps_per_step = static_cast<double>(sweeps_) / static_cast<double>(steps_);
    if (cells_all_ > 0) r.swept_share = static_cast<double>(cells_swept_) / static_cast<double>(cells_all_);
    SAHEL_ASSIGN(r.solids_ticks, solids());
    for (const SupplyAccount& a : aeolian_.supplied()) r.supplied_ticks += a.added_ticks - a.removed_ticks;
    r.drift_ticks = r.solids_ticks - start_ticks_ - r.supplied_ticks;

    SAHEL_ASSIGN(const std::vector<float> bedrock, field(SimLayer::bedrock));
    SAHEL_ASSIGN(const std::vector<float> soil, field(SimLayer::soil));
    SAHEL_ASSIGN(const std::vector<float> sand, field(SimLayer::sand));
    SAHEL_ASSIGN(const std::vector<float> airborne, field(SimLayer::airborne_sand));
    double sum = 0.0;
    double squares = 0.0;
    double air = 0.0;
    int64_t covered = 0;
    for (size_t i = 0; i < sand.size(); ++i) {
        const double s = sand[i];
        sum += s;
        squares += s * s;
        air += airborne[i];
        covered += sand[i] > k_covered_m;
        r.sand_max_m = std::max(r.sand_max_m, s);
    }
    const auto cells = static_cast<double>(sand.size());
    r.coverage = static_cast<double>(covered) / cells;
    r.sand_mean_m = sum / cells;
    r.sand_std_m = std::sqrt(std::max(squares / cells - r.sand_mean_m * r.sand_mean_m, 0.0));
    r.airborne_mean_m = air / cells;

    if (steps_ == 0) return r;
    SAHEL_ASSIGN(const std::vector<float> repose, field(SimLayer::repose));
    std::vector<float> excess;
    const int32_t w = ground_.width;
    const int32_t h = ground_.height;
    const auto height = [&](size_t i) { return bedrock[i] + soil[i] + sand[i]; };
    size_t i = 0;
    for (int32_t y = 0; y < h; ++y)
        for (int32_t x = 0; x < w; ++x, ++i) {
            if (!(sand[i] > 0.0f)) continue;
            float steepest = -1.0e9f;
            for (int k = 0; k < k_direction_count; ++k) {
                const int32_t nx = (x + direction_x(k) + w) % w;
                const int32_t ny = (y + direction_y(k) + h) % h;
                const float drop =
                    height(i) - height(static_cast<size_t>(ny) * static_cast<size_t>(w) + static_cast<size_t>(nx));
                const float distance = static_cast<float>(cell_m_) * ((k & 1) ? std::numbers::sqrt2_v<float> : 1.0f);
                steepest = std::max(steepest, drop / distance);
            }
            excess.push_back(steepest - repose[i]);
        }
    if (!excess.empty()) {
        r.excess_max = *std::max_element(excess.begin(), excess.end());
        r.excess_p99 = quantile(excess, 0.99);
    }
    return r;
}

} // namespace sahel
