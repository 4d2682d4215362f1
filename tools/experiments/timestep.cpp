#include "tools/experiments/dune_run.h"
#include "tools/experiments/experiment.h"
#include "tools/experiments/measure_relief.h"
#include "tools/experiments/pictures.h"
#include "tools/experiments/plot.h"
#include "tools/experiments/presets.h"

#include <fmt/format.h>

#include <array>

/// Amounts are rates: half the step moves half as much, twice as often. From a smooth bed (noise would grow into
/// different dunes) the landscape after 100 s is compared for steps of 2, 1, 1/2 and 1/4 s.
namespace sahel::experiments {

Result<Report> run_timestep(const Setup& setup) {
    const int32_t n = setup.extent.size_cells;
    const auto time_s = static_cast<double>(setup.extent.steps); // steps of the published length, 1 s
    DuneRunDesc desc;
    desc.cells_x = desc.cells_y = n;
    desc.wind = plain_wind(4.0f, 15.0f);
    desc.ground.sand_m = [=](int32_t x, int32_t y) {
        const double u = 2.0 * k_pi * x / n;
        const double v = 2.0 * k_pi * y / n;
        return 8.0 + 1.6 * std::sin(2.0 * u + std::sin(v)) + 1.2 * std::sin(3.0 * u - v + 1.0) +
               0.8 * std::sin(u + 2.0 * v);
    };
    constexpr std::array<float, 4> k_steps = {2.0f, 1.0f, 0.5f, 0.25f};
    const Plane start = Plane::made(n, n, 1.0, desc.ground.sand_m);
    std::array<Plane, 4> end;
    std::array<double, 4> air{};
    Report report;
    report.columns = 4;
    report.picture_px = 320;
    Table table{
        fmt::format("after {:.0f} s", time_s), {"step", "deviation", "highest", "in the air", "sweeps a second"}, {}};
    for (size_t i = 0; i < k_steps.size(); ++i) {
        desc.sand.step_s = k_steps[i];
        desc.wind.epoch_steps = std::max(static_cast<int>(8.0f / k_steps[i]), 1); // an epoch is 8 s
        SAHEL_ASSIGN(DuneRun run, DuneRun::create(desc, setup));
        const int64_t steps = std::lround(time_s / static_cast<double>(k_steps[i]));
        SAHEL_TRY(
            run.advance(steps, setup, 0.25 * static_cast<double>(i), 0.25, fmt::format("steps of {} s", k_steps[i])));
        end[i] = run.sand();
        air[i] = mean_of(run.plane(SimLayer::airborne_sand));
        table.rows.push_back({fmt::format("{} s", k_steps[i]), fmt::format("{:.3f} m", deviation_of(end[i])),
                              fmt::format("{:.2f} m", largest_of(end[i])), fmt::format("{:.3f} m", air[i]),
                              fmt::format("{:.1f}", static_cast<double>(run.sweeps()) / time_s)});
        if (setup.pictures)
            report.pictures.push_back({ground_picture(run), fmt::format("steps of {} s\ndeviation {:.2f} m", k_steps[i],
                                                                        deviation_of(end[i]))});
    }
    report.tables.push_back(std::move(table));
    const auto apart = [](const Plane& a, const Plane& b) {
        Plane d = a;
        for (size_t i = 0; i < d.values.size(); ++i) d.values[i] -= b.values[i];
        return deviation_of(d);
    };
    const double change = apart(end[1], start);
    report.tell("change of the bed", change, "m", "deviation between start and end, steps of 1 s");
    report.require("steps of 1 s against 1/2 s, of the change", apart(end[1], end[2]) / change, "", 0.0, 0.1);
    report.require("steps of 1/2 s against 1/4 s, of the change", apart(end[2], end[3]) / change, "", 0.0, 0.1);
    report.tell("steps of 2 s against 1 s, of the change", apart(end[0], end[1]) / change, "");
    report.require("deviation of sand, 1/2 s over 1 s", deviation_of(end[2]) / deviation_of(end[1]), "", 0.95, 1.05);
    return report;
}

} // namespace sahel::experiments
