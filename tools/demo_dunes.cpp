#include "tools/demo_dunes.h"

#include "render/field_picture.h"
#include "render/video_writer.h"
#include "tools/command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace sahel::tools {

namespace {

/// The ground of a rectangle of tiles as planes of metres.
struct RegionGround {
    int width = 0, height = 0;
    std::vector<float> bedrock_m, sand_m, water_m;

    Status take(const TileDomain& domain, const TileRect& region) {
        const int n = domain.tile_cells();
        width = (region.x1 - region.x0) * n;
        height = (region.y1 - region.y0) * n;
        SAHEL_TRY(plane(domain, region, {SimLayer::bedrock, SimLayer::soil}, bedrock_m));
        SAHEL_TRY(plane(domain, region, {SimLayer::sand}, sand_m));
        return plane(domain, region, {SimLayer::water}, water_m);
    }

  private:
    Status plane(const TileDomain& domain, const TileRect& region, std::initializer_list<SimLayer> layers,
                 std::vector<float>& out) const {
        const int n = domain.tile_cells();
        std::vector<int32_t> ticks(static_cast<size_t>(n) * static_cast<size_t>(n));
        out.assign(static_cast<size_t>(width) * static_cast<size_t>(height), 0.0f);
        for (const SimLayer layer : layers)
            for (int32_t slot = 0; slot < domain.slots(); ++slot) {
                SAHEL_TRY(domain.store(slot, layer, ticks.data()));
                const TileKey key = domain.layout().tiles[static_cast<size_t>(slot)];
                const auto x0 = static_cast<size_t>((key.x - region.x0) * n);
                for (int y = 0; y < n; ++y) {
                    const auto row = static_cast<size_t>((key.y - region.y0) * n + y) * static_cast<size_t>(width) + x0;
                    for (int x = 0; x < n; ++x)
                        out[row + static_cast<size_t>(x)] += metres_of_ticks(
                            ticks[static_cast<size_t>(y) * static_cast<size_t>(n) + static_cast<size_t>(x)]);
                }
            }
        return {};
    }
};

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

    RegionGround ground;
    Status drawn;
    const auto picture_of = [&](const TileDomain& domain) -> Result<Image> {
        SAHEL_TRY(ground.take(domain, region));
        GroundFields fields;
        fields.width = ground.width;
        fields.height = ground.height;
        fields.cell_m = world.desc().cell_m;
        fields.periodic = false;
        fields.bedrock_m = ground.bedrock_m;
        fields.sand_m = ground.sand_m;
        fields.water_m = ground.water_m;
        SunLight sun;
        sun.exaggeration = 1.6f; // the same light in every frame
        return make_ground_picture(fields, {}, sun, 256);
    };
    SAHEL_ASSIGN(const Image before, picture_of(run.domain()));
    VideoSettings settings; // a pixel a cell: sides of tiles are even
    settings.width_px = before.width_px;
    settings.height_px = before.height_px;
    settings.title = "Sahel: wind and sand";
    SAHEL_ASSIGN(VideoWriter writer, VideoWriter::open(video, settings));
    SAHEL_TRY(writer.add_frame(before));
    const double begin = now_s();
    const int64_t first = run.step();
    double drawing_s = 0.0;
    SAHEL_ASSIGN(const bool whole, run.run(first + steps, [&](const RegionStep& s) {
        progress(s.step - first, steps);
        if ((s.step - first) % every != 0) return true;
        const double t = now_s();
        const Result<Image> picture = picture_of(s.domain);
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
