#include "tools/experiments/dune_run.h"
#include "tools/experiments/experiment.h"
#include "tools/experiments/measure_relief.h"
#include "tools/experiments/pictures.h"
#include "tools/experiments/presets.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

/// Dunes meet discs of plants of rising density (method 5.5, E7): they deform more the denser the plants are, slopes
/// inside are steeper, up to the angle of repose under plants, and sand stays between dense plants.
namespace sahel::experiments {

Result<Report> run_vegetation(const Setup& setup) {
    const int32_t n = setup.extent.size_cells;
    constexpr int k_discs = 4;
    const double radius = n / 12.0;
    const auto density = [](int i) { return static_cast<double>(i) / (k_discs - 1); };
    const auto disc_of = [=](int32_t x, int32_t y, double within) {
        for (int i = 0; i < k_discs; ++i)
            if (std::hypot(x + 0.5 - n / 2.0, y + 0.5 - (i + 0.5) * n / k_discs) <= radius * within) return i;
        return -1;
    };
    DuneRunDesc desc;
    desc.cells_x = desc.cells_y = n;
    desc.wind = published_wind(5.0f);
    desc.sand.reptation_smooth = 1.0f;
    desc.ground = noisy_sheet(6.0, 8.0);
    desc.ground.vegetation = [=](int32_t x, int32_t y) {
        const int i = disc_of(x, y, 1.0);
        return i < 0 ? 0.0 : density(i);
    };
    desc.sand.avalanche_max_sweeps = k_sweeps_until_quiet; // slopes are measured
    SAHEL_ASSIGN(DuneRun run, DuneRun::create(desc, setup));
    // Sand that moves inside the discs, from one time to a later one.
    SAHEL_TRY(run.advance(setup.extent.steps - 20, setup, 0.0, 0.9, "dunes and plants"));
    const Plane earlier = run.sand();
    SAHEL_TRY(run.advance(20, setup, 0.9, 0.1, "dunes and plants"));
    const Plane sand = run.sand();
    std::array<double, k_discs> moved{}, thick{}, cells{}, steepest{};
    for (int32_t y = 0; y < n; ++y)
        for (int32_t x = 0; x < n; ++x) {
            const int i = disc_of(x, y, 0.8);
            if (i < 0) continue;
            const auto at = static_cast<size_t>(i);
            moved[at] += std::abs(sand.at(x, y) - earlier.at(x, y));
            thick[at] += sand.at(x, y);
            cells[at] += 1.0;
        }
    for (int i = 0; i < k_discs; ++i) {
        Plane inside = sand; // only cells well inside count
        for (int32_t y = 0; y < n; ++y)
            for (int32_t x = 0; x < n; ++x)
                if (disc_of(x, y, 0.8) != i) inside.at(x, y) = 0.0f;
        const SlopeExcess e = slope_excess(sand, inside, 0.0);
        steepest[static_cast<size_t>(i)] = std::atan(e.p99) * 180.0 / k_pi;
    }
    Report report;
    report.columns = 1;
    report.picture_px = 768;
    Table table{"inside discs of plants",
                {"density", "mean sand [m]", "change in 20 s [m]", "slope, 99th percentile [deg]"},
                {}};
    for (size_t i = 0; i < k_discs; ++i)
        table.rows.push_back({fmt::format("{:.2f}", density(static_cast<int>(i))),
                              fmt::format("{:.2f}", thick[i] / cells[i]), fmt::format("{:.3f}", moved[i] / cells[i]),
                              fmt::format("{:.1f}", steepest[i])});
    report.tables.push_back(std::move(table));
    report.require("sand moved under the densest plants over open ground", moved[3] / moved[0], "", 0.0, 0.5);
    report.require("mean sand under the densest plants over open ground", thick[3] / thick[0], "", 1.05, std::nullopt,
                   "sand that arrives stays");
    report.require("steepest slopes under the densest plants", steepest[3], "deg", steepest[0], 45.5,
                   fmt::format("open ground {:.1f} deg; repose 33 and 45", steepest[0]));
    if (setup.pictures)
        report.pictures.push_back(
            {ground_picture(run), "discs of plants, density 0, 1/3, 2/3, 1 from the top; wind to the right"});
    return report;
}

} // namespace sahel::experiments
