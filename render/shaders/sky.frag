in vec3 direction;
layout(location = 0) out vec4 colour;

void main() {
    vec3 d = normalize(direction);
    vec3 c = sky_radiance(d);
    float mu = dot(d, sun.xyz);
    c += smoothstep(0.99996, 0.999985, mu) * sun_light.rgb * 90.0;
    c += sun_light.rgb * (0.012 * pow(max(mu, 0.0), 900.0) + 0.004 * pow(max(mu, 0.0), 60.0));
    if (d.y > 0.015 && look.y > 0.0) {
        vec2 p = d.xz / (d.y + 0.045) * 2600.0 + wind.xy * eye.w * 6.0;
        const mat2 turn = mat2(0.8, 0.6, -0.6, 0.8);
        float fine = texture(noise_map, noise_phase[3].zw + p.yx * 0.00037).b;
        float density = texture(noise_map, noise_phase[2].zw + p * 0.000031).b * 0.58 +
                        texture(noise_map, noise_phase[3].xy + turn * p * 0.000093).b * 0.30 + fine * 0.12;
        float cover = smoothstep(0.62 - look.y * 0.25, 0.80 - look.y * 0.15, density);
        vec2 s = p + normalize(sun.xz) * 900.0;
        float sunward = texture(noise_map, noise_phase[2].zw + s * 0.000031).b * 0.58 +
                        texture(noise_map, noise_phase[3].xy + turn * s * 0.000093).b * 0.30 + fine * 0.12;
        float lit = clamp(0.55 + (density - sunward) * 3.5, 0.12, 1.2);
        vec3 cloud = sun_light.rgb * (0.050 * lit + 0.05 * pow(max(mu, 0.0), 8.0) * (1.0 - cover)) + light_up.rgb * 0.42;
        float low = smoothstep(0.015, 0.16, d.y);
        c = mix(c, mix(c, cloud, low), cover * 0.82 * low);
    }
    colour = vec4(c, 1.0);
}
