#include "tools/experiments/dune_kinds.h"
#include "tools/experiments/experiment.h"
#include "tools/experiments/measure_crests.h"
#include "tools/experiments/measure_relief.h"
#include "tools/experiments/pictures.h"
#include "tools/experiments/plot.h"
#include "tools/experiments/presets.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

/// What sampling between cells is for (method 5.5, E3 to E5): hops shorter than half a cell still move sand at the
/// right mean speed; the strip at the foot of cliffs is closed at every angle of the wind; dunes follow a bent wind
/// smoothly.
namespace sahel::experiments {

namespace {

/// Mean way of the centre of all sand along x in a step, m.
Result<double> drift_of(const Setup& setup, float speed_m_per_s, bool bilinear, int32_t n, int64_t steps) {
    // A low mound on bare rock: no slope of it makes shelter.
    DuneRunDesc desc;
    desc.cells_x = n;
    desc.cells_y = 64;
    desc.wind = plain_wind(speed_m_per_s, 0.0f);
    desc.sand.bilinear = bilinear;
    desc.ground.sand_m = [=](int32_t x, int32_t y) {
        const double d = std::hypot(x - n / 2.0, y - 32.0) / 20.0;
        return 4.0 * std::exp(-0.5 * d * d);
    };
    SAHEL_ASSIGN(DuneRun run, DuneRun::create(desc, setup));
    const auto phase = [&] { // on a circle, so that the seam does not matter
        const Plane all = sum_of(run.sand(), run.plane(SimLayer::airborne_sand));
        double c = 0.0, s = 0.0;
        for (int32_t y = 0; y < all.height; ++y)
            for (int32_t x = 0; x < all.width; ++x) {
                const double a = 2.0 * k_pi * x / n;
                c += all.at(x, y) * std::cos(a);
                s += all.at(x, y) * std::sin(a);
            }
        return std::atan2(s, c) / (2.0 * k_pi) * n;
    };
    SAHEL_TRY(run.advance(5)); // the air fills
    const double from = phase();
    SAHEL_TRY(run.advance(steps));
    return shortest(from, phase(), n) / static_cast<double>(steps);
}

Status short_hops(const Setup& setup, Report& report) {
    Table table{
        "mean way of all sand in a step, over the hop of its grains", {"hop [cells]", "bilinear", "nearest"}, {}};
    Plot plot;
    plot.x = {"hop [cells]", false, 0.0, 1.05};
    plot.y = {"way of all sand in a step [m]", false, 0.0, {}};
    plot.series = {{"bilinear", {}, plot_colour(0), false}, {"nearest", {}, plot_colour(1), false}};
    SAHEL_ASSIGN(const double whole, drift_of(setup, 1.0f, true, 128, 10)); // one whole cell: no sampling is in it
    double worst = 0.0, nearest_most = 0.0;
    for (const float hop : {0.1f, 0.2f, 0.3f, 0.4f}) {
        setup.tell(0.3 * static_cast<double>(hop), "short hops");
        SAHEL_ASSIGN(const double fine, drift_of(setup, hop, true, 128, 10));
        SAHEL_ASSIGN(const double coarse, drift_of(setup, hop, false, 128, 10));
        const double expected = whole * static_cast<double>(hop);
        worst = std::max(worst, std::abs(fine / expected - 1.0));
        nearest_most = std::max(nearest_most, std::abs(coarse));
        table.rows.push_back({fmt::format("{}", hop), fmt::format("{:.4f}", fine / static_cast<double>(hop)),
                              fmt::format("{:.4f}", coarse / static_cast<double>(hop))});
        plot.series[0].points.push_back({static_cast<double>(hop), fine});
        plot.series[1].points.push_back({static_cast<double>(hop), coarse});
    }
    plot.series.push_back({"whole hops, in proportion", {{0.0, 0.0}, {1.0, whole}}, plot_colour(5), true});
    report.tables.push_back(std::move(table));
    report.require("short hops, bilinear: largest error of the mean way", worst, "", 0.0, 0.05,
                   "against hops of one cell");
    report.require("short hops, nearest: largest way over that of a whole cell", nearest_most / whole, "", 0.0, 1.0e-3,
                   "no grain reaches the next cell");
    if (setup.pictures) report.pictures.push_back({draw_plot(plot), "hops of less than half a cell (E5)"});
    return {};
}

/// Cells in sight of a wall that the strip of erosion must hold: from them, down the wind, the wall is nearer than the
/// range less two cells, and the wind does not graze it. Gives the share that is not marked.
double holes_at(const Plane& echo, const Obstacle& o, double wind_deg, double range_m) {
    const double deep = 0.35 * o.radius; // a ray that leaves the wall again before this met it at less than 10 degrees
    const Vec2 d = unit_of(wind_deg);
    int64_t wanted = 0, missing = 0;
    for (int32_t y = 0; y < echo.height; ++y)
        for (int32_t x = 0; x < echo.width; ++x) {
            if (o.holds(x, y)) continue;
            bool near = false;
            for (double way = 1.0; way <= range_m - 2.0 && !near; way += 0.25)
                near = o.holds(static_cast<int32_t>(std::lround(x + way * d.x)),
                               static_cast<int32_t>(std::lround(y + way * d.y))) &&
                       o.holds(static_cast<int32_t>(std::lround(x + (way + deep) * d.x)),
                               static_cast<int32_t>(std::lround(y + (way + deep) * d.y)));
            if (!near) continue;
            ++wanted;
            missing += !(echo.at(x, y) < 0.0f);
        }
    return wanted > 0 ? static_cast<double>(missing) / static_cast<double>(wanted) : 1.0;
}

Status closed_strips(const Setup& setup, Report& report) {
    const int32_t n = setup.quick ? 128 : 256;
    const Obstacle o{n / 2 - n / 12, n / 2, n / 6, n / 4};
    Plot plot;
    plot.x = {"wind [deg]", false, 0.0, 90.0};
    plot.y = {"holes in the strip [share of its cells]", false, 0.0, {}};
    plot.series = {{"bilinear", {}, plot_colour(0), true}, {"nearest", {}, plot_colour(1), true}};
    Table table{"cells of the strip that are not marked, %", {"wind [deg]", "bilinear", "nearest"}, {}};
    double worst_fine = 0.0, worst_coarse = 0.0;
    const int step = setup.quick ? 15 : 5;
    for (int angle = 0; angle <= 90; angle += step) {
        setup.tell(0.2 + 0.3 * angle / 90.0, "strips at cliffs");
        table.rows.push_back({fmt::format("{}", angle)});
        for (const bool fine : {true, false}) {
            DuneRunDesc desc;
            desc.cells_x = desc.cells_y = n;
            desc.wind = plain_wind(5.0f, static_cast<float>(angle));
            desc.sand.bilinear = fine;
            desc.sand.echo_rate_m_per_s = 1.0f;
            desc.sand.echo_max_cliff_m = 15.0f;
            desc.ground.bedrock_m = [=](int32_t x, int32_t y) { return o.holds(x, y) ? 100.0 : 0.0; };
            desc.ground.object = [=](int32_t x, int32_t y) { return o.holds(x, y); };
            SAHEL_ASSIGN(DuneRun run, DuneRun::create(desc, setup));
            SAHEL_TRY(run.advance(1));
            const Plane echo = run.plane(SimLayer::echo);
            const double share = holes_at(echo, o, angle, double{desc.sand.echo_erosion_range} * 15.0);
            double& worst = fine ? worst_fine : worst_coarse;
            worst = std::max(worst, share);
            table.rows.back().push_back(fmt::format("{:.2f}", 100.0 * share));
            plot.series[fine ? 0 : 1].points.push_back({static_cast<double>(angle), share});
            if (setup.pictures && angle == 30)
                report.pictures.push_back(
                    {value_picture(echo, -1.0, 1.0, "echo class", ""),
                     fmt::format("wind at 30 deg, {} cliffs: blue erosion, red calm (E3)\nholes {:.1f} % of the strip",
                                 fine ? "bilinear" : "nearest", 100.0 * share)});
        }
    }
    report.tables.push_back(std::move(table));
    report.require("strip at cliffs, bilinear: worst share of holes over all angles", worst_fine, "", 0.0, 0.0,
                   "E3: no hole");
    report.tell("strip at cliffs, nearest: worst share of holes", worst_coarse, "");
    if (setup.pictures) report.pictures.push_back({draw_plot(plot), "holes in the strip by angle of the wind"});
    return {};
}

Status bent_wind(const Setup& setup, Report& report) {
    const int32_t n = setup.extent.size_cells;
    std::array<double, 2> rough{};
    for (const bool fine : {true, false}) {
        DuneRunDesc desc;
        desc.cells_x = desc.cells_y = n;
        const Obstacle o{n / 2 - n / 10, n / 2, n / 8, n / 4};
        desc.wind = plain_wind(5.0f, 0.0f);
        desc.wind.warp = true;
        desc.wind.warp_gain = 10.0f;
        desc.wind.warp_radius_1_m = static_cast<float>(n) / 5.0f;
        desc.wind.warp_radius_2_m = static_cast<float>(n) / 20.0f;
        desc.sand.bilinear = fine;
        desc.ground.bedrock_m = [=](int32_t x, int32_t y) { return o.holds(x, y) ? 40.0 : 0.0; };
        desc.ground.object = [=](int32_t x, int32_t y) { return o.holds(x, y, 2); };
        desc.ground.sand_m = [=](int32_t x, int32_t y) {
            return o.holds(x, y) ? 0.0 : 4.0 + 2.0 * cell_noise(4, x, y);
        };
        SAHEL_ASSIGN(DuneRun run, DuneRun::create(desc, setup));
        SAHEL_TRY(run.advance(setup.extent.steps, setup, fine ? 0.5 : 0.75, 0.25, "bent wind"));
        const Plane sand = run.sand();
        const CellMask open = CellMask::made(n, n, 1.0, [&](int32_t x, int32_t y) { return sand.at(x, y) > 0.5f; });
        rough[fine ? 0 : 1] = roughness_of(sand, open).across_m;
        if (setup.pictures)
            report.pictures.push_back(
                {ground_picture(run), fmt::format("bent wind, {} (E4)\nroughness across {:.3f} m",
                                                  fine ? "bilinear" : "nearest", rough[fine ? 0 : 1])});
    }
    report.tell("bent wind: roughness across, nearest over bilinear", rough[1] / rough[0], "",
                "seen in the pictures, hardly in this number");
    report.tell("bent wind: roughness across, bilinear", rough[0], "m");
    return {};
}

} // namespace

Result<Report> run_bilinear(const Setup& setup) {
    Report report;
    report.columns = 3;
    report.picture_px = 420;
    if (setup.wants("short hops")) SAHEL_TRY(short_hops(setup, report));
    if (setup.wants("strips at cliffs")) SAHEL_TRY(closed_strips(setup, report));
    if (setup.wants("bent wind")) SAHEL_TRY(bent_wind(setup, report));
    return report;
}

} // namespace sahel::experiments
