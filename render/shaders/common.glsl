// Shared by every shader. Axes: x east, y up, z south; everything is relative to the eye.
layout(std140, binding = 0) uniform Frame {
    mat4 view_projection;
    mat4 inverse_view_projection;
    vec4 eye;          // x, z: fraction of the eye's cell, m; y: height, m; w: time, s
    vec4 lod;          // x: eye above ground, m; y: lod factor; z: cell size, m; w: sample index (hashed alpha)
    vec4 sun;          // direction to the sun
    vec4 sun_light;    // irradiance
    vec4 light_up;     // ambient from above
    vec4 light_side;
    vec4 light_ground;
    vec4 haze;         // x: per m at the eye's height reference, y: scale height m, z: Rayleigh scale, w: eye above the reference, m
    vec4 screen;       // x: exposure, y: width, z: height, w: pixel angle
    vec4 wind;         // xy: downwind (east, south), z: strength 0..1, w: ripple phase of the eye (turns, 0.34 m)
    vec4 look;         // x: sand hue, y: cloud cover, z: silt, w: strata
    vec4 rock;         // x, y: grey from / to, z: snow from, m; w: ripple phase of the eye (turns, 2.3 m)
    vec4 noise_phase[4]; // where the eye is in the noise texture, per size: n1 n2 | n3 n4 | blurred, clouds | clouds 2, 3
    vec4 wall_phase;   // of the eye in the noise texture, x and z unturned: xy 0.047, zw 0.3 a metre
    vec4 grain_phase;  // xy: of the eye in 8192 m
    vec4 contour_phase[3]; // along 12 directions, 0.047 a metre
    vec4 ripple_phase[12]; // of the eye (turns; 0.34 m, 2.3 m), for 24 directions, two to a vector
    ivec4 mode;        // x: debug view, z: samples of the picture
};

const float k_pi = 3.14159265;
const int k_slot_values = 2 * (257 * 257 + 129 * 129 + 65 * 65); // heights of a tile, see terrain_nodes.h
layout(binding = 4) uniform sampler2D sky_table;
layout(binding = 5) uniform sampler2D noise_map;

vec3 sky_radiance(vec3 d) {
    float elevation = asin(clamp(d.y, 0.0, 1.0));
    float azimuth = acos(clamp(dot(normalize(d.xz + 1e-6), normalize(sun.xz)), -1.0, 1.0));
    return texture(sky_table, vec2(azimuth / k_pi * 127.0 / 128.0 + 0.5 / 128.0,
                                   sqrt(elevation / (k_pi / 2.0)) * 63.0 / 64.0 + 0.5 / 64.0)).rgb;
}

// Aerial perspective over a path: what remains of the colour, and the light of the air in between. The air's colour is
// the sky's just above the horizon in that direction, so far land melts into exactly what is behind it.
void aerial(vec3 rel, out vec3 kept, out vec3 added) {
    float d = length(rel);
    vec3 v = rel / d;
    float k = rel.y / haze.y;
    float mean = abs(k) < 1e-3 ? 1.0 : (1.0 - exp(-k)) / k;
    float hazy = haze.x * d * exp(-max(haze.w, 0.0) / haze.y) * mean;
    vec3 tau = hazy * vec3(0.92, 1.0, 1.12) + haze.z * vec3(5.8e-6, 13.5e-6, 33.1e-6) * d;
    kept = exp(-tau);
    added = sky_radiance(normalize(vec3(v.x, max(v.y, 0.035), v.z))) * (1.0 - kept);
}

vec3 ambient(vec3 n) {
    return mix(light_ground.rgb, light_up.rgb, 0.5 + 0.5 * n.y) +
           light_side.rgb * max(0.0, dot(n.xz, normalize(sun.xz)));
}

float gradient_noise_1(vec2 pixel) { // interleaved gradient noise (Jimenez)
    return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715))));
}

// Index of the sample within its picture.
float sample_index() {
    return lod.w;
}
