#include "tools/experiments/dune_run.h"
#include "tools/experiments/experiment.h"
#include "tools/experiments/measure_relief.h"
#include "tools/experiments/pictures.h"
#include "tools/experiments/presets.h"

#include <fmt/format.h>

#include <array>

/// Wind that grows strongly with height over low hills: where it slows down it drops sand, unless
/// the divergence is taken out of it (method 5.5, E9). Measured: how far the mean thickness of
/// sand moved from place to place.
namespace sahel::experiments {

Result<Report> run_venturi(const Setup& setup) {
    const int32_t n = setup.extent.size_cells;
    Report report;
    report.columns = 3;
    report.picture_px = 420;
    const auto hills = [=](int32_t x, int32_t y) { // two or three low peaks, too gentle to make shelter
        const double u = 2.0 * k_pi * x / n;
        const double v = 2.0 * k_pi * y / n;
        const double h = std::sin(u + 0.7) * std::sin(v) + 0.6 * std::sin(2.0 * u + v) * std::sin(v - u + 2.0);
        return n / 30.0 * std::pow(std::clamp(0.5 + 0.4 * h, 0.0, 1.0), 2.0);
    };
    const float gain = 2.5f / (static_cast<float>(n) / 30.0f); // the wind over peaks is 3.5 times that in hollows
    std::array<double, 2> gathered{};
    std::array<double, 2> divergence{};
    const auto radius = static_cast<int32_t>(n / 16);
    for (const int projected : {0, 1}) {
        DuneRunDesc desc;
        desc.cells_x = desc.cells_y = n;
        desc.wind = plain_wind(2.0f, 0.0f);
        desc.wind.venturi_per_m = gain;
        desc.wind.venturi_radius_m = 0.0f;
        desc.wind.project = projected == 1;
        desc.sand.lift_rate_m_per_s = 0.05f; // too little for dunes of its own
        desc.ground.bedrock_m = hills;
        desc.ground.sand_m = [](int32_t, int32_t) { return 20.0; };
        SAHEL_ASSIGN(DuneRun run, DuneRun::create(desc, setup));
        const char* name = projected ? "projected" : "not projected";
        SAHEL_TRY(run.advance(1));
        const Plane wx = run.plane(SimLayer::wind_x);
        const Plane wy = run.plane(SimLayer::wind_y);
        Plane div = wx;
        for (int32_t y = 0; y < n; ++y)
            for (int32_t x = 0; x < n; ++x)
                div.at(x, y) = 0.5f * (wx.at(x + 1, y) - wx.at(x - 1, y) + wy.at(x, y + 1) - wy.at(x, y - 1));
        divergence[static_cast<size_t>(projected)] = deviation_of(box_mean(div, 4));
        SAHEL_TRY(run.advance(setup.extent.steps - 1, setup, 0.5 * projected, 0.5, name));
        const Plane thick = box_mean(run.sand(), radius);
        gathered[static_cast<size_t>(projected)] = deviation_of(thick);
        if (setup.pictures) {
            report.pictures.push_back({ground_picture(run), fmt::format("{}\nmean thickness varies by {:.2f} m", name,
                                                                        gathered[static_cast<size_t>(projected)])});
            report.pictures.push_back({value_picture(thick, 18.0, 22.0, "mean thickness of sand", "m"),
                                       "mean thickness of sand, 18 to 22 m"});
            report.pictures.push_back(
                {value_picture(div, -0.2, 0.2, "divergence", "1/s"), "divergence of the first wind, -0.2 to 0.2 1/s"});
        }
    }
    report.require("divergence of the wind, projected over not", divergence[1] / divergence[0], "", 0.0, 0.2);
    report.tell("mean thickness varies, not projected", gathered[0], "m",
                fmt::format("over squares of {} m", 2 * radius + 1));
    report.tell("mean thickness varies, projected", gathered[1], "m");
    report.require("sand gathered, not projected over projected", gathered[0] / gathered[1], "", 1.5, std::nullopt);
    return report;
}

} // namespace sahel::experiments
