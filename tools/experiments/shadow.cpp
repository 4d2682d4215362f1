#include "tools/experiments/dune_run.h"
#include "tools/experiments/experiment.h"
#include "tools/experiments/measure_crests.h"
#include "tools/experiments/measure_relief.h"
#include "tools/experiments/pictures.h"
#include "tools/experiments/presets.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

/// Shelter looked for along a line or along the bent wind: the paper finds nearly no difference between the landscapes.
namespace sahel::experiments {

Result<Report> run_shadow(const Setup& setup) {
    Report report;
    report.picture_px = 512;
    struct Facts {
        double cover, spread, highest, crest, coherence;
    };
    std::array<Facts, 2> facts{};
    std::array<Plane, 2> shelter;
    for (const int curved : {0, 1}) {
        DuneRunDesc desc;
        desc.cells_x = desc.cells_y = setup.extent.size_cells;
        desc.wind = published_wind(5.0f);
        desc.sand.reptation_smooth = 1.0f;
        desc.sand.shadow_curved = curved == 1;
        desc.ground = noisy_sheet(0.5, 2.0);
        SAHEL_ASSIGN(DuneRun run, DuneRun::create(desc, setup));
        const char* name = curved ? "along the bent wind" : "along a line";
        SAHEL_TRY(run.advance(setup.extent.steps, setup, 0.5 * curved, 0.5, name));
        const Plane sand = run.sand();
        const CrestAngle crest = crest_angle(sand);
        Facts& f = facts[static_cast<size_t>(curved)];
        f = {coverage_of(sand, 0.1), deviation_of(sand), largest_of(sand), crest.angle_deg, crest.coherence};
        shelter[static_cast<size_t>(curved)] = run.plane(SimLayer::wind_shadow);
        if (setup.pictures)
            report.pictures.push_back(
                {ground_picture(run), fmt::format("shelter {}\ncover {:.2f}, deviation {:.2f} m, highest {:.1f} m",
                                                  name, f.cover, f.spread, f.highest)});
    }
    // A handful of dunes fill the domain at the end: one that merges a little earlier moves these by some per cent.
    const auto alike = [&](const char* what, double curved, double linear) {
        report.require(fmt::format("{}, curved over linear", what), curved / linear, "", 0.85, 1.15);
    };
    alike("cover", facts[1].cover, facts[0].cover);
    alike("deviation of sand", facts[1].spread, facts[0].spread);
    alike("mean shelter", mean_of(shelter[1]), mean_of(shelter[0]));
    const double turned = line_angle_between(facts[0].crest, facts[1].crest);
    const bool lines = std::min(facts[0].coherence, facts[1].coherence) > 0.3; // else crests have no common line
    report.require_where(lines, "angle between crests", turned, "deg", 0.0, 15.0,
                         fmt::format("coherence {:.2f} and {:.2f}", facts[0].coherence, facts[1].coherence));
    report.tell("highest dune, curved over linear", facts[1].highest / facts[0].highest, "");
    return report;
}

} // namespace sahel::experiments
