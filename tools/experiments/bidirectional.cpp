#include "tools/experiments/dune_run.h"
#include "tools/experiments/experiment.h"
#include "tools/experiments/measure_crests.h"
#include "tools/experiments/measure_relief.h"
#include "tools/experiments/pictures.h"
#include "tools/experiments/presets.h"

#include <fmt/format.h>

#include <algorithm>

/// Two winds R = 2 at angles of 45, 105 and 150 degrees by four degrees of cover (paper, Figure 3). With all ground
/// covered the crests must lie where most sand crosses them, whichever way (maximum gross bedform-normal transport;
/// Rubin and Hunter, Science 237, 1987), within 15 degrees. Beside it stands the line of the instability of a bed over
/// whose crests the flux grows by 1 + 1.6 |sin a|, as over real dunes: here it grows by the venturi effect alone, a
/// tenth over a dune of 20 m. On a small periodic domain crests lock to whole waves of the domain, and the larger it is
/// the more lines it allows.
namespace sahel::experiments {

namespace {

/// A row of the published scenes.
struct Cover {
    const char* name;
    float share;
    float speed_m_per_s;
    float period_s;
    bool uniform;
    float add_m;
    bool removes;
};
constexpr std::array<Cover, 4> k_covers = {{
    {"7 %", 0.07f, 5.0f, 10.0f, false, 5.0f, false},
    Cover{"22 %", 0.22f, 10.0f, 10.0f, true, 0.5f, true},
    Cover{"64 %", 0.64f, 10.0f, 50.0f, true, 0.5f, true},
    Cover{"100 %", 1.0f, 10.0f, 50.0f, true, 1.0f, false},
}};
constexpr std::array<float, 3> k_angles = {45.0f, 105.0f, 150.0f};

} // namespace

Result<Report> run_bidirectional(const Setup& setup) {
    Report report;
    report.columns = 3;
    report.picture_px = 512;
    // Cells of 2 m: the full form is 1024 m wide, as the lines need. The quick form makes only the row that is judged.
    constexpr double cell_m = 2.0;
    constexpr double k_accept_deg = 15.0;
    Table table{"crest lines [deg]",
                {"cover", "angle", "measured", "coherence", "most gross transport", "instability", "elongation",
                 "cover now", "height"},
                {}};
    const size_t first = setup.quick ? k_covers.size() - 1 : 0;
    const double runs = static_cast<double>((k_covers.size() - first) * k_angles.size());
    double done = 0.0;
    for (size_t c = first; c < k_covers.size(); ++c)
        for (const float angle : k_angles) {
            const Cover& cover = k_covers[c];
            const std::string name = fmt::format("{}, {:.0f} deg", cover.name, angle);
            if (!setup.wants(name)) continue;
            DuneRunDesc desc;
            desc.cells_x = desc.cells_y = setup.extent.size_cells;
            desc.cell_m = cell_m;
            desc.wind = published_wind(cover.speed_m_per_s);
            desc.wind.bidirectional = true;
            desc.wind.second_angle_deg = angle;
            desc.wind.ratio = 2.0f;
            desc.wind.period_s = c == 1 && angle == 150.0f ? 50.0f : cover.period_s;
            desc.sand.supply = true;
            desc.sand.supply_target = cover.share;
            desc.sand.supply_threshold_m = 0.5f;
            desc.sand.supply_uniform = cover.uniform;
            desc.sand.supply_add_m = cover.add_m;
            desc.sand.supply_removes = cover.removes;
            desc.sand.supply_remove_m = 0.1f;
            desc.sand.supply_radius_cells =
                std::max(100 * setup.extent.size_cells / 2048, 8); // the published share of ground
            SAHEL_ASSIGN(DuneRun run, DuneRun::create(desc, setup));
            // Crests lean towards the wind that blew last: their line is the mean over both turns of the last cycle.
            const auto turn = static_cast<int64_t>(desc.wind.period_s);
            constexpr int k_parts = 4; // of a turn
            const int64_t before = std::max<int64_t>(setup.extent.steps - 2 * turn, 0);
            SAHEL_TRY(run.advance(before, setup, done / runs, 0.9 / runs, name));
            std::vector<CrestAngle> lines;
            for (int i = 0; i < 2 * k_parts; ++i) {
                SAHEL_TRY(run.advance((i + 1) * turn / k_parts - i * turn / k_parts));
                lines.push_back(crest_angle(run.sand()));
            }
            done += 1.0;
            const Plane sand = run.sand();
            const CrestAngle crest = mean_line(lines);
            const std::vector<FluxWind> winds = {{2.0, 0.0}, {1.0, angle}};
            const TwoModes modes = two_modes(winds);
            const double gross_deg = two_modes(winds, 0.0).instability_deg;
            const double now = coverage_of(sand, 0.5);
            if (cover.share >= 1.0f)
                report.require(fmt::format("{}: crests from most gross transport", name),
                               line_angle_between(crest.angle_deg, gross_deg), "deg", 0.0, k_accept_deg,
                               fmt::format("{:.1f} deg, expected {:.1f}; instability {:.1f}", crest.angle_deg,
                                           gross_deg, modes.instability_deg));
            else
                report.tell(fmt::format("{}: crest line", name), crest.angle_deg, "deg",
                            fmt::format("gross {:.0f}, instability {:.0f}, elongation {:.0f}, coherence {:.2f}",
                                        gross_deg, modes.instability_deg, modes.elongation_deg, crest.coherence));
            table.rows.push_back({cover.name, fmt::format("{:.0f}", angle), fmt::format("{:.1f}", crest.angle_deg),
                                  fmt::format("{:.2f}", crest.coherence), fmt::format("{:.1f}", gross_deg),
                                  fmt::format("{:.1f}", modes.instability_deg),
                                  fmt::format("{:.1f}", modes.elongation_deg), fmt::format("{:.2f}", now),
                                  fmt::format("{:.1f} m", largest_of(sand))});
            if (setup.pictures)
                report.pictures.push_back(
                    {ground_picture(run),
                     fmt::format(
                         "{}: crests at {:.0f} deg, coherence {:.2f}\nmost gross transport {:.0f}, elongation {:.0f}",
                         name, crest.angle_deg, crest.coherence, gross_deg, modes.elongation_deg)});
        }
    report.tables.push_back(std::move(table));
    return report;
}

} // namespace sahel::experiments
