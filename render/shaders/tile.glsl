// Textures of a tile: 512 cells and a border of 8, see view_tile.h.
layout(binding = 0) uniform sampler2DArray tile_normal;
layout(binding = 1) uniform sampler2DArray tile_material;
layout(binding = 2) uniform sampler2DArray tile_bake;
layout(binding = 3) uniform sampler2DArray tile_water;
layout(binding = 8) uniform sampler2DArray tile_wind;

// Wind of the last simulated step, m/s east and south: 0 where there was none. See view_tile.h.
vec2 wind_of(vec4 texel) {
    return (texel.xy * 255.0 - 128.0) * (20.0 / 127.0);
}

vec3 tile_uv(vec2 cell, int slot) {
    return vec3((cell + 8.0) / 528.0, float(slot));
}
const float k_water_scale_m = 127.99609; // 32767 / 256

// What a pixel sees of the ground, and where in it this sample looks. The samples of a picture spread along the long
// side of the footprint, each as sharp as its share: as sharp as anisotropic filtering, for one read each.
struct Footprint {
    vec2 p;      // from the eye, m
    vec2 cell;   // of the tile
    float log_m; // log2 of the width to filter over, m
    vec2 chance; // two numbers in 0..1, other ones at every pixel and sample
};
Footprint ground_footprint(vec2 p, vec2 cell, float least_m) {
    vec2 px = dFdx(p), py = dFdy(p), cx = dFdx(cell), cy = dFdy(cell);
    float x2 = dot(px, px), y2 = dot(py, py);
    bool x_long = x2 > y2;
    float longer = max(sqrt(max(x2, y2)), least_m);
    float samples = float(min(mode.z, 8));
    float width = max(max(sqrt(min(x2, y2)), least_m) * min(1.0, 1.2 * inversesqrt(samples)), longer / max(1.0, 1.8 * samples));
    Footprint f;
    // Evenly spread over the samples of a picture, from another start in every pixel.
    f.chance = fract(vec2(gradient_noise_1(gl_FragCoord.xy), gradient_noise_1(gl_FragCoord.yx + vec2(17.0, 31.0))) +
                     sample_index() / float(mode.z));
    float t = mode.z > 1 ? (f.chance.y - 0.5) * (1.0 - width / longer) : 0.0;
    f.p = p + (x_long ? px : py) * t;
    f.cell = cell + (x_long ? cx : cy) * t;
    f.log_m = log2(width);
    return f;
}

// Where to read a tile. As the shape morphs, so do the textures: a share `morph` of the pixels reads the parent's.
struct TilePlace {
    vec3 uv;
    float lod; // of the full-size textures; the bake has one level less
};
TilePlace tile_place(Footprint f, int slot, float tile_level, ivec3 parent, float morph) {
    bool up = parent.x >= 0 && f.chance.x < morph;
    TilePlace p;
    p.uv = up ? tile_uv(0.5 * (f.cell + 512.0 * vec2(parent.yz)), parent.x) : tile_uv(f.cell, slot);
    p.lod = f.log_m - log2(lod.z) - tile_level - (up ? 1.0 : 0.0);
    return p;
}
