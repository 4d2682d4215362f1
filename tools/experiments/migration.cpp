#include "tools/experiments/dune_run.h"
#include "tools/experiments/experiment.h"
#include "tools/experiments/measure_dunes.h"
#include "tools/experiments/measure_relief.h"
#include "tools/experiments/pictures.h"
#include "tools/experiments/plot.h"
#include "tools/experiments/presets.h"

#include <fmt/format.h>

#include <algorithm>

/// Isolated barchans on bare rock, each in a lane of its own along the wind: sand that leaves the horns comes back into
/// the same lane over the seam. The flux over a crest does not depend on the dune, so that its speed goes with 1 /
/// height (Bagnold, The physics of blown sand, 1941).
namespace sahel::experiments {

Result<Report> run_migration(const Setup& setup) {
    const int32_t n = setup.extent.size_cells;
    // Cones at the angle of repose, whose heights grow by a factor; lanes as wide as they need.
    const int count = setup.quick ? 5 : 7;
    const double smallest_m = setup.quick ? 5.0 : 5.0;
    const double largest_m = setup.quick ? 12.0 : 18.0;
    struct Cone {
        double height_m, x, y;
    };
    std::vector<Cone> cones;
    double need = 0.0;
    const auto height_of = [&](int i) {
        return smallest_m * std::pow(largest_m / smallest_m, static_cast<double>(i) / (count - 1));
    };
    for (int i = 0; i < count; ++i) need += height_of(i) + 4.0;
    double y = 0.0;
    for (int i = 0; i < count; ++i) {
        const double lane = (height_of(i) + 4.0) / need * n;
        cones.push_back({height_of(i), 0.25 * n, y + lane / 2.0});
        y += lane;
    }
    DuneRunDesc desc;
    desc.cells_x = desc.cells_y = n;
    desc.wind = plain_wind(4.0f, 0.0f);
    desc.ground.sand_m = [=](int32_t x, int32_t cy) {
        double s = 0.0;
        for (const Cone& c : cones) s = std::max(s, c.height_m - 0.6 * std::hypot(x + 0.5 - c.x, cy + 0.5 - c.y));
        return s;
    };
    SAHEL_ASSIGN(DuneRun run, DuneRun::create(desc, setup));
    const int64_t settle = setup.extent.steps / 2;
    SAHEL_TRY(run.advance(settle, setup, 0.0, 0.5, "settling"));
    constexpr double k_threshold = 0.5;
    constexpr double k_least_m2 = 60.0;
    const Plane start = run.sand();
    std::vector<Dune> before = find_dunes(start, k_threshold, k_least_m2);
    const size_t found = before.size();
    // Speeds are summed over short stretches, in which no dune goes far.
    std::vector<double> way(found, 0.0), height(found, 0.0);
    std::vector<uint8_t> alive(found, 1);
    std::vector<size_t> id(found);
    for (size_t i = 0; i < found; ++i) id[i] = i;
    const int64_t stretches = 10;
    const int64_t stretch = std::max<int64_t>((setup.extent.steps - settle) / stretches, 1);
    for (int64_t k = 0; k < stretches; ++k) {
        SAHEL_TRY(run.advance(stretch, setup, 0.5 + 0.05 * static_cast<double>(k), 0.05, "migrating"));
        const Plane now = run.sand();
        std::vector<Dune> after = find_dunes(now, k_threshold, k_least_m2);
        std::vector<size_t> next(after.size(), found);
        std::vector<uint8_t> seen(found, 0);
        for (const DuneTrack& t : track_dunes(before, after, now, {.reach_m = 0.25 * n, .volume_ratio = 1.25})) {
            const size_t who = id[t.before];
            if (who == found) continue;
            next[t.after] = who;
            seen[who] = 1;
            way[who] += t.shift_x_m;
            height[who] += 0.5 * (before[t.before].height_m + after[t.after].height_m) / static_cast<double>(stretches);
        }
        for (size_t i = 0; i < found; ++i) alive[i] = alive[i] && seen[i];
        before = std::move(after);
        id = std::move(next);
    }
    Report report;
    report.columns = 2;
    report.picture_px = 512;
    Table table{"isolated barchans", {"height", "speed", "height x speed"}, {}};
    std::vector<Vec2> points;
    const double time_s = static_cast<double>(stretch * stretches) * static_cast<double>(desc.sand.step_s);
    for (size_t i = 0; i < found; ++i) {
        if (!alive[i]) continue;
        points.push_back({height[i], way[i] / time_s});
        table.rows.push_back({fmt::format("{:.2f} m", height[i]), fmt::format("{:.3f} m/s", way[i] / time_s),
                              fmt::format("{:.2f} m2/s", height[i] * way[i] / time_s)});
    }
    report.tables.push_back(std::move(table));
    const auto fit = fit_log_log(points);
    report.require("barchans followed", static_cast<double>(points.size()), "", 5.0, std::nullopt);
    report.require("log slope of speed over height", fit ? fit->slope : std::nan(""), "", -1.25, -0.75,
                   fit ? fmt::format("+- {:.2f} (standard error)", fit->slope_error) : "");
    int crescents = 0;
    const Plane sand = run.sand();
    const std::vector<Dune> last = find_dunes(sand, k_threshold, k_least_m2);
    for (const Dune& d : last) crescents += barchan_shape(d, sand, desc.wind.angle_deg).is_barchan();
    report.require("dunes with both horns downwind", last.empty() ? 0.0 : double(crescents) / double(last.size()), "",
                   0.6, std::nullopt);
    if (setup.pictures) {
        report.pictures.push_back(
            {ground_picture(run), fmt::format("barchans after {} s; wind to the right", run.step())});
        Plot plot;
        plot.x = {"height [m]", true, {}, {}};
        plot.y = {"speed [m/s]", true, {}, {}};
        plot.series.push_back({"barchans", points, plot_colour(0), false});
        if (fit) {
            PlotSeries line{fmt::format("slope {:.2f}", fit->slope), {}, plot_colour(1), true};
            PlotSeries law{"slope -1", {}, plot_colour(5), true};
            double mean_x = 0.0;
            for (const Vec2& p : points) mean_x += std::log(p.x) / static_cast<double>(points.size());
            for (const Vec2& p : points) {
                line.points.push_back({p.x, std::exp(fit->intercept + fit->slope * std::log(p.x))});
                law.points.push_back({p.x, std::exp(fit->intercept + fit->slope * mean_x - (std::log(p.x) - mean_x))});
            }
            plot.series.push_back(std::move(line));
            plot.series.push_back(std::move(law));
        }
        report.pictures.push_back({draw_plot(plot), fmt::format("speed against height, {} dunes", points.size())});
    }
    return report;
}

} // namespace sahel::experiments
