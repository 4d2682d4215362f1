#include "tools/experiments/pictures.h"

#include "render/field_picture.h"

namespace sahel::experiments {

namespace {

/// Enlarged little: sheets give each picture some 400 to 500 pixels.
constexpr int k_least_side_px = 384;

} // namespace

Image relief_picture(const Plane& height) {
    GroundFields fields;
    fields.width = height.width;
    fields.height = height.height;
    fields.cell_m = height.cell_m;
    fields.bedrock_m = height.values;
    GroundColours colours;
    colours.bedrock = colours.sand;
    return make_ground_picture(fields, colours, {}, k_least_side_px);
}

Image ground_picture(const DuneRun& run) {
    const DuneRunDesc& desc = run.desc();
    const Plane bedrock = run.bedrock();
    const Plane sand = run.sand();
    Plane plants;
    CellMask object;
    GroundFields fields;
    fields.width = desc.cells_x;
    fields.height = desc.cells_y;
    fields.cell_m = desc.cell_m;
    fields.bedrock_m = bedrock.values;
    fields.sand_m = sand.values;
    if (desc.ground.vegetation) {
        plants = Plane::made(desc.cells_x, desc.cells_y, desc.cell_m, desc.ground.vegetation);
        fields.vegetation = plants.values;
    }
    if (desc.ground.object) {
        object = CellMask::made(desc.cells_x, desc.cells_y, desc.cell_m, desc.ground.object);
        fields.object = object.values;
    }
    return make_ground_picture(fields, {}, {}, k_least_side_px);
}

Image value_picture(const Plane& values, double low, double high, const std::string& title, const std::string& unit) {
    FieldPictureOptions options;
    options.title = title;
    options.unit = unit;
    options.palette = low < 0.0 && high > 0.0 ? FieldPalette::balance : FieldPalette::viridis;
    options.low = static_cast<float>(low);
    options.high = static_cast<float>(high);
    options.least_side_px = k_least_side_px;
    return make_field_picture(values.values, values.width, values.height, options);
}

} // namespace sahel::experiments
