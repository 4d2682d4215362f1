#include "tools/experiments/dune_kinds.h"

#include "tools/experiments/measure_crests.h"
#include "tools/experiments/measure_relief.h"
#include "tools/experiments/pictures.h"
#include "tools/experiments/presets.h"

#include <fmt/format.h>

#include <algorithm>

namespace sahel::experiments {

bool Obstacle::holds(int32_t x, int32_t y, int32_t rim) const {
    const int64_t dx = x - centre_x;
    const int64_t dy = y - centre_y;
    const int64_t r = radius + rim;
    return dx * dx + dy * dy <= r * r || (dx > -(rim > 0) && dx < length + (rim > 0) && std::abs(dy) <= r);
}

Status nabkhas(const Setup& setup, Stretch work, Report& report) {
    // Plants in patches on a thin sheet: sand stays between them and heaps up, with a tail in the lee.
    const int32_t n = setup.extent.size_cells;
    DuneRunDesc desc;
    desc.cells_x = desc.cells_y = n;
    desc.wind = plain_wind(4.0f, 20.0f);
    desc.ground = noisy_sheet(0.2, 0.6);
    constexpr double k_spacing = 42.7;
    constexpr double k_radius = 6.0;
    const int32_t per_side = std::max(static_cast<int32_t>(n / k_spacing), 2);
    const double pitch = double(n) / per_side;
    desc.ground.vegetation = [=](int32_t x, int32_t y) {
        const int32_t row = static_cast<int32_t>(y / pitch);
        const double shifted = std::fmod(x + (row % 2) * pitch / 2.0, double(n)); // rows are staggered
        const int32_t column = static_cast<int32_t>(shifted / pitch);
        const double jx = (cell_noise(7, column, row) - 0.5) * 0.4 * pitch;
        const double jy = (cell_noise(8, column, row) - 0.5) * 0.4 * pitch;
        const double d = std::hypot(shifted - (column + 0.5) * pitch - jx, y + 0.5 - (row + 0.5) * pitch - jy);
        return std::clamp(1.5 * (1.0 - d / k_radius), 0.0, 0.9);
    };
    SAHEL_ASSIGN(DuneRun run, DuneRun::create(desc, setup));
    SAHEL_TRY(run.advance(setup.extent.steps / 2, setup, work.share, work.part, "nabkhas"));
    const Plane sand = run.sand();
    double inside = 0.0, outside = 0.0, inside_cells = 0.0, outside_cells = 0.0, lee = 0.0, lee_cells = 0.0,
           front = 0.0;
    const Vec2 d = unit_of(desc.wind.angle_deg);
    for (int32_t y = 0; y < n; ++y)
        for (int32_t x = 0; x < n; ++x) {
            const double v = desc.ground.vegetation(x, y);
            (v > 0.3 ? inside : outside) += sand.at(x, y);
            (v > 0.3 ? inside_cells : outside_cells) += 1.0;
            if (v < 0.8) continue; // the hearts of patches: compare 12 m downwind with 12 m upwind
            const auto ox = static_cast<int32_t>(std::lround(12.0 * d.x));
            const auto oy = static_cast<int32_t>(std::lround(12.0 * d.y));
            lee += sand.at(x + ox, y + oy);
            front += sand.at(x - ox, y - oy);
            lee_cells += 1.0;
        }
    const double ratio = inside / inside_cells / std::max(outside / outside_cells, 1.0e-6);
    report.require("nabkhas: sand between plants over sand elsewhere", ratio, "", 3.0, std::nullopt);
    report.require("nabkhas: sand 12 m downwind of patches over 12 m upwind", lee / std::max(front, 1.0e-6), "", 1.2,
                   std::nullopt, "tails");
    report.tell("nabkhas: highest", largest_of(sand), "m");
    if (setup.pictures)
        report.pictures.push_back(
            {ground_picture(run),
             fmt::format("nabkhas: plants in patches\nsand there {:.1f} times as thick, {:.1f} m in their lee, "
                         "{:.1f} m before them",
                         ratio, lee / lee_cells, front / lee_cells)});
    return {};
}

Status echo_dune(const Setup& setup, Stretch work, Report& report) {
    // The wind tunnel: a half disc faces the wind; before it lies a strip without sand, then the echo dune.
    DuneRunDesc desc;
    desc.cells_x = setup.extent.size_cells;
    desc.cells_y = std::max(setup.extent.size_cells / 2, 128);
    const double height = setup.quick ? 15.0 : 30.0;
    const Obstacle o{desc.cells_x / 2, desc.cells_y / 2, desc.cells_y / 5, desc.cells_x / 6};
    desc.wind = plain_wind(1.0f, 0.0f);
    desc.sand.echo_rate_m_per_s = 1.0f;
    desc.sand.echo_max_cliff_m = static_cast<float>(height);
    desc.sand.reptation_smooth = 1.0f;
    desc.ground.bedrock_m = [=](int32_t x, int32_t y) { return o.holds(x, y) ? 40.0 : 0.0; };
    desc.ground.object = [=](int32_t x, int32_t y) { return o.holds(x, y, 2); };
    desc.ground.sand_m = [=](int32_t x, int32_t y) { return o.holds(x, y) ? 0.0 : 1.0 + 2.0 * cell_noise(3, x, y); };
    SAHEL_ASSIGN(DuneRun run, DuneRun::create(desc, setup));
    SAHEL_TRY(run.advance(setup.extent.steps, setup, work.share, work.part, "echo dune"));
    const Plane sand = run.sand();
    const double start = mean_of(Plane::made(desc.cells_x, desc.cells_y, 1.0, desc.ground.sand_m));
    const double reach = double{desc.sand.echo_erosion_range} * height;
    const double calm = double{desc.sand.echo_sticky_range} * height;
    // Along lines on the nose: how far bare ground reaches before the rock, and how high the sand stands beyond it.
    double strip = 0.0, ridge = 0.0, ridge_at = 0.0;
    int lines = 0;
    for (int32_t y = o.centre_y - o.radius / 8; y <= o.centre_y + o.radius / 8; ++y, ++lines) {
        int32_t foot = o.centre_x;
        while (o.holds(foot, y)) --foot; // the last free cell before the rock
        int32_t bare = 0;
        while (bare < calm && sand.at(foot - bare, y) < 0.1f) ++bare;
        strip += bare;
        float top = 0.0f;
        int32_t at = 0;
        for (int32_t d = bare; d <= static_cast<int32_t>(calm); ++d)
            if (sand.at(foot - d, y) > top) top = sand.at(foot - d, y), at = d;
        ridge += top;
        ridge_at += at;
    }
    report.require("echo: bare strip before the nose", strip / lines, "m", reach - 3.0, reach + 3.0,
                   fmt::format("erosion range x cliff = {:.0f} m", reach));
    report.require("echo: crest of the echo dune over the sheet", ridge / lines / start, "", 1.5, std::nullopt);
    report.require("echo: its distance from the rock", ridge_at / lines, "m", reach, calm, "within the calm");
    if (setup.pictures)
        report.pictures.push_back(
            {ground_picture(run),
             fmt::format("echo dune: wind tunnel, cliffs act as {:.0f} m\nbare strip {:.1f} m, crest {:.1f} m "
                         "high at {:.0f} m (sheet {:.1f} m)",
                         height, strip / lines, ridge / lines, ridge_at / lines, start)});
    return {};
}

Status dunes_round_obstacle(const Setup& setup, Stretch work, Report& report) {
    // The same shape, and a wind that is turned by it: dunes beside it are crossed by the bent wind.
    const int32_t n = setup.extent.size_cells;
    DuneRunDesc desc;
    desc.cells_x = desc.cells_y = n;
    const Obstacle o{n / 2 - n / 10, n / 2, n / 8, n / 4};
    desc.wind = plain_wind(5.0f, 0.0f);
    desc.sand.reptation_smooth = 1.0f;
    desc.wind.warp = true;
    desc.wind.warp_radius_1_m = static_cast<float>(n) / 5.0f;
    desc.wind.warp_radius_2_m = static_cast<float>(n) / 20.0f;
    const double height_m = 40.0 * n / 256.0; // the same slopes, and so the same turn of the wind, in every size
    desc.ground.bedrock_m = [=](int32_t x, int32_t y) { return o.holds(x, y) ? height_m : 0.0; };
    desc.ground.object = [=](int32_t x, int32_t y) { return o.holds(x, y, 2); };
    desc.ground.sand_m = [=](int32_t x, int32_t y) { return o.holds(x, y) ? 0.0 : 6.0 + 2.0 * cell_noise(4, x, y); };
    SAHEL_ASSIGN(DuneRun run, DuneRun::create(desc, setup));
    // Later crests that hang on the obstacle lag, and lean by more than the wind turns.
    SAHEL_TRY(run.advance(std::min<int64_t>(setup.extent.steps, 200), setup, work.share, work.part,
                          "dunes round an obstacle"));
    const Plane sand = run.sand();
    const Plane wx = run.plane(SimLayer::wind_x);
    const Plane wy = run.plane(SimLayer::wind_y);
    // Upwind of the obstacle's shoulders the wind turns away from its axis, and the crests with it.
    const auto part_of = [&](int side) {
        return CellMask::made(n, n, 1.0, [&, side](int32_t x, int32_t y) {
            const int32_t dy = side * (y - o.centre_y);
            return x > o.centre_x - 3 * o.radius / 2 && x < o.centre_x + o.radius / 2 && dy > o.radius / 4 &&
                   dy < 2 * o.radius && !o.holds(x, y, 6);
        });
    };
    const auto wind_in = [&](const CellMask& mask) {
        double x = 0.0, y = 0.0;
        for (size_t i = 0; i < mask.values.size(); ++i)
            if (mask.values[i]) x += wx.values[i], y += wy.values[i];
        return std::atan2(y, x) * 180.0 / k_pi;
    };
    const CellMask north = part_of(-1);
    const CellMask south = part_of(1);
    const double north_wind = wind_in(north);
    const double south_wind = wind_in(south);
    const CrestAngle north_crest = crest_angle(sand, &north);
    const CrestAngle south_crest = crest_angle(sand, &south);
    report.require("obstacle: wind turned away on the north side", -north_wind, "deg", 5.0, 90.0);
    report.require("obstacle: wind turned away on the south side", south_wind, "deg", 5.0, 90.0);
    report.require("obstacle: crests from straight across the bent wind, north",
                   line_angle_between(north_crest.angle_deg, north_wind + 90.0), "deg", 0.0, 20.0,
                   fmt::format("coherence {:.2f}", north_crest.coherence));
    report.require("obstacle: the same, south", line_angle_between(south_crest.angle_deg, south_wind + 90.0), "deg",
                   0.0, 20.0, fmt::format("coherence {:.2f}", south_crest.coherence));
    const double apart = std::remainder(south_crest.angle_deg - north_crest.angle_deg, 180.0);
    report.require("obstacle: crests of both sides turned apart, as the winds", apart, "deg", 5.0, 60.0,
                   fmt::format("winds {:.0f} deg apart", south_wind - north_wind));
    if (setup.pictures)
        report.pictures.push_back(
            {ground_picture(run),
             fmt::format("warped wind round an obstacle\nwind {:.0f} and {:.0f} deg beside it, crests {:.0f} and "
                         "{:.0f} deg",
                         north_wind, south_wind, north_crest.angle_deg, south_crest.angle_deg)});
    return {};
}

} // namespace sahel::experiments
