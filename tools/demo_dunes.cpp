#include "tools/demo_dunes.h"

#include "render/field_picture.h"
#include "render/video_writer.h"
#include "sim/domain_field.h"
#include "tools/command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace sahel::tools {

namespace {

/// The ground of the run from above, one pixel a cell.
Result<Image> picture_of(const TileDomain& domain, const TileRect& region, double cell_m) {
    SAHEL_ASSIGN(std::vector<float> rock_m, field_of(domain, SimLayer::bedrock));
    SAHEL_ASSIGN(const std::vector<float> soil_m, field_of(domain, SimLayer::soil));
    SAHEL_ASSIGN(const std::vector<float> sand_m, field_of(domain, SimLayer::sand));
    SAHEL_ASSIGN(const std::vector<float> water_m, field_of(domain, SimLayer::water));
    for (size_t i = 0; i < rock_m.size(); ++i) rock_m[i] += soil_m[i];
    GroundFields fields;
    fields.width = (region.x1 - region.x0) * domain.tile_cells();
    fields.height = (region.y1 - region.y0) * domain.tile_cells();
    fields.cell_m = cell_m;
    fields.periodic = false;
    fields.bedrock_m = rock_m;
    fields.sand_m = sand_m;
    fields.water_m = water_m;
    SunLight sun;
    sun.exaggeration = 1.6f; // the same light in every frame
    return make_ground_picture(fields, {}, sun, 256);
}

} // namespace

TileRect tiles_before(const CameraPose& pose, const WorldDesc& desc, int side) {
    const double tile_m = desc.tile_cells * desc.cell_m;
    const double yaw = pose.yaw_deg * std::numbers::pi / 180.0;
    const double ahead_m = 0.4 * side * tile_m;
    const double x_m = pose.eye_m[0] + ahead_m * std::cos(yaw);
    const double y_m = pose.eye_m[1] + ahead_m * std::sin(yaw);
    const auto first = [&](double at_m) { return static_cast<int32_t>(std::lround(at_m / tile_m - 0.5 * side)); };
    const int32_t x0 = first(x_m);
    const int32_t y0 = first(y_m);
    return {x0, y0, x0 + side, y0 + side};
}

Result<DuneAct> blow_dunes(World& world, const TileRect& region, int64_t steps, int every,
                           const std::filesystem::path& video, const std::function<void(int64_t, int64_t)>& progress) {
    RegionOptions options;
    options.region = region;
    SAHEL_ASSIGN(options.simulation, simulation_of(world.desc(), world.folder().string()));
    SAHEL_ASSIGN(RegionRun run, RegionRun::open(world, options));

    const double cell_m = world.desc().cell_m;
    SAHEL_ASSIGN(const Image before, picture_of(run.domain(), region, cell_m));
    VideoSettings settings; // a pixel a cell: sides of tiles are even
    settings.width_px = before.width_px;
    settings.height_px = before.height_px;
    settings.title = "Sahel: wind and sand";
    SAHEL_ASSIGN(VideoWriter writer, VideoWriter::open(video, settings));
    SAHEL_TRY(writer.add_frame(before));
    const double begin = now_s();
    const int64_t first = run.step();
    double drawing_s = 0.0;
    Status drawn;
    SAHEL_ASSIGN(const bool whole, run.run(first + steps, [&](const RegionStep& s) {
        progress(s.step - first, steps);
        if ((s.step - first) % every != 0) return true;
        const double t = now_s();
        const Result<Image> picture = picture_of(s.domain, region, cell_m);
        drawn = picture.ok() ? writer.add_frame(*picture) : Status(picture.error());
        drawing_s += now_s() - t;
        return drawn.ok();
    }));
    SAHEL_TRY(drawn);
    SAHEL_CHECK(whole);
    SAHEL_TRY(writer.finish());
    DuneAct act;
    act.region = region;
    act.steps = steps;
    act.seconds = now_s() - begin;
    act.ms_per_step = (act.seconds - drawing_s) * 1e3 / static_cast<double>(steps);
    act.mcells_per_s = static_cast<double>(run.domain().owned_cells()) / act.ms_per_step * 1e-3;
    act.video = writer.path().string();
    act.note = writer.note();
    return act;
}

} // namespace sahel::tools
