#include "render/scene_pictures.h"

#include "render/contact_sheet.h"
#include "world/exr_image.h"
#include "world/file_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace sahel {

namespace {

using Plane = std::vector<float>;

struct Fields {
    Plane bedrock, soil, sand, airborne, water, vegetation;
    Plane shadow, wind_x, wind_y, repose, echo; ///< empty before the first step
};

Result<Fields> read_fields(const SceneRun& run) {
    Fields f;
    const auto read = [&](SimLayer layer, Plane& to) -> Status {
        SAHEL_ASSIGN(to, run.field(layer));
        return {};
    };
    SAHEL_TRY(read(SimLayer::bedrock, f.bedrock));
    SAHEL_TRY(read(SimLayer::soil, f.soil));
    SAHEL_TRY(read(SimLayer::sand, f.sand));
    SAHEL_TRY(read(SimLayer::airborne_sand, f.airborne));
    SAHEL_TRY(read(SimLayer::water, f.water));
    SAHEL_TRY(read(SimLayer::vegetation, f.vegetation));
    if (run.steps() == 0) return f;
    SAHEL_TRY(read(SimLayer::wind_shadow, f.shadow));
    SAHEL_TRY(read(SimLayer::wind_x, f.wind_x));
    SAHEL_TRY(read(SimLayer::wind_y, f.wind_y));
    SAHEL_TRY(read(SimLayer::repose, f.repose));
    SAHEL_TRY(read(SimLayer::echo, f.echo));
    return f;
}

GroundFields ground_of(const Fields& f, const Scene& scene, const SceneRun& run) {
    GroundFields g;
    g.width = run.width();
    g.height = run.height();
    g.cell_m = scene.cell_m;
    g.bedrock_m = f.bedrock;
    g.soil_m = f.soil;
    g.sand_m = f.sand;
    g.water_m = f.water;
    g.vegetation = f.vegetation;
    g.resistance = run.ground().resistance;
    g.object = run.ground().object;
    g.wind_shadow = f.shadow;
    g.echo = f.echo;
    return g;
}

bool any(const Plane& values) {
    return std::any_of(values.begin(), values.end(), [](float v) { return v != 0.0f; });
}

} // namespace

GroundColours scene_colours(const Scene& scene) {
    const SceneValues& v = scene.values;
    GroundColours c;
    c.sand = v.sand_colour;
    c.bedrock = v.bedrock_colour;
    c.soil = v.soil_colour;
    c.water = v.water_colour;
    c.vegetation = v.vegetation_colour;
    c.object = v.object_colour;
    c.shadow = v.shadow_colour;
    c.erosion = v.erosion_colour;
    c.sticky = v.sticky_colour;
    return c;
}

Result<Image> make_scene_picture(const Scene& scene, const SceneRun& run, int least_side_px) {
    SAHEL_ASSIGN(const Fields f, read_fields(run));
    return make_ground_picture(ground_of(f, scene, run), scene_colours(scene), {}, least_side_px);
}

Status write_scene_pictures(const std::filesystem::path& folder, const Scene& scene, const SceneRun& run,
                            const std::string& title) {
    SAHEL_TRY(make_folder(folder));
    SAHEL_ASSIGN(const Fields f, read_fields(run));
    const int width = run.width();
    const int height = run.height();
    std::vector<std::pair<std::string, Image>> pictures;
    pictures.emplace_back("height", make_ground_picture(ground_of(f, scene, run), scene_colours(scene)));
    const auto field = [&](const std::string& name, const Plane& values, FieldPictureOptions o) {
        pictures.emplace_back(name, make_field_picture(values, width, height, o));
    };
    field("sand", f.sand, {.title = "sand", .unit = "m", .palette = FieldPalette::sand, .low = 0.0f});
    if (!f.shadow.empty()) {
        field("shadow", f.shadow, {.title = "wind shadow", .low = 0.0f, .high = 1.0f});
        pictures.emplace_back("wind",
                              make_wind_picture(f.wind_x, f.wind_y, width, height, {.title = "wind", .unit = "m/s"}));
    }
    if (any(f.vegetation)) field("plants", f.vegetation, {.title = "plants", .low = 0.0f, .high = 1.0f});
    if (any(f.water))
        field("water", f.water, {.title = "water", .unit = "m", .palette = FieldPalette::water, .low = 0.0f});

    const PngText text = {{"Title", title}, {"Scene", scene.name}, {"Step", std::to_string(run.steps())}};
    std::vector<ContactSheetItem> items;
    for (const auto& [name, image] : pictures) {
        SAHEL_TRY(write_png(folder / (name + ".png"), image, text, k_png_level_small));
        items.push_back({&image, name == "height" ? "ground" : name});
    }
    SAHEL_ASSIGN(const Image sheet, make_contact_sheet(items, {.title = title}));
    SAHEL_TRY(write_png(folder / "sheet.png", sheet, text, k_png_level_small));

    ExrImage exr{width, height, {}};
    exr.planes = {{"bedrock", f.bedrock},   {"soil", f.soil},   {"sand", f.sand},
                  {"airborne", f.airborne}, {"water", f.water}, {"vegetation", f.vegetation}};
    exr.planes.push_back({"object", Plane(run.ground().object.begin(), run.ground().object.end())});
    if (!f.shadow.empty()) {
        exr.planes.push_back({"shadow", f.shadow});
        exr.planes.push_back({"wind.x", f.wind_x});
        exr.planes.push_back({"wind.y", f.wind_y});
        exr.planes.push_back({"repose", f.repose});
    }
    return write_exr_image(folder / "fields.exr", exr);
}

} // namespace sahel
