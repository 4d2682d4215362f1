// One value of a tile instead of the ground's look: the debug views. Not lit, no air.
in vec3 rel;
in vec2 tile_cell;
in float morph;
flat in int layer;
flat in ivec3 parent;
flat in float level;
in vec3 air_kept;
in vec3 air_added;
layout(location = 0) out vec4 colour;

vec3 debug_colour(int view, vec3 n, vec4 material, vec4 bake, vec4 water, vec4 blown, float slope) {
    if (view == 1) return n.xzy * 0.5 + 0.5;
    if (view == 2) return vec3(slope);
    if (view == 3) return vec3(material.r);
    if (view == 4) return vec3(material.g);
    if (view == 5) return vec3(material.b);
    if (view == 6) return vec3(material.a);
    if (view == 7) return vec3(bake.r);
    if (view == 8) return vec3(bake.g);
    if (view == 9) return 0.5 + 0.5 * cos(6.2831853 * (level * 0.137 + vec3(0.0, 0.33, 0.67)));
    if (view == 10) return vec3(morph, 1.0 - morph, 0.2);
    if (view == 11) return water.x > 0.0 ? vec3(0.1, 0.3, 0.3 + 6.0 * water.x) : vec3(0.3 + 3.0 * water.x, 0.25, 0.2);
    if (view == 12) return vec3(water.y);
    if (view == 14) { // hue: where it blows to; brightness: speed, full at 10 m/s
        vec2 v = wind_of(blown);
        float speed = length(v);
        vec3 hue = 0.5 + 0.5 * cos(atan(v.y, v.x) + vec3(0.0, -2.0943951, 2.0943951));
        return speed < 0.2 ? vec3(0.03) : hue * clamp(0.15 + 0.085 * speed, 0.0, 1.0);
    }
    if (view == 15) return vec3(blown.z);
    if (view == 16) return vec3(blown.w);
    return 0.5 + 0.5 * cos(6.2831853 * (float(layer) * 0.381966 + vec3(0.0, 0.33, 0.67)));
}

void main() {
    vec3 uv = tile_uv(tile_cell, layer);
    vec2 stored = texture(tile_normal, uv).rg;
    vec3 n = vec3(stored.x, sqrt(max(0.02, 1.0 - dot(stored, stored))), stored.y);
    vec4 material = texture(tile_material, uv);
    vec4 bake = texture(tile_bake, uv);
    vec4 water = texture(tile_water, uv);
    vec4 blown = texture(tile_wind, uv);
    colour = vec4(debug_colour(mode.x, normalize(n), material, bake, water, blown, 1.0 - n.y), 1.0);
}
