#include "tools/experiments/dune_run.h"
#include "tools/experiments/experiment.h"
#include "tools/experiments/measure_relief.h"
#include "tools/experiments/pictures.h"
#include "tools/experiments/presets.h"

#include <fmt/format.h>

#include <algorithm>

/// Blown sand wears rock that stands out of it: peaks sink and round off, what is worn becomes sand, and every tick of
/// rock and sand is there in the end (method 5.5, E10).
namespace sahel::experiments {

Result<Report> run_abrasion(const Setup& setup) {
    const int32_t n = setup.extent.size_cells;
    DuneRunDesc desc;
    desc.cells_x = desc.cells_y = n;
    desc.wind = published_wind(5.0f);
    desc.wind.warp_gain = 2.0f;
    desc.wind.bidirectional = true;
    desc.wind.second_angle_deg = 45.0f;
    desc.wind.ratio = 2.0f;
    desc.wind.period_s = 50.0f;
    desc.sand.abrasion = 0.01f;
    const auto hill = [=](int32_t x, int32_t y) { // sharp crests and horns above a plain of sand
        const double u = 2.0 * k_pi * x / n;
        const double v = 2.0 * k_pi * y / n;
        const double a = 1.0 - std::abs(std::sin(1.5 * u + 0.6 * std::sin(v))) * 1.4;
        const double b = 0.55 + 0.45 * std::cos(2.0 * v + std::sin(u));
        return n / 4.0 * std::max(a, 0.0) * b;
    };
    desc.ground.bedrock_m = hill;
    desc.ground.sand_m = [](int32_t, int32_t) { return 1.0; };
    SAHEL_ASSIGN(DuneRun run, DuneRun::create(desc, setup));
    const Plane before = run.bedrock();
    const int64_t ticks = run.solid_ticks();
    SAHEL_TRY(run.advance(setup.extent.steps, setup, 0.0, 1.0, "abrasion"));
    const Plane after = run.bedrock();
    // Sharpness of what stood highest: mean curvature of the top hundredth.
    std::vector<float> sorted = before.values;
    const auto cut = sorted.begin() + static_cast<ptrdiff_t>(0.98 * static_cast<double>(sorted.size()));
    std::nth_element(sorted.begin(), cut, sorted.end());
    const float high = *cut;
    double sharp_before = 0.0, sharp_after = 0.0, worn_top = 0.0, cells = 0.0, worn = 0.0, grown = 0.0;
    for (int32_t y = 0; y < n; ++y)
        for (int32_t x = 0; x < n; ++x) {
            worn += std::max(before.at(x, y) - after.at(x, y), 0.0f);
            grown = std::max(grown, double{after.at(x, y)} - double{before.at(x, y)});
            if (before.at(x, y) < high) continue;
            const auto curvature = [&](const Plane& p) {
                return double{p.at(x + 2, y)} + p.at(x - 2, y) + p.at(x, y + 2) + p.at(x, y - 2) -
                       4.0 * double{p.at(x, y)};
            };
            sharp_before -= curvature(before);
            sharp_after -= curvature(after);
            worn_top += before.at(x, y) - after.at(x, y);
            cells += 1.0;
        }
    Report report;
    report.columns = 3;
    report.picture_px = 420;
    report.require("rock and sand made or lost", static_cast<double>(std::abs(run.solid_ticks() - ticks)), "ticks", 0.0,
                   0.0, "bedrock + soil + sand + sand in the air");
    report.require("highest rock, lowered by", double{largest_of(before)} - double{largest_of(after)}, "m", 0.01,
                   std::nullopt);
    report.require("wear of the highest fiftieth over mean wear",
                   worn_top / cells / (worn / static_cast<double>(before.size())), "", 1.5, std::nullopt,
                   "what stands out wears most");
    report.require("sharpness of the highest fiftieth, after over before", sharp_after / sharp_before, "", std::nullopt,
                   0.98, "peaks round off");
    report.require("rock grown anywhere", grown, "m", 0.0, 0.0);
    report.tell("mean wear", worn / static_cast<double>(before.size()), "m");
    if (setup.pictures) {
        Plane wear = before;
        for (size_t i = 0; i < wear.values.size(); ++i) wear.values[i] -= after.values[i];
        report.pictures.push_back(
            {relief_picture(before), fmt::format("rock at the start, up to {:.1f} m", largest_of(before))});
        report.pictures.push_back(
            {relief_picture(after), fmt::format("rock after {} steps, up to {:.1f} m", run.step(), largest_of(after))});
        report.pictures.push_back({ground_picture(run), "the ground with its sand"});
        report.pictures.push_back({value_picture(wear, 0.0, largest_of(wear), "wear", "m"),
                                   fmt::format("wear, up to {:.2f} m", largest_of(wear))});
    }
    return report;
}

} // namespace sahel::experiments
