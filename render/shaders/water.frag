// Water over a copy of the ground: refraction, Beer-Lambert, Fresnel, reflections marched on the screen, foam. The shore
// is where the water is shallow, not where two meshes meet.
in vec3 rel;
in vec2 tile_cell;
in float morph;
flat in int layer;
flat in ivec3 parent;
flat in float level;
in vec3 air_kept;
in vec3 air_added;
layout(location = 0) out vec4 colour;
layout(binding = 6) uniform sampler2D ground_colour;
layout(binding = 7) uniform sampler2D ground_depth;

vec3 view_position(vec2 uv, float z) {
    vec4 q = inverse_view_projection * vec4(uv * 2.0 - 1.0, z, 1.0);
    return q.xyz / q.w;
}

vec2 within(vec2 uv) {
    return vec2(clamp(uv.x, 0.001, 0.999), uv.y);
}

void main() {
    vec3 uv = tile_uv(tile_cell, layer);
    float depth = texture(tile_water, uv).x * k_water_scale_m;
    if (depth < -0.05) discard;
    float sun_seen = texture(tile_bake, uv).r;
    float d = length(rel);
    vec3 view = -rel / d;
    vec2 screen_uv = gl_FragCoord.xy / screen.yz;
    float time = eye.w;
    vec2 p = rel.xz;
    vec2 flow = wind.xy * 0.36;
    // Only at scales whose phase is known: others would slide over the lake as the eye moves.
    vec4 a = texture(noise_map, wall_phase.xy + p * 0.047 + flow * time * 0.05);
    vec4 b = texture(noise_map, 4.0 * noise_phase[0].zw + mat2(0.96, 0.28, -0.28, 0.96) * p * 0.188 - flow.yx * time * 0.09);
    vec4 e = texture(noise_map, noise_phase[2].xy + mat2(0.96, 0.28, -0.28, 0.96) * p * 0.021 - flow * time * 0.02);
    float calm = mix(0.25, 1.0, smoothstep(0.0, 4.0, depth));
    vec2 g = ((a.rg - 0.5) * 0.075 + (b.rg - 0.5) * 0.05 + (e.rg - 0.5) * 0.05) * calm / (1.0 + d * 0.006) * (0.4 + wind.z);
    vec3 n = normalize(vec3(-g.x, 1.0, -g.y));
    // Gusts ruffle the water in streaks along the wind. Waves too small to be drawn tilt towards the eye: it sees more of
    // the depth, and the sky from higher up.
    vec4 gust = texture(noise_map, noise_phase[1].zw + mat2(0.8, 0.6, -0.6, 0.8) * p * 0.00071 - flow * time * 0.001);
    vec4 streak = texture(noise_map, noise_phase[1].xy + mat2(0.6, 0.8, -0.8, 0.6) * p * 0.0061 - flow * time * 0.006);
    float ruffled = smoothstep(0.36, 0.64, 0.65 * gust.b + 0.35 * streak.b) * smoothstep(0.2, 2.5, depth) * smoothstep(40.0, 300.0, d) *
                    (0.3 + 0.7 * wind.z) * mix(0.2, 1.0, smoothstep(10.0, 60.0, lod.x));
    float cosine = max(0.02, dot(n, view));
    cosine = mix(cosine, max(cosine, 0.6 * cosine + 0.15), ruffled);
    float fresnel = 0.02 + 0.98 * pow(1.0 - cosine, 5.0);

    vec2 through = screen_uv + g * 0.54 * min(1.0, max(depth, 0.0)) / (1.0 + d * 0.02);
    vec3 bottom = view_position(through, max(texture(ground_depth, through).r, 1e-7));
    if (bottom.y > rel.y + 0.02) {
        through = screen_uv;
        bottom = view_position(screen_uv, max(texture(ground_depth, screen_uv).r, 1e-7));
    }
    float drop = max(0.0, rel.y - bottom.y);
    float path = min(min(length(bottom - rel), 40.0), max(drop, depth) * 2.6);
    vec3 sigma = vec3(0.36, 0.078, 0.062) + vec3(0.10, 0.08, 0.09) * look.z;
    vec3 kept = exp(-sigma * path);
    vec3 body = vec3(0.010, 0.052, 0.048) + look.z * vec3(0.03, 0.035, 0.015);
    vec3 light = sun_light.rgb * max(0.0, sun.y) * sun_seen + light_up.rgb * k_pi;
    vec3 c = texture(ground_colour, through).rgb * kept + body / k_pi * light * (1.0 - kept) * 2.2;

    // Reflection: march the copy of depth on the screen, else the sky.
    vec3 r = reflect(-view, n);
    r.y = max(r.y, 0.01) + 0.12 * ruffled;
    r = normalize(r);
    vec3 mirrored = sky_radiance(r);
    float reach = min(900.0, 40.0 + d * 4.0);
    vec4 q0 = view_projection * vec4(rel, 1.0), q1 = view_projection * vec4(rel + r * reach, 1.0);
    if (q1.w < 0.2) q1 = mix(q0, q1, (q0.w - 0.2) / (q0.w - q1.w));
    vec3 s0 = vec3(q0.xy / q0.w * 0.5 + 0.5, q0.z / q0.w), s1 = vec3(q1.xy / q1.w * 0.5 + 0.5, q1.z / q1.w);
    vec2 span = s1.xy - s0.xy;
    // Beyond the sides of the picture the land goes on as its last column: less wrong than the sky.
    s1 = mix(s0, s1, min(1.0, span.y > 0.0 ? (1.0 - s0.y) / span.y : span.y < 0.0 ? -s0.y / span.y : 9.0));
    float pixels = length((s1.xy - s0.xy) * screen.yz);
    float cut = min(1.0, 280.0 / max(pixels, 1.0));
    s1 = mix(s0, s1, cut);
    pixels *= cut;
    int steps = int(clamp(pixels / 7.0, 8.0, 26.0));
    float jitter = fract(gradient_noise_1(gl_FragCoord.xy) + lod.w * 0.618034); // averaged over the samples of a picture
    // What is found is refined after the loop: a software driver runs both sides of every branch inside it.
    float before = 0.0, at = 2.0;
    for (int i = 0; i < steps; ++i) {
        float t = (float(i) + 0.4 + 0.6 * jitter) / float(steps);
        vec3 s = mix(s0, s1, t);
        float z = texture(ground_depth, within(s.xy)).r;
        if (z > s.z * 1.0015 && 0.1 / s.z - 0.1 / z < 2.0 + 0.025 / s.z) {
            at = t;
            break;
        }
        before = t;
    }
    float hit_at = min(at, 1.0);
    for (int k = 0; k < 5; ++k) {
        float mid = 0.5 * (before + hit_at);
        vec3 m = mix(s0, s1, mid);
        if (texture(ground_depth, within(m.xy)).r > m.z * 1.0015) hit_at = mid; else before = mid;
    }
    vec2 hit = mix(s0.xy, s1.xy, hit_at);
    // Ranges beyond the ray's end are as good as infinitely far: what stands in its direction is what it meets.
    if (at > 1.0) {
        vec4 q2 = view_projection * vec4(r, 0.0);
        vec2 away = q2.xy / max(q2.w, 1e-4) * 0.5 + 0.5;
        float far_m = 0.1 / max(texture(ground_depth, within(away)).r, 1e-7);
        if (q2.w > 0.0 && far_m > 0.8 * reach && far_m < 9e5) {
            hit = away;
            at = 1.0;
        }
    }
    float outside = max(hit.x - 1.0, -hit.x);
    float found = at <= 1.0 ? (1.0 - smoothstep(0.10, 0.35, outside)) * (1.0 - smoothstep(0.42, 0.5, abs(hit.y - 0.5))) : 0.0;
    mirrored = mix(mirrored, texture(ground_colour, within(hit)).rgb, found);
    float half_angle = max(0.0, dot(n, normalize(view + sun.xyz)));
    mirrored += (18.0 * pow(half_angle, 900.0) + 0.9 * pow(half_angle, 140.0)) * sun_light.rgb * sun_seen * 0.35;
    c = mix(c, mirrored, fresnel);

    // Waves break on a slope, not over flats.
    float grade = (abs(dFdx(depth)) + abs(dFdy(depth))) / (length(dFdx(p)) + length(dFdy(p)) + 1e-4);
    float foam = smoothstep(0.006, 0.025, grade) * (1.0 - smoothstep(0.015, 0.10, depth)) * smoothstep(0.42, 0.64, b.b + 0.175 * sin(depth * 38.0 - time * 1.1 + 6.0 * e.b));
    c = mix(c, vec3(0.75) * light / k_pi, foam * 0.45);
    c = c * air_kept + air_added;
    colour = vec4(mix(texture(ground_colour, screen_uv).rgb, c, smoothstep(-0.02, 0.10, depth)), 1.0);
}
