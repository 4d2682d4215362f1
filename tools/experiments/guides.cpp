#include "tools/experiments/dune_run.h"
#include "tools/experiments/experiment.h"
#include "tools/experiments/measure_relief.h"
#include "tools/experiments/pictures.h"
#include "tools/experiments/presets.h"

#include <fmt/format.h>

#include <array>

/// Whole runs by the published rules of 2023 beside one run each of an independent implementation (method 5.7), whose
/// figures are guides of +- 10 %. Rows whose rules Sahel does not keep (sand lost by backward saltation, smoothing
/// above its limit of stability) are left out.
namespace sahel::experiments {

namespace {

struct Guide {
    const char* name;
    int32_t cells;
    double cell_m;
    double least_m, most_m; ///< of the sheet
    float speed_m_per_s;
    int sweeps;
    float smoothing;
    int64_t steps;
    double cover, deviation_m, highest_m;
    bool quick; ///< belongs to the quick form too
};
constexpr std::array<Guide, 6> k_guides = {{
    {"B-like, 256, 1 m, k_r 0", 256, 1.0, 3.0, 5.0, 3.0f, 31, 0.0f, 1000, 0.71, 3.65, 12.6, false},
    Guide{"B-like, 256, 1 m, k_r 1", 256, 1.0, 3.0, 5.0, 3.0f, 31, 1.0f, 1000, 0.70, 3.74, 13.1, false},
    Guide{"B-like, 256, 0.5 m, k_r 1", 256, 0.5, 3.0, 5.0, 3.0f, 62, 1.0f, 300, 0.80, 3.25, 11.9, true},
    Guide{"A-like, 256, 1 m, k_r 1", 256, 1.0, 0.5, 2.0, 5.0f, 25, 1.0f, 1000, 0.28, 2.38, 12.9, false},
    Guide{"A 512, 2 m, k_r 0", 512, 2.0, 0.5, 2.0, 5.0f, 13, 0.0f, 1000, 0.43, 1.44, 5.5, false},
    Guide{"B 512, 2 m, k_r 0", 512, 2.0, 3.0, 5.0, 3.0f, 15, 0.0f, 600, 0.94, 1.47, 8.3, false},
}};

} // namespace

Result<Report> run_guides(const Setup& setup) {
    Report report;
    report.columns = 3;
    report.picture_px = 420;
    double done = 0.0, total = 0.0;
    for (const Guide& g : k_guides)
        if ((!setup.quick || g.quick) && setup.wants(g.name))
            total += double(g.cells) * g.cells * double(g.steps) * g.sweeps;
    for (const Guide& g : k_guides) {
        if ((setup.quick && !g.quick) || !setup.wants(g.name)) continue;
        DuneRunDesc desc;
        desc.cells_x = desc.cells_y = g.cells;
        desc.cell_m = g.cell_m;
        desc.wind = published_wind(g.speed_m_per_s);
        desc.sand = published_sand(g.sweeps, g.smoothing);
        desc.ground = noisy_sheet(g.least_m, g.most_m);
        SAHEL_ASSIGN(DuneRun run, DuneRun::create(desc, setup));
        const int64_t before = run.solid_ticks();
        const double part = double(g.cells) * g.cells * double(g.steps) * g.sweeps / total;
        SAHEL_TRY(run.advance(g.steps, setup, done, part, g.name));
        done += part;
        const Plane sand = run.sand();
        const double cover = coverage_of(sand, 0.1);
        const std::string name = g.name;
        report.require(name + ": cover over guide", cover / g.cover, "", 0.9, 1.1,
                       fmt::format("{:.2f}, guide {:.2f}", cover, g.cover));
        report.require(name + ": deviation over guide", deviation_of(sand) / g.deviation_m, "", 0.9, 1.1,
                       fmt::format("{:.2f} m, guide {:.2f} m", deviation_of(sand), g.deviation_m));
        report.require(name + ": highest over guide", largest_of(sand) / g.highest_m, "", 0.9, 1.1,
                       fmt::format("{:.1f} m, guide {:.1f} m", largest_of(sand), g.highest_m));
        report.require(name + ": sand made or lost", static_cast<double>(std::abs(run.solid_ticks() - before)), "ticks",
                       0.0, 0.0);
        if (setup.pictures)
            report.pictures.push_back(
                {ground_picture(run), fmt::format("{}\ncover {:.2f}, deviation {:.2f} m, highest {:.1f} m", name, cover,
                                                  deviation_of(sand), largest_of(sand))});
    }
    return report;
}

} // namespace sahel::experiments
