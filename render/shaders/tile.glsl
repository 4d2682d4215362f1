// Textures of a tile: 512 cells and a border of 8, see view_tile.h.
layout(binding = 0) uniform sampler2DArray tile_normal;
layout(binding = 1) uniform sampler2DArray tile_material;
layout(binding = 2) uniform sampler2DArray tile_bake;
layout(binding = 3) uniform sampler2DArray tile_water;

vec3 tile_uv(vec2 cell, int slot) {
    return vec3((cell + 8.0) / 528.0, float(slot));
}
const float k_water_scale_m = 127.99609; // 32767 / 256
