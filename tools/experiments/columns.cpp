#include "sim/avalanche.h"
#include "tools/experiments/dune_run.h"
#include "tools/experiments/experiment.h"
#include "tools/experiments/measure_relief.h"
#include "tools/experiments/pictures.h"
#include "tools/experiments/plot.h"
#include "tools/experiments/taylor.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>

/// Columns of sand on a sheet of 2 m fall to the heap that eight directions hold up. Sahel's relaxation until quiet
/// beside the published fixed counts (a, b) and the earlier scheme (c, d), as peaks after steps of 50 sweeps.
namespace sahel::experiments {

namespace {

constexpr double k_sheet_m = 2.0;

struct Column {
    int32_t side = 0; ///< cells
    double height_m = 0.0;
    int32_t domain = 0;                ///< cells
    int32_t steps = 0;                 ///< of 50 sweeps, for the fixed counts
    std::array<int32_t, 6> shown{};    ///< steps whose peaks are printed
    std::array<double, 6> published{}; ///< peaks of scheme (a) there; 0: none
};

double seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double column_sand(const Column& c, int64_t x, int64_t y) {
    const int64_t first = (c.domain - c.side) / 2;
    const bool inside = x >= first && x < first + c.side && y >= first && y < first + c.side;
    return k_sheet_m + (inside ? c.height_m : 0.0);
}

Result<TileDomain> column_domain(const Column& c, double repose_tangent) {
    SAHEL_ASSIGN(const TileLayout layout, periodic_layout(c.domain, c.domain, 16));
    SimLayerSet layers = avalanche_layers();
    layers.insert({SimLayer::bedrock, SimLayer::soil, SimLayer::sand, SimLayer::repose});
    SAHEL_ASSIGN(TileDomain d, TileDomain::create(layout, layers));
    SAHEL_TRY(d.fill(SimLayer::bedrock, [](int64_t, int64_t) { return 0; }));
    SAHEL_TRY(d.fill(SimLayer::soil, [](int64_t, int64_t) { return 0; }));
    SAHEL_TRY(d.fill(SimLayer::sand, [&](int64_t x, int64_t y) {
        return static_cast<int32_t>(column_sand(c, x, y) * double{k_ticks_per_m});
    }));
    SAHEL_TRY(d.fill(SimLayer::repose, [&](int64_t, int64_t) { return static_cast<float>(repose_tangent); }));
    return d;
}

int64_t ticks_of(const TileDomain& d) {
    int64_t total = 0;
    for (const int64_t s : d.sums(SimLayer::sand).value()) total += s;
    return total;
}

struct Outcome {
    std::string name;
    Plane height;
    int64_t sweeps = 0;
    double seconds = 0.0;
    std::vector<Vec2> peaks; ///< step of 50 sweeps, metres
    bool quiet = false;
    int64_t drift_ticks = 0;
};

Result<Outcome> until_quiet(const Column& c, const SandParams& base) {
    const double repose = std::tan(double{base.repose_deg} * k_pi / 180.0);
    SAHEL_ASSIGN(TileDomain d, column_domain(c, repose));
    const int64_t before = ticks_of(d);
    SandParams sand = base;
    sand.avalanche_sweeps = 0;
    sand.avalanche_max_sweeps = 1000000;
    Outcome out;
    out.name = "until quiet";
    const double start = seconds();
    AvalancheStats stats;
    SAHEL_TRY(avalanche(d, sand, 1.0, AvalancheKind::sand, {}, &stats));
    out.seconds = seconds() - start;
    out.sweeps = stats.sweeps;
    out.quiet = stats.quiet;
    out.height = plane_of(d, SimLayer::sand, 1.0);
    out.drift_ticks = ticks_of(d) - before;
    return out;
}

Result<Outcome> fixed_count(const Column& c, const SandParams& base, float strength, const char* name) {
    const double repose = std::tan(double{base.repose_deg} * k_pi / 180.0);
    SAHEL_ASSIGN(TileDomain d, column_domain(c, repose));
    const int64_t before = ticks_of(d);
    SandParams sand = base;
    sand.avalanche_sweeps = 50;
    sand.avalanche_strength = strength;
    Outcome out;
    out.name = name;
    const double start = seconds();
    for (int32_t step = 1; step <= c.steps; ++step) {
        AvalancheStats stats;
        SAHEL_TRY(avalanche(d, sand, 1.0, AvalancheKind::sand, {}, &stats));
        out.sweeps += stats.sweeps;
        if (std::find(c.shown.begin(), c.shown.end(), step) != c.shown.end() || step == c.steps)
            out.peaks.push_back({double(step), largest_of(plane_of(d, SimLayer::sand, 1.0))});
    }
    out.seconds = seconds() - start;
    out.height = plane_of(d, SimLayer::sand, 1.0);
    out.drift_ticks = ticks_of(d) - before;
    return out;
}

Outcome taylor(const Column& c, double repose, double strength, const char* name) {
    TaylorSlide slide(Plane::made(c.domain, c.domain, 1.0, [&](int32_t x, int32_t y) { return column_sand(c, x, y); }),
                      repose, strength);
    Outcome out;
    out.name = name;
    const double start = seconds();
    for (int32_t step = 1; step <= c.steps; ++step) {
        for (int i = 0; i < 50; ++i) slide.sweep();
        out.sweeps += 50;
        if (std::find(c.shown.begin(), c.shown.end(), step) != c.shown.end() || step == c.steps)
            out.peaks.push_back({double(step), largest_of(slide.height())});
    }
    out.seconds = seconds() - start;
    out.height = slide.height();
    return out;
}

Status run_column(const Setup& setup, const Column& c, double share, double part, Report& report) {
    const SandParams sand;
    const double repose = std::tan(double{sand.repose_deg} * k_pi / 180.0);
    const std::string label = fmt::format("{0} x {0}", c.side);
    std::vector<Outcome> all;
    setup.tell(share, label + ", until quiet");
    SAHEL_ASSIGN(Outcome quiet, until_quiet(c, sand));
    setup.tell(share + 0.1 * part, label + ", (a)");
    SAHEL_ASSIGN(Outcome a, fixed_count(c, sand, 1.0f, "(a) 50 sweeps, strength 1"));
    setup.tell(share + 0.3 * part, label + ", (b)");
    SAHEL_ASSIGN(Outcome b, fixed_count(c, sand, 0.5f, "(b) 50 sweeps, {1, 1/2}"));
    setup.tell(share + 0.5 * part, label + ", (c)");
    Outcome t50 = taylor(c, repose, 0.5, "(c) earlier scheme, 0.5");
    setup.tell(share + 0.75 * part, label + ", (d)");
    Outcome t25 = taylor(c, repose, 0.25, "(d) earlier scheme, 0.25");

    const HeapHeights heaps = heap_heights(double(c.side) * c.side * c.height_m, repose);
    const double ideal = k_sheet_m + heaps.cone_m;
    const double peak = largest_of(quiet.height);
    const SlopeExcess slopes = slope_excess(quiet.height, quiet.height, repose);
    report.require_true(label + " column comes to rest", quiet.quiet);
    report.require(label + " peak over that of a round cone at repose", peak / ideal, "", 0.99, 1.01,
                   fmt::format("{:.1f} m against {:.1f} m", peak, ideal));
    report.tell(label + " peak over that of the lower octagon", peak / (k_sheet_m + heaps.lower_octagon_m), "",
                fmt::format("{:.1f} m", k_sheet_m + heaps.lower_octagon_m));
    report.tell(label + " peak over that of the higher octagon", peak / (k_sheet_m + heaps.higher_octagon_m), "",
                fmt::format("{:.1f} m", k_sheet_m + heaps.higher_octagon_m));
    report.require(label + " steepest slope", slopes.steepest_deg, "deg", 32.5, 33.5, "repose 33 +- 0.5");
    // The flanks must stand at repose too: the median over cells above the sheet.
    Plane heap = quiet.height;
    for (float& v : heap.values) v = v > k_sheet_m + 0.1 * (peak - k_sheet_m) ? v : 0.0f;
    const double flank = slope_excess(quiet.height, heap, repose).median + repose;
    report.require(label + " median slope of the flanks", std::atan(flank) * 180.0 / k_pi, "deg", 32.5, 33.5);
    const int64_t twice = 2 * ((c.domain - c.side) / 2) + c.side - 1;
    report.require(label + " largest asymmetry", asymmetry8(quiet.height, twice, twice), "m", 0.0, 0.0,
                   "the eight symmetries of the square, exactly");
    report.require(label + " sand made or lost", double(std::abs(quiet.drift_ticks) + std::abs(a.drift_ticks)), "ticks",
                   0.0, 0.0);
    // The ranking of the paper by peak height, at two fifths of the run.
    const auto peak_at = [&](const Outcome& o, int32_t step) {
        for (const Vec2& p : o.peaks)
            if (p.x == step) return p.y;
        return std::nan("");
    };
    const int32_t when = c.shown[2];
    report.require_true(label + fmt::format(" ranking a < b < c < d after {} sweeps", 50 * when),
                        peak_at(a, when) < peak_at(b, when) && peak_at(b, when) < peak_at(t50, when) &&
                            peak_at(t50, when) < peak_at(t25, when));
    for (size_t i = 0; i < c.shown.size(); ++i)
        if (c.published[i] > 0.0)
            report.require(fmt::format("{} (a) peak after {} steps, relative", label, c.shown[i]),
                           peak_at(a, c.shown[i]) / c.published[i], "", 0.95, 1.05,
                           fmt::format("method 5.3: {:.1f} m", c.published[i]));

    Table table{
        fmt::format("{} cells, {:.0f} m: peak [m] after steps of 50 sweeps", label, c.height_m), {"scheme"}, {}};
    for (const int32_t s : c.shown) table.columns.push_back(std::to_string(s));
    for (const char* name : {"sweeps", "excess", "time"}) table.columns.emplace_back(name);
    Plot plot;
    plot.x.label = "sweeps";
    plot.x.log = true;
    plot.y.label = "peak [m]";
    all = {std::move(quiet), std::move(a), std::move(b), std::move(t50), std::move(t25)};
    for (const Outcome& o : all) {
        std::vector<std::string> row = {o.name};
        for (const int32_t s : c.shown)
            row.push_back(o.peaks.empty() ? std::string("-") : fmt::format("{:.1f}", peak_at(o, s)));
        row.push_back(std::to_string(o.sweeps));
        row.push_back(fmt::format("{:.3f}", slope_excess(o.height, o.height, repose).largest));
        row.push_back(fmt::format("{:.2f} s", o.seconds));
        table.rows.push_back(std::move(row));
        PlotSeries line{o.name, {}, plot_colour(plot.series.size()), true};
        if (o.peaks.empty()) {
            line.points.push_back({double(o.sweeps), largest_of(o.height)});
            line.lines = false;
        }
        for (const Vec2& p : o.peaks) line.points.push_back({p.x * 50.0, p.y});
        plot.series.push_back(std::move(line));
    }
    report.tables.push_back(std::move(table));
    if (setup.pictures) {
        const std::array<std::string, 5> caption = {
            fmt::format("{}, until quiet: {} sweeps, peak {:.1f} m (cone {:.1f} m)", label, all[0].sweeps, peak, ideal),
            fmt::format("{}: peak {:.1f} m after {} sweeps", all[1].name, all[1].peaks.back().y, all[1].sweeps),
            fmt::format("{}: peak {:.1f} m", all[2].name, all[2].peaks.back().y),
            fmt::format("{}: peak {:.1f} m", all[3].name, all[3].peaks.back().y),
            fmt::format("{}: peak {:.1f} m", all[4].name, all[4].peaks.back().y)};
        for (size_t i = 0; i < all.size(); ++i) report.pictures.push_back({relief_picture(all[i].height), caption[i]});
        report.pictures.push_back({draw_plot(plot), "peak against sweeps"});
    }
    return {};
}

} // namespace

Result<Report> run_columns(const Setup& setup) {
    Report report;
    report.columns = 3;
    report.picture_px = 420;
    if (setup.quick) {
        const Column even{34, 136.0, 192, 28, {1, 5, 11, 17, 22, 28}, {}};
        const Column odd{25, 60.0, 128, 12, {1, 2, 5, 7, 10, 12}, {}};
        SAHEL_TRY(run_column(setup, even, 0.0, 0.7, report));
        SAHEL_TRY(run_column(setup, odd, 0.7, 0.3, report));
        return report;
    }
    const Column small{100, 400.0, 448, 250, {10, 50, 100, 150, 200, 250}, {377.8, 179.2, 130.8, 124.1, 122.1, 121.2}};
    const Column large{199, 400.0, 704, 250, {10, 50, 100, 150, 200, 250}, {0.0, 366.1, 279.3, 230.7, 211.2, 202.4}};
    SAHEL_TRY(run_column(setup, small, 0.0, 0.3, report));
    SAHEL_TRY(run_column(setup, large, 0.3, 0.7, report));
    return report;
}

} // namespace sahel::experiments
