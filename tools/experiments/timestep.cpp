#include "tools/experiments/dune_run.h"
#include "tools/experiments/experiment.h"
#include "tools/experiments/measure_relief.h"
#include "tools/experiments/pictures.h"
#include "tools/experiments/plot.h"
#include "tools/experiments/presets.h"

#include <fmt/format.h>

#include <array>

/// Amounts are rates: half the step moves half as much, twice as often. From a smooth bed (noise would grow into
/// different dunes) the landscape after 100 s is compared for steps of 2, 1, 1/2 and 1/4 s, at a lift that moves less
/// in a step than makes shelter of its own (0.05 m on cells of 1 m; a rise of tan 10 deg = 0.18 m does). The published
/// lift of 1 m/s at steps of 1 s moves a metre at once: there the roughness of each step grows into dunes, and the
/// result belongs to the step. It is told beside.
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
        return n / 128.0 * // the same slopes in every size
               (8.0 + 1.6 * std::sin(2.0 * u + std::sin(v)) + 1.2 * std::sin(3.0 * u - v + 1.0) +
                0.8 * std::sin(u + 2.0 * v));
    };
    constexpr std::array<float, 4> k_steps = {2.0f, 1.0f, 0.5f, 0.25f};
    const Plane start = Plane::made(n, n, 1.0, desc.ground.sand_m);
    Report report;
    report.columns = 4;
    report.picture_px = 320;
    const auto apart = [](const Plane& a, const Plane& b) {
        Plane d = a;
        for (size_t i = 0; i < d.values.size(); ++i) d.values[i] -= b.values[i];
        return deviation_of(d);
    };
    constexpr std::array<float, 2> k_lifts = {0.05f, 1.0f};
    for (size_t k = 0; k < k_lifts.size(); ++k) {
        const bool fine = k == 0;
        desc.sand.lift_rate_m_per_s = k_lifts[k];
        const std::string at = fmt::format("lift {} m/s", k_lifts[k]);
        Table table{fmt::format("{}, after {:.0f} s", at, time_s),
                    {"step", "deviation", "highest", "in the air", "sweeps a second"},
                    {}};
        std::array<Plane, 4> end;
        for (size_t i = 0; i < k_steps.size(); ++i) {
            desc.sand.step_s = k_steps[i];
            desc.wind.epoch_steps = std::max(static_cast<int>(8.0f / k_steps[i]), 1); // an epoch is 8 s
            SAHEL_ASSIGN(DuneRun run, DuneRun::create(desc, setup));
            const int64_t steps = std::lround(time_s / static_cast<double>(k_steps[i]));
            SAHEL_TRY(run.advance(steps, setup, 0.5 * static_cast<double>(k) + 0.125 * static_cast<double>(i), 0.125,
                                  fmt::format("{}, steps of {} s", at, k_steps[i])));
            end[i] = run.sand();
            table.rows.push_back({fmt::format("{} s", k_steps[i]), fmt::format("{:.3f} m", deviation_of(end[i])),
                                  fmt::format("{:.2f} m", largest_of(end[i])),
                                  fmt::format("{:.3f} m", mean_of(run.plane(SimLayer::airborne_sand))),
                                  fmt::format("{:.1f}", static_cast<double>(run.sweeps()) / time_s)});
            if (setup.pictures)
                report.pictures.push_back({ground_picture(run), fmt::format("{}, steps of {} s\ndeviation {:.2f} m", at,
                                                                            k_steps[i], deviation_of(end[i]))});
        }
        report.tables.push_back(std::move(table));
        const double change = apart(end[1], start);
        report.tell(fmt::format("{}: change of the bed", at), change, "m",
                    "deviation between start and end, steps of 1 s");
        report.tell(fmt::format("{}: steps of 2 s against 1 s, of the change", at), apart(end[0], end[1]) / change, "");
        report.require_where(fine, fmt::format("{}: steps of 1 s against 1/2 s, of the change", at),
                             apart(end[1], end[2]) / change, "", 0.0, 0.05,
                             fine ? "a few per cent" : "a step of 1 s moves more than makes shelter");
        report.require_where(fine, fmt::format("{}: steps of 1/2 s against 1/4 s, of the change", at),
                             apart(end[2], end[3]) / change, "", 0.0, 0.05);
        report.require_where(fine, fmt::format("{}: deviation of sand, 1/2 s over 1 s", at),
                             deviation_of(end[2]) / deviation_of(end[1]), "", 0.98, 1.02);
    }
    return report;
}

} // namespace sahel::experiments
