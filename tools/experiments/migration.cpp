#include "tools/experiments/dune_run.h"
#include "tools/experiments/experiment.h"
#include "tools/experiments/measure_dunes.h"
#include "tools/experiments/measure_relief.h"
#include "tools/experiments/pictures.h"
#include "tools/experiments/plot.h"
#include "tools/experiments/presets.h"

#include <fmt/format.h>

#include <algorithm>

/// Barchans of many heights on bare rock, side by side in lanes, under a wind aslant to the rows of cells. A trench
/// takes what comes over the seam, so that no sand arrives at any of them. The flux over a crest does not depend on the
/// dune: its speed goes with 1 / height (Bagnold, The physics of blown sand, 1941). They grow from cones at repose.
namespace sahel::experiments {

namespace {

/// Centre of the upper fifth of a dune: it goes with the brink, where the centre of the whole lags as the horns lose
/// sand.
Vec2 crown_of(const Dune& dune, const Plane& sand) {
    double sum = 0.0, x = 0.0, y = 0.0;
    for (const auto& [cx, cy] : dune.cells) {
        const double over = std::max(double{sand.at(cx, cy)} - 0.8 * dune.height_m, 0.0);
        sum += over;
        x += over * (cx + 0.5);
        y += over * (cy + 0.5);
    }
    return {x / sum, y / sum};
}

} // namespace

Result<Report> run_migration(const Setup& setup) {
    const int32_t n = setup.extent.size_cells;
    constexpr int k_count = 7;
    constexpr float k_wind_deg = 15.0f;
    constexpr int32_t k_trench_cells = 24;
    const double smallest_m = setup.quick ? 5.0 : 8.0;
    const double largest_m = setup.quick ? 11.0 : 22.0;
    struct Cone {
        double height_m, x, y;
    };
    std::vector<Cone> cones;
    const auto height_of = [&](int i) {
        return smallest_m * std::pow(largest_m / smallest_m, static_cast<double>(i) / (k_count - 1));
    };
    constexpr double k_free_m = 4.0; // half the room between the feet of two cones, in heights of 1 / 0.6 of them
    double need = 0.0;
    for (int i = 0; i < k_count; ++i) need += height_of(i) + k_free_m;
    double y = 0.0;
    for (int i = 0; i < k_count; ++i) {
        const double lane = (height_of(i) + k_free_m) / need * n;
        cones.push_back({height_of(i), 0.25 * n, y + lane / 2.0});
        y += lane;
    }
    DuneRunDesc desc;
    desc.cells_x = desc.cells_y = n;
    desc.wind = plain_wind(setup.quick ? 1.0f : 1.5f,
                           k_wind_deg); // a grain goes 1.7 or 2.5 m before it rests: less than the dunes are long
    desc.sand.reptation_smooth = 1.0f;
    desc.ground.bedrock_m = [](int32_t x, int32_t) { return x < k_trench_cells ? 0.0 : 50.0; };
    desc.sand.bedrock_sweeps = 0; // the trench keeps its walls
    desc.ground.sand_m = [=](int32_t x, int32_t cy) {
        double s = 0.0;
        for (const Cone& c : cones)
            s = std::max(s, c.height_m - 0.6 * std::hypot(x + 0.5 - c.x, shortest(c.y, cy + 0.5, n)));
        return s;
    };
    SAHEL_ASSIGN(DuneRun run, DuneRun::create(desc, setup));
    const int64_t settle = setup.extent.steps / 3;
    SAHEL_TRY(run.advance(settle, setup, 0.0, 0.4, "settling"));
    constexpr double k_threshold = 1.0;
    constexpr double k_least_m2 = 60.0;
    const auto out_of_the_trench = [&] {
        Plane sand = run.sand();
        for (int32_t row = 0; row < sand.height; ++row)
            for (int32_t x = 0; x < k_trench_cells; ++x) sand.at(x, row) = 0.0f;
        return sand;
    };
    const Plane start = out_of_the_trench();
    // Each dune is followed over short stretches, in which it does not go far, for as long as it keeps its volume:
    // dunes merge, and horns calve.
    struct Life {
        double way_m = 0.0;
        double height_m = 0.0; // summed over stretches
        int stretches = 0;
        int crescent = 0; // of them with both horns downwind at the end
    };
    const Vec2 along = unit_of(k_wind_deg);
    std::vector<Dune> before = find_dunes(start, k_threshold, k_least_m2);
    std::vector<Life> lives(before.size());
    std::vector<size_t> id(before.size());
    for (size_t i = 0; i < id.size(); ++i) id[i] = i;
    Plane last = start;
    constexpr int k_stretches = 20;
    const int64_t stretch = std::max<int64_t>((setup.extent.steps - settle) / k_stretches, 1);
    for (int k = 0; k < k_stretches; ++k) {
        SAHEL_TRY(run.advance(stretch, setup, 0.4 + 0.03 * k, 0.03, "migrating"));
        const Plane now = out_of_the_trench();
        std::vector<Dune> after = find_dunes(now, k_threshold, k_least_m2);
        std::vector<size_t> next(after.size(), lives.size());
        for (const DuneTrack& t : track_dunes(before, after, now, {.reach_m = 25.0, .volume_ratio = 1.15})) {
            next[t.after] = id[t.before];
            Life& life = lives[id[t.before]];
            const Vec2 from = crown_of(before[t.before], last);
            const Vec2 to = crown_of(after[t.after], now);
            life.way_m += shortest(from.x, to.x, n) * along.x + shortest(from.y, to.y, n) * along.y;
            life.height_m += 0.5 * (before[t.before].height_m + after[t.after].height_m);
            ++life.stretches;
            life.crescent += barchan_shape(after[t.after], now, k_wind_deg).is_barchan();
        }
        for (size_t i = 0; i < after.size(); ++i)
            if (next[i] == lives.size()) next[i] = lives.size(), lives.emplace_back();
        before = std::move(after);
        last = now;
        id = std::move(next);
    }
    Report report;
    report.columns = 2;
    report.picture_px = 512;
    Table table{"isolated barchans", {"height", "speed", "height x speed"}, {}};
    std::vector<Vec2> points;
    constexpr int k_least_stretches = 5;
    const double stretch_s = static_cast<double>(stretch) * static_cast<double>(desc.sand.step_s);
    for (const Life& life : lives) {
        if (life.stretches < k_least_stretches || 2 * life.crescent < life.stretches) continue;
        const double height = life.height_m / life.stretches;
        if (height < 0.75 * smallest_m) continue;
        const double speed = life.way_m / (life.stretches * stretch_s);
        points.push_back({height, speed});
        table.rows.push_back({fmt::format("{:.2f} m", height), fmt::format("{:.3f} m/s", speed),
                              fmt::format("{:.2f} m2/s", height * speed)});
    }
    report.tables.push_back(std::move(table));
    const auto fit = fit_log_log(points);
    report.require("barchans followed", static_cast<double>(points.size()), "", setup.quick ? 3.0 : 5.0, std::nullopt);
    report.require("log slope of speed over height", fit ? fit->slope : std::nan(""), "", -1.25, -0.75,
                   fit ? fmt::format("+- {:.2f} (standard error)", fit->slope_error) : "");
    int crescents = 0;
    const Plane sand = out_of_the_trench();
    const std::vector<Dune> at_end = find_dunes(sand, k_threshold, k_least_m2);
    for (const Dune& d : at_end) crescents += barchan_shape(d, sand, desc.wind.angle_deg).is_barchan();
    report.require("dunes with both horns downwind", at_end.empty() ? 0.0 : double(crescents) / double(at_end.size()),
                   "", 0.6, std::nullopt);
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
