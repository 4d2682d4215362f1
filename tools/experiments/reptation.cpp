#include "tools/experiments/dune_run.h"
#include "tools/experiments/experiment.h"
#include "tools/experiments/measure_relief.h"
#include "tools/experiments/pictures.h"
#include "tools/experiments/presets.h"

#include <fmt/format.h>

#include <array>

/// Smoothing by impacts of growing strength on transverse dunes. The published rule is an explicit diffusion: at k_r =
/// 2 its ripples change sign every step (correlation of second differences with the step before -0.81). Sahel divides
/// the step so that this cannot happen; up to k_r = 1 both rules are the same and the reference figures apply.
namespace sahel::experiments {

namespace {

struct Reference {
    float smoothing;
    double across_m, along_m, correlation; ///< of the independent implementation (method 5.5, E6 ref.)
};
constexpr std::array<Reference, 6> k_series = {{{0.0f, 0.023, 0.129, 0.36},
                                                {0.5f, 0.019, 0.121, 0.22},
                                                {1.0f, 0.019, 0.135, 0.0},
                                                {2.0f, 0.072, 0.124, -0.81},
                                                {5.0f, 0.25, 0.21, 0.30},
                                                {10.0f, 0.32, 0.52, -0.43}}};

} // namespace

Result<Report> run_reptation(const Setup& setup) {
    Report report;
    report.columns = 3;
    report.picture_px = 384;
    Table table{"cells with more than 1 m of sand out of shelter (reference in brackets)",
                {"k_r", "across [m]", "along [m]", "correlation", "windward p95", "lee p95"},
                {}};
    double done = 0.0;
    for (const Reference& r : k_series) {
        DuneRunDesc desc;
        desc.cells_x = desc.cells_y = setup.extent.size_cells;
        desc.wind = published_wind(3.0f);
        desc.sand = published_sand(31, r.smoothing);
        desc.ground = noisy_sheet(3.0, 5.0);
        SAHEL_ASSIGN(DuneRun run, DuneRun::create(desc, setup));
        const double share = done / k_series.size();
        SAHEL_TRY(run.advance(setup.extent.steps - 1, setup, share, 1.0 / k_series.size(),
                              fmt::format("k_r = {}", r.smoothing)));
        const Plane before = run.sand();
        SAHEL_TRY(run.advance(1));
        done += 1.0;
        const Plane sand = run.sand();
        const Plane shadow = run.plane(SimLayer::wind_shadow);
        const CellMask open = CellMask::made(sand.width, sand.height, 1.0, [&](int32_t x, int32_t y) {
            return sand.at(x, y) > 1.0f && shadow.at(x, y) == 0.0f;
        });
        const Roughness rough = roughness_of(sand, open);
        const double again = correlation_of(second_difference_across(sand), second_difference_across(before), &open);
        const SidesAlong sides = sides_along(sand, 0.0);
        table.rows.push_back({fmt::format("{}", r.smoothing),
                              fmt::format("{:.3f} ({:.3f})", rough.across_m, r.across_m),
                              fmt::format("{:.3f} ({:.3f})", rough.along_m, r.along_m),
                              fmt::format("{:+.2f} ({:+.2f})", again, r.correlation),
                              fmt::format("{:.3f}", sides.rising), fmt::format("{:.3f}", sides.falling)});
        const std::string name = fmt::format("k_r = {}", r.smoothing);
        if (r.smoothing <= 1.0f) {
            report.require(name + ": roughness across over reference", rough.across_m / r.across_m, "", 0.5, 1.5,
                           "one noisy run against another");
            report.require(name + ": roughness along over reference", rough.along_m / r.along_m, "", 0.8, 1.2);
        } else {
            report.require(name + ": roughness across", rough.across_m, "m", 0.0, 0.03, "no ripples along the wind");
        }
        report.require(name + ": correlation with the step before", again, "", -0.2, std::nullopt,
                       "no change of sign every step");
        if (setup.pictures)
            report.pictures.push_back(
                {ground_picture(run), fmt::format("k_r = {}\nacross {:.3f} m, along {:.3f} m, correlation {:+.2f}",
                                                  r.smoothing, rough.across_m, rough.along_m, again)});
    }
    report.tables.push_back(std::move(table));
    return report;
}

} // namespace sahel::experiments
