#include "tools/experiments/dune_kinds.h"

#include "tools/experiments/measure_crests.h"
#include "tools/experiments/measure_dunes.h"
#include "tools/experiments/measure_relief.h"
#include "tools/experiments/pictures.h"
#include "tools/experiments/presets.h"

#include <fmt/format.h>

#include <algorithm>

namespace sahel::experiments {

namespace {

Result<DuneRun> run_kind(const Setup& setup, Stretch work, const DuneRunDesc& desc, int64_t steps, const char* name) {
    SAHEL_ASSIGN(DuneRun run, DuneRun::create(desc, setup));
    SAHEL_TRY(run.advance(steps, setup, work.share, work.part, name));
    return run;
}

DuneRunDesc square(const Setup& setup) {
    DuneRunDesc desc;
    desc.cells_x = desc.cells_y = setup.extent.size_cells;
    desc.sand.reptation_smooth = 1.0f; // gentler windward sides
    return desc;
}

void add_picture(const Setup& setup, const DuneRun& run, Report& report, std::string caption) {
    if (setup.pictures) report.pictures.push_back({ground_picture(run), std::move(caption)});
}

} // namespace

Status barchans(const Setup& setup, Stretch work, Report& report) {
    // Little sand on rock under one wind, which blows aslant to the axes so that horns are not drawn out along rows.
    constexpr float k_wind_deg = 25.0f;
    DuneRunDesc desc = square(setup);
    desc.wind = plain_wind(5.0f, k_wind_deg);
    desc.ground = noisy_sheet(0.5, 2.0);
    const int64_t steps = (setup.quick ? 3 : 1) * setup.extent.steps;
    SAHEL_ASSIGN(const DuneRun run, run_kind(setup, work, desc, steps, "barchans"));
    const Plane sand = run.sand();
    int separate = 0;
    int crescents = 0;
    for (const Dune& d : find_dunes(sand, 0.3)) {
        if (d.spans || d.height_m < 2.0 || d.volume_m3 < 300.0) continue;
        ++separate;
        crescents += barchan_shape(d, sand, k_wind_deg).is_barchan();
    }
    const double cover = coverage_of(sand, 0.1);
    const SidesAlong sides = sides_along(run.surface(), k_wind_deg);
    report.require("barchans: ground covered", cover, "", 0.05, 0.6, "bare rock between dunes");
    report.require("barchans: separate dunes", separate, "", setup.quick ? 1.0 : 5.0, std::nullopt);
    report.require("barchans: of them with both horns downwind", separate > 0 ? double(crescents) / separate : 0.0, "",
                   setup.quick ? 0.5 : 0.6, std::nullopt);
    report.tell("barchans: lee slope over windward slope", sides.falling / sides.rising, "");
    add_picture(setup, run, report,
                fmt::format("barchans: one wind, {:.2f} m of sand\n{} of {} dunes with horns downwind, cover {:.2f}",
                            mean_of(sand), crescents, separate, cover));
    return {};
}

Status transverse_dunes(const Setup& setup, Stretch work, Report& report) {
    constexpr float k_wind_deg = 25.0f;
    DuneRunDesc desc = square(setup);
    desc.wind = plain_wind(5.0f, k_wind_deg);
    desc.ground = noisy_sheet(8.0, 10.0);
    SAHEL_ASSIGN(const DuneRun run, run_kind(setup, work, desc, setup.extent.steps, "transverse dunes"));
    const Plane surface = run.surface();
    const CrestAngle crest = crest_angle(surface);
    const SidesAlong sides = sides_along(surface, k_wind_deg);
    report.require("transverse: crests from straight across the wind",
                   line_angle_between(crest.angle_deg, k_wind_deg + 90.0), "deg", 0.0, 15.0);
    report.require("transverse: coherence of crests", crest.coherence, "", 0.5, std::nullopt);
    report.tell("transverse: lee slope over windward slope", sides.falling / sides.rising, "");
    report.tell("transverse: deviation of height", deviation_of(surface), "m");
    add_picture(
        setup, run, report,
        fmt::format("transverse dunes: one wind, 9 m of sand\ncrests at {:.0f} deg (wind {:.0f}), coherence {:.2f}",
                    crest.angle_deg, k_wind_deg, crest.coherence));
    return {};
}

Status linear_dunes(const Setup& setup, Stretch work, Report& report) {
    // Two winds of equal strength at 120 degrees: both modes of growth lie along their resultant.
    constexpr float k_first_deg = -35.0f;
    constexpr float k_second_deg = 85.0f;
    DuneRunDesc desc = square(setup);
    desc.wind = plain_wind(5.0f, k_first_deg);
    desc.wind.bidirectional = true;
    desc.wind.second_angle_deg = k_second_deg;
    desc.wind.ratio = 1.0f;
    desc.wind.period_s = 15.0f;
    desc.ground = noisy_sheet(2.0, 3.0);
    SAHEL_ASSIGN(const DuneRun run, run_kind(setup, work, desc, 2 * setup.extent.steps, "linear dunes"));
    const TwoModes modes = two_modes({{1.0, k_first_deg}, {1.0, k_second_deg}});
    const Plane sand = run.sand();
    const CrestAngle crest = crest_angle(sand);
    const SidesAlong sides = sides_along(sand, modes.resultant_deg + 90.0);
    report.require("linear: crests from the resultant wind", line_angle_between(crest.angle_deg, modes.resultant_deg),
                   "deg", 0.0, 15.0, fmt::format("resultant {:.0f} deg", modes.resultant_deg));
    report.require("linear: coherence of crests", crest.coherence, "", 0.4, std::nullopt);
    report.require("linear: steeper flank over gentler",
                   std::max(sides.rising, sides.falling) / std::min(sides.rising, sides.falling), "", std::nullopt, 1.5,
                   "both faces alternate");
    add_picture(
        setup, run, report,
        fmt::format(
            "linear dunes: two equal winds 120 deg apart\ncrests at {:.0f} deg (resultant {:.0f}), coherence {:.2f}",
            crest.angle_deg, modes.resultant_deg, crest.coherence));
    return {};
}

Status star_dunes(const Setup& setup, Stretch work, Report& report) {
    // Three winds from all sides in turn: sand is heaped, not carried away.
    DuneRunDesc desc = square(setup);
    desc.wind = plain_wind(5.0f, 0.0f);
    constexpr std::array<float, 3> k_turn = {10.0f, 130.0f, 250.0f};
    constexpr double k_turn_s = 16.0; // two epochs
    std::vector<WindSchedule::Row> rows;
    for (size_t i = 0; i < k_turn.size(); ++i) rows.push_back({k_turn_s * static_cast<double>(i), {5.0f, k_turn[i]}});
    SAHEL_ASSIGN(desc.schedule, WindSchedule::from_rows(rows, k_turn_s * static_cast<double>(k_turn.size())));
    desc.ground = noisy_sheet(1.0, 3.0);
    SAHEL_ASSIGN(const DuneRun run, run_kind(setup, work, desc, 2 * setup.extent.steps, "star dunes"));
    const Plane sand = run.sand();
    const CrestAngle crest = crest_angle(sand);
    // Arms of the highest dunes, on a circle well outside their tops.
    int stars = 0;
    int peaks = 0;
    for (const Dune& d : find_dunes(sand, 0.5 * double(largest_of(sand)))) {
        if (d.area_m2 < 30.0 || peaks == 12) continue;
        ++peaks;
        stars += count_arms(sand, d.x_m, d.y_m, 1.5 * d.height_m) >= 3;
    }
    const double share = peaks > 0 ? double(stars) / peaks : 0.0;
    report.require("star: coherence of crests", crest.coherence, "", std::nullopt, 0.35, "no direction is preferred");
    report.require("star: peaks with three arms or more", share, "", 0.4, std::nullopt, fmt::format("of {}", peaks));
    report.require("star: highest dune over mean thickness", largest_of(sand) / mean_of(sand), "", 2.5, std::nullopt);
    add_picture(setup, run, report,
                fmt::format("star dunes: three winds in turn, 120 deg apart\n{} of {} peaks with three arms or more, "
                            "highest {:.1f} m",
                            stars, peaks, largest_of(sand)));
    return {};
}

} // namespace sahel::experiments
