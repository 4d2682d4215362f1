// CDLOD grid (Strugar 2009) with an exact morph: a vertex is an integer corner, its height a fetched float, and at the
// far end of its node's range it is the coarser node's vertex, bit for bit.
layout(location = 0) in vec3 grid;        // 0..32, 0..32, 1 on the skirt
layout(location = 1) in ivec4 node;       // first corner (level 0 cells from the eye's cell), cells per step, tile layer
layout(location = 2) in ivec4 own;        // lattice: first value, stride, corner x, y
layout(location = 3) in ivec4 coarse;     // lattice of the coarser node: first value (-1: none), stride, corner x, y
layout(location = 4) in vec4 params;      // morph start, end (m), skirt depth (m), forced morph
layout(location = 5) in vec4 place;       // cells of the tile at the first corner, cells per step, level

layout(std430, binding = 1) readonly buffer Heights { float heights[]; };

out vec3 rel;
out vec2 tile_cell;
out float morph;
flat out int layer;
flat out ivec3 parent; // of the tile where the coarser node is the parent's: its layer, the tile's quarter; else -1
flat out float level;
out vec3 air_kept;
out vec3 air_added;

vec2 corner(ivec2 g) {
    return vec2(node.xy + g * node.z) * lod.z - eye.xz;
}

void main() {
    ivec2 g = ivec2(grid.xy);
    ivec2 even = g & ~1;
    vec2 p0 = corner(g);
    float d = length(vec3(p0, lod.x));
    float m = coarse.x < 0 ? 0.0 : max(clamp((d - params.x) / (params.y - params.x), 0.0, 1.0), params.w);
    float h0 = heights[own.x + (own.w + g.y) * own.y + own.z + g.x];
    float h = h0;
    vec2 p = p0;
    vec2 cell = vec2(g);
    if (m > 0.0) { // a * (1 - m) + b * m is exactly b at m = 1
        vec2 p1 = corner(even);
        float h1 = heights[coarse.x + (coarse.w + even.y / 2) * coarse.y + coarse.z + even.x / 2];
        p = p0 * (1.0 - m) + p1 * m;
        h = h0 * (1.0 - m) + h1 * m;
        cell = vec2(g) * (1.0 - m) + vec2(even) * m;
    }
    rel = vec3(p.x, h - eye.y - dot(p, p) / (2.0 * 6371000.0), p.y);
    rel.y -= grid.z * params.z;
    tile_cell = place.xy + cell * place.z;
    morph = m;
    layer = node.w;
    parent = coarse.x >= 0 && place.z == 8.0 ? ivec3(coarse.x / k_slot_values, coarse.zw / 32) : ivec3(-1);
    level = place.w;
    aerial(rel, air_kept, air_added);
    gl_Position = view_projection * vec4(rel, 1.0);
}
