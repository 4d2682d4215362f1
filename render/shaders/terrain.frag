// Ground: materials from the layers, ragged by noise inside the thresholds; light from the bakes and the sky.
in vec3 rel;
in vec2 tile_cell;
in float morph;
flat in int layer;
flat in ivec3 parent;
flat in float level;
in vec3 air_kept;
in vec3 air_added;
layout(location = 0) out vec4 colour;

// The noise texture at `uv`, where `scale` of its sides are a metre.
vec4 noise_at(vec2 uv, float scale, float log_m) {
    return textureLod(noise_map, uv, log_m + log2(scale * 512.0));
}

// Relief as fine as the picture resolves, at every distance: two sizes of noise, of which one gives way to the other.
// Texels of the finer one are 2^k m wide.
vec2 grain_of_size(vec2 p, float k) {
    vec2 uv = fract(grain_phase.xy * exp2(4.0 - k)) + p * (exp2(-k) / 512.0);
    return textureLod(noise_map, uv, 0.0).rg - 0.5;
}
vec2 grain(vec2 p, float log_m) {
    float k = clamp(log_m + 0.3, -7.0, 4.0), finer = floor(k);
    return mix(grain_of_size(p, finer), grain_of_size(p, finer + 1.0), k - finer);
}

// Wind ripples, two wavelengths: the gradient they add, and how much darker their troughs are. `fork` are two fields
// per wavelength whose angle turns once round each place where both are 0: there a crest ends, or forks in two.
vec3 ripples(vec2 q, vec2 along, vec2 phase, vec2 strength, float steep, vec4 fork) {
    float u = dot(q, along);
    fork += vec4(1e-6, 0.0, 1e-6, 0.0); // atan(0, 0) is not defined
    float f1 = 2.0 * k_pi * (u / 0.34 + phase.x) + atan(fork.y, fork.x);
    float f2 = 2.0 * k_pi * (u / 2.3 + phase.y) + atan(fork.w, fork.z);
    float r1 = cos(f1 + 0.55 * sin(f1)), r2 = cos(f2 + 0.5 * sin(f2));
    strength *= smoothstep(vec2(0.0), vec2(0.05), vec2(length(fork.xy), length(fork.zw)));
    return vec3(along * (strength.x * r1 * steep + 0.050 * strength.y * r2),
                0.15 * strength.x * (0.5 + 0.5 * sin(f1)) + 0.05 * strength.y * (0.5 + 0.5 * sin(f2)));
}
vec3 simulated_ripples(int direction, vec2 q, vec2 strength, float steep, vec4 fork) {
    float turn = float(direction) * (2.0 * k_pi / 24.0);
    vec4 pair = ripple_phase[direction / 2];
    return ripples(q, vec2(cos(turn), sin(turn)), direction % 2 == 0 ? pair.xy : pair.zw, strength, steep, fork);
}

// Streaks down a slope whose contour runs in one of 12 directions.
void streaks_down(int direction, vec2 p, float down, float log_m, float strength, float depth, inout vec3 n,
                  inout vec3 albedo) {
    float turn = float(direction) * (k_pi / 12.0);
    vec2 along = vec2(cos(turn), sin(turn));
    vec4 streak = noise_at(vec2(contour_phase[direction / 4][direction % 4] + dot(p, along) * 0.047, down), 0.047, log_m);
    albedo *= 1.0 + strength * 0.45 * (streak.b - 0.5);
    n.xz -= along * (strength * depth * (streak.r - 0.5));
}

void main() {
    float d = length(rel);
    vec3 view = -rel / d;
    Footprint foot = ground_footprint(rel.xz, tile_cell, d * screen.w);
    TilePlace place = tile_place(foot, layer, level, parent, morph);
    vec2 stored = textureLod(tile_normal, place.uv, place.lod).rg;
    vec3 ground_n = vec3(stored.x, 0.0, stored.y);
    ground_n.y = sqrt(max(0.02, 1.0 - dot(ground_n.xz, ground_n.xz)));
    ground_n = normalize(ground_n);
    vec4 material = textureLod(tile_material, place.uv, place.lod);
    vec4 bake = textureLod(tile_bake, place.uv, place.lod - 1.0);
    vec4 water = textureLod(tile_water, place.uv, place.lod);
    float height = rel.y + eye.y + dot(rel.xz, rel.xz) / (2.0 * 6371000.0);
    float slope = 1.0 - ground_n.y;
    float shore = material.a * 80.0 - 20.0;
    bool shore_near = material.a < 0.99;

    // Noise at four sizes, each turned by another angle.
    vec2 p = foot.p;
    float w = foot.log_m;
    vec4 n4 = noise_at(noise_phase[1].zw + mat2(0.8, 0.6, -0.6, 0.8) * p * 0.00071, 0.00071, w);
    vec2 at3 = noise_phase[1].xy + mat2(0.6, 0.8, -0.8, 0.6) * p * 0.0061;
    vec4 n3 = noise_at(at3, 0.0061, w);
    vec4 n2 = noise_at(noise_phase[0].zw + mat2(0.96, 0.28, -0.28, 0.96) * p * 0.047, 0.047, w);
    float fine = 1.0 - smoothstep(150.0, 450.0, d);
    vec4 n1 = noise_at(noise_phase[0].xy + p * 0.43, 0.43, w);
    // On walls the map would smear: sample by height and each horizontal axis instead.
    float wall = smoothstep(0.16, 0.36, slope);
    if (wall > 0.0) {
        vec2 axes = abs(ground_n.xz);
        axes /= axes.x + axes.y + 1e-4;
        float lw = log2(d * screen.w) + 0.5;
        n2 = mix(n2, noise_at(vec2(wall_phase.y + p.y * 0.047, height * 0.055), 0.05, lw) * axes.x +
                     noise_at(vec2(wall_phase.x + p.x * 0.047, height * 0.055), 0.05, lw) * axes.y, wall);
        n1 = mix(n1, noise_at(vec2(wall_phase.w + p.y * 0.3, height * 0.43), 0.4, lw) * axes.x +
                     noise_at(vec2(wall_phase.z + p.x * 0.3, height * 0.43), 0.4, lw) * axes.y, wall);
    }
    n1 = mix(vec4(0.5), n1, fine);
    float v4 = n4.b - 0.5, v3 = n3.b - 0.5, v2 = n2.b - 0.5, v1 = n1.b - 0.5;
    vec2 g_mid = (n2.rg - 0.5) * 0.9 * (1.0 - smoothstep(500.0, 1500.0, d)) + (n3.rg - 0.5) * 0.6;
    vec2 g_fine = (n1.rg - 0.5) * fine;

    // Rock: beds by height, thin dark seams, grey above the dry belt.
    float sy = height + 60.0 * v4 + 14.0 * v3 + 3.0 * v2;
    float band = 0.5 + 0.5 * sin(sy * 0.55 + 2.0 * sin(sy * 0.17 + 1.0) + 1.3 * sin(sy * 0.39));
    float seam = smoothstep(0.35, 0.95, sin(sy * 2.3 + 3.0 * v2 + 2.0 * sin(sy * 0.31)));
    float beds = look.w * (0.2 + 0.8 * smoothstep(-0.14, 0.18, 0.7 * v4 - 0.8 * v3 + 0.3 * v2));
    // Beds thinner than a few pixels go: they would draw lines of their own.
    float pixel = d * screen.w;
    band = mix(band, 0.5, smoothstep(1.2, 4.0, pixel));
    seam *= 1.0 - smoothstep(0.35, 1.0, pixel);
    float pale = smoothstep(0.72, 0.95, 0.5 + 0.5 * sin(sy * 0.21 + 4.0)) * (1.0 - smoothstep(4.0, 10.0, pixel));
    vec3 rock_colour = mix(vec3(0.33, 0.165, 0.095), vec3(0.47, 0.285, 0.165), mix(0.5, band, beds));
    rock_colour = mix(rock_colour, vec3(0.55, 0.42, 0.30), 0.34 * beds * pale);
    rock_colour *= 1.0 - 0.17 * beds * seam * smoothstep(-0.12, 0.12, v2 + 0.5 * v3);
    rock_colour *= 0.86 + 0.9 * v2 + 0.6 * v1;
    rock_colour *= 1.0 - 0.30 * smoothstep(0.50, 0.72, n2.a);
    float grey = smoothstep(rock.x, rock.y, height + 160.0 * v4 + 40.0 * v3);
    vec3 grey_colour = mix(vec3(0.20, 0.185, 0.17), vec3(0.32, 0.285, 0.25), clamp(0.5 + v3 + 0.6 * v2, 0.0, 1.0));
    rock_colour = mix(rock_colour, grey_colour * (1.0 + 0.5 * v1), grey * 0.85);

    vec3 sand_colour = mix(vec3(0.56, 0.375, 0.205), vec3(0.60, 0.325, 0.15), clamp(look.x + v4 * 1.2, 0.0, 1.0));
    sand_colour *= 1.0 + 0.30 * v3 + 0.20 * v2 + 0.16 * v1;
    vec3 soil_colour = mix(vec3(0.33, 0.225, 0.135), vec3(0.43, 0.305, 0.185), smoothstep(-0.2, 0.2, v4)) * (1.0 + 0.42 * v3 + 0.20 * v2 + 0.42 * v1);
    // Stony plains are darker and redder: wind took the fine grains.
    soil_colour = mix(soil_colour, vec3(0.29, 0.185, 0.12) * (1.0 + 0.3 * v3 + 0.4 * v2 + 0.6 * v1), 0.75 * smoothstep(-0.08, 0.10, 0.16 * v2 - 0.9 * v3 - 0.9 * v4));
    vec3 humus_colour = vec3(0.115, 0.082, 0.048) * (1.0 + 0.8 * v2 + 0.7 * v1);
    // Behind the beach roots reach the water: grass in patches, thinning out within some 50 m.
    float lush = shore_near ? smoothstep(4.0, 13.0, shore + 10.0 * v2 + 12.0 * v3) *
                              (1.0 - smoothstep(26.0, 57.0, shore + 14.0 * v2 + 24.0 * v3)) *
                              smoothstep(-0.28, 0.02, 0.8 * v3 + 0.6 * v4 + 0.4 * v2 + 0.30 * (1.0 - smoothstep(8.0, 34.0, shore))) : 0.0;
    float damp = min(1.0, material.b + 0.55 * lush);
    float litter = material.g + 0.75 * lush + 0.5 * v2 + 0.25 * v3 + 0.2 * v1;
    float dryness = clamp(0.55 + 0.5 * (1.0 - smoothstep(0.35, 0.95, litter)) - 0.75 * damp + 1.1 * v3 + 0.9 * v2 + 0.35 * grey, 0.0, 1.0);
    vec3 green_colour = mix(vec3(0.128, 0.140, 0.048), vec3(0.26, 0.21, 0.09), dryness) * (1.0 + 0.5 * v2 + 0.6 * v1);

    // Thin drifts lie on level dry ground, too thin for the layers.
    float drift = smoothstep(-0.14, 0.06, 0.9 * v3 + 0.28 * v2 + 1.2 * v4 + 0.12 * v1) * (1.0 - smoothstep(0.03, 0.10, slope)) *
                  (1.0 - smoothstep(0.10, 0.30, material.g)) * (1.0 - smoothstep(0.25, 0.55, material.b));
    float sand = max(smoothstep(0.30, 0.62, material.r + 0.45 * v2 + 0.35 * v3 + 0.12 * v1), 0.8 * drift);
    sand *= 1.0 - 0.9 * lush;
    float humus = smoothstep(0.25, 0.60, litter) * (1.0 - sand * mix(0.85, 1.0, smoothstep(0.5, 0.8, material.r)));
    vec3 albedo = mix(soil_colour, sand_colour, sand);
    float grassy = smoothstep(0.28, 0.78, damp * 0.8 + 0.4 * v2 + 0.5 * v3 + 0.3 * v1 + 0.18);
    // Bushes stand in the grass, denser where it is wet: a darker green, and a shadow at their foot.
    float bush = smoothstep(0.07, 0.12, v2 + 0.25 * v1 + 0.6 * v3 + 0.4 * v4 + 0.10 * (damp - 0.8)) * smoothstep(0.3, 0.6, damp);
    vec3 bush_colour = vec3(0.045, 0.068, 0.022) * (1.0 + 1.1 * v1);
    albedo = mix(albedo, mix(humus_colour, mix(green_colour, bush_colour, 0.75 * bush), grassy), humus);
    // From near grass is tufts with dark gaps between them.
    vec2 g_tuft = vec2(0.0);
    if (fine * humus > 0.01) {
        vec4 tuft = noise_at(noise_phase[0].xy * 3.0 + p * 1.29, 1.29, w);
        float strength = fine * humus * grassy;
        albedo *= 1.0 + strength * (1.5 * (tuft.b - 0.5) - 0.5 * smoothstep(0.55, 0.75, tuft.a) + 0.06);
        g_tuft = strength * (tuft.rg - 0.5);
    }
    float bare = smoothstep(0.10, 0.26, slope + 0.16 * v2 + 0.10 * v3 - 0.10 * sand - 0.05 * humus) * (1.0 - 0.9 * sand * smoothstep(0.5, 0.8, material.r));
    bare = max(bare, 0.85 * smoothstep(0.35, 0.85, water.y + 0.5 * v2 + 0.3 * v3) * (1.0 - sand));
    albedo = mix(albedo, rock_colour, bare);
    float snow = smoothstep(rock.z - 60.0, rock.z + 140.0, height + 260.0 * v3 + 300.0 * v4) * (1.0 - smoothstep(0.20, 0.42, slope + 0.2 * v2));
    albedo = mix(albedo, vec3(0.80, 0.82, 0.86), snow);

    // Pebbles and grit where nothing else covers the ground.
    float grit = fine * (1.0 - sand) * (1.0 - humus) * (1.0 - snow);
    if (grit > 0.01) {
        float stones = smoothstep(0.60, 0.72, noise_at(noise_phase[0].xy * 3.0 + p * 1.29, 1.29, w).a);
        float gravel = smoothstep(0.02, 0.16, v2 + 0.5 * v3);
        albedo *= 1.0 + grit * (0.10 * gravel - (0.20 + 0.22 * gravel) * stones);
        g_fine *= 1.0 + (1.2 + gravel) * grit * stones;
    }

    // Bump. On walls the horizontal gradient turns into a vertical one.
    vec3 n = ground_n;
    n.xz -= g_mid * (bare * 0.75 + 0.10 + 0.25 * (1.0 - sand) * (1.0 - bare)) * (1.0 - 0.6 * snow) +
            g_fine * (0.55 * bare + 0.35 * (1.0 - sand) + 0.10) + g_tuft * 0.9;
    n.y -= wall * bare * (0.9 * (n2.g - 0.5) + 0.5 * g_fine.y);
    n.xz -= grain(p, w) * (1.0 - snow) * (0.32 - 0.14 * sand) * (1.0 - 0.5 * smoothstep(600.0, 3000.0, d));

    // Wind ripples, two wavelengths, each gone before a pixel would skip it.
    float footprint = d * screen.w / sqrt(max(0.04, dot(view, ground_n)));
    float flat_sand = sand * (1.0 - bare) * (1.0 - 0.7 * humus) * (shore_near ? smoothstep(2.0, 8.0, shore + 5.0 * v2 + 8.0 * v3) : 1.0);
    if (flat_sand > 0.01) {
        // The pattern is bent by a blurred noise: with a sharp one ripples close into rings like the grain of wood.
        vec4 blurred = textureLod(noise_map, noise_phase[2].xy + mat2(0.96, 0.28, -0.28, 0.96) * p * 0.021, 4.3);
        vec2 q = p + vec2(v3 * 0.6 + (blurred.b - 0.5) * 1.3, (blurred.a - 0.5) * 1.3);
        vec4 fork = vec4(blurred.rg, textureLod(noise_map, at3, 3.5).rg) - 0.5;
        float a1 = flat_sand * (1.0 - smoothstep(0.10, 0.23, footprint)) * (1.0 - smoothstep(0.06, 0.15, slope));
        float a2 = flat_sand * (1.0 - smoothstep(0.33, 0.87, footprint)) * (1.0 - smoothstep(0.09, 0.16, slope));
        // In patches, as wind finds loose sand; where it is firm they are faint.
        float loose = smoothstep(-0.10, 0.16, v3 + 0.5 * v2 + 0.7 * v4);
        float steep = (0.5 + 0.5 * loose) * (0.12 + 0.15 * n2.a);
        a2 *= (0.65 + 0.35 * loose) * mix(0.5, 1.0, smoothstep(0.4, 0.95, material.r)) * (shore_near ? mix(0.5, 1.0, smoothstep(20.0, 55.0, shore)) : 1.0); // low on thin and on damp sand
        vec2 blown = a1 + a2 > 0.0 ? wind_of(textureLod(tile_wind, place.uv, place.lod - 1.0)) : vec2(0.0);
        vec3 bumps = vec3(0.0); // xy: gradient; z: darker troughs
        if (dot(blown, blown) < 0.09) {
            bumps = ripples(q, wind.xy, vec2(wind.w, rock.w), vec2(a1, a2), steep, fork);
        } else {
            // Where the wind was simulated it turns from place to place. Each of 24 directions has a pattern of its own
            // that stays where it is as the eye moves; between two of them one gives way to the other along a ragged
            // line, as ripples fork.
            float turn = atan(blown.y, blown.x) * (24.0 / (2.0 * k_pi)) + 24.0;
            float first = floor(turn);
            float share = smoothstep(0.35, 0.65, turn - first + 1.2 * v3 + 0.8 * v2);
            if (share < 1.0) bumps += (1.0 - share) * simulated_ripples(int(first) % 24, q, vec2(a1, a2), steep, fork);
            if (share > 0.0) bumps += share * simulated_ripples(int(first + 1.0) % 24, q, vec2(a1, a2), steep, fork);
        }
        n.xz -= bumps.xy;
        albedo *= 1.0 - bumps.z;
    }
    // Slopes: sand slides down slip faces in tongues, each a little paler or darker than the one beside it; rain cuts
    // rills into soil and rock.
    float slip = flat_sand * smoothstep(0.10, 0.15, slope);
    float rill = (1.0 - sand) * (1.0 - snow) * smoothstep(0.03, 0.12, slope) * (1.0 - wall);
    float streaks = max(slip, rill * (0.35 + 0.65 * smoothstep(20.0, 200.0, d))) * (1.0 - smoothstep(500.0, 1800.0, d));
    if (streaks > 0.01) {
        float turn = atan(ground_n.z, ground_n.x) * (12.0 / k_pi) + 18.0 + 0.5 * v3;
        float first = floor(turn), share = smoothstep(0.3, 0.7, turn - first);
        float down = height * 0.0035 + 0.3 * v4, log_m = log2(d * screen.w) + 0.5;
        float depth = mix(0.3, 0.8, rill / (slip + rill));
        if (share < 1.0) streaks_down(int(first) % 12, p, down, log_m, streaks * (1.0 - share), depth, n, albedo);
        if (share > 0.0) streaks_down(int(first + 1.0) % 12, p, down, log_m, streaks * share, depth, n, albedo);
    }
    n = normalize(n);

    // Lines of drift that waves have left on the beach, and shells and twigs along them.
    if (shore_near && sand > 0.01) {
        float up = shore + 2.6 * v3 + 1.3 * v2;
        float lines = (1.0 - smoothstep(0.0, 0.16, abs(fract(up * 0.27) - 0.5))) * smoothstep(2.2, 3.5, up) * (1.0 - smoothstep(9.0, 16.0, up));
        lines *= (0.3 + 0.7 * smoothstep(0.40, 0.60, n2.a)) * (1.0 - smoothstep(90.0, 260.0, d));
        float bits = smoothstep(0.58, 0.70, n1.a);
        albedo *= 1.0 - sand * lines * (0.42 + 0.4 * bits);
        n.xz -= sand * lines * 0.5 * g_fine;
    }
    // Waves keep the sand wet, and for some steps more it is damp.
    float wet = shore_near ? max(1.0 - smoothstep(0.8, 3.4, shore + 3.0 * v3 + 2.0 * v2), 0.4 * (1.0 - smoothstep(3.0, 6.5, shore + 6.0 * v3 + 2.0 * v2))) : 0.0;
    albedo *= mix(1.0, 0.42, wet * 0.95);
    albedo *= 1.0 - 0.22 * material.b * material.b * (1.0 - wet) * (1.0 - sand) * (1.0 - bare);
    if (water.x > 0.0) albedo *= vec3(0.80, 0.88, 0.80);

    float lambert = max(0.0, dot(n, sun.xyz));
    float facing = smoothstep(-0.02, 0.10, dot(ground_n, sun.xyz));
    float open_sky = bake.g * mix(1.0, 0.82 + 0.6 * v1 + 0.5 * v2, 0.6 * (1.0 - sand));
    vec3 lit = sun_light.rgb * bake.r;
    // Where ground hides the sky it sends light itself, most of it from slopes in the sun.
    vec3 around = ambient(n) * open_sky + light_ground.rgb * (1.25 * (1.0 - bake.g) + 0.22 * (0.5 + slope));
    vec3 c = albedo / k_pi * (lit * lambert * facing + around * k_pi);
    c += sand_colour * 0.06 * pow(1.0 - max(0.0, dot(n, view)), 5.0) * sand * lit * lambert;
    if (wet > 0.3) { // a film of water mirrors the sky
        float film = smoothstep(0.45, 0.9, wet) * (0.02 + 0.98 * pow(1.0 - max(0.0, dot(normalize(ground_n + 0.3 * n), view)), 5.0));
        vec3 mirrored = reflect(-view, ground_n);
        c = mix(c, sky_radiance(vec3(mirrored.x, max(mirrored.y, 0.02), mirrored.z)), 0.3 * film * (1.0 - smoothstep(0.01, 0.08, water.x * k_water_scale_m)));
        c += wet * 0.05 * pow(max(0.0, dot(n, normalize(view + sun.xyz))), 60.0) * lit;
    }
    colour = vec4(c * air_kept + air_added, 1.0);
}
