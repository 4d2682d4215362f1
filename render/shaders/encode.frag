// From the sum of a picture's samples to what is shown. Averaging blurs by the width of a pixel: pictures of many
// samples get their edges back by contrast adaptive sharpening (Lottes, AMD FidelityFX CAS, 2019), which never leaves
// the range of a pixel's neighbours by much and hardly touches what is sharp already.
in vec3 direction;
layout(location = 0) out vec4 colour;
layout(binding = 6) uniform sampler2D sum;

vec3 sharpened(ivec2 p, float sharpness) {
    ivec2 last = ivec2(screen.yz) - 1;
    vec3 c = texelFetch(sum, p, 0).rgb;
    vec3 n = texelFetch(sum, min(p + ivec2(0, 1), last), 0).rgb, s = texelFetch(sum, max(p - ivec2(0, 1), ivec2(0)), 0).rgb;
    vec3 e = texelFetch(sum, min(p + ivec2(1, 0), last), 0).rgb, w = texelFetch(sum, max(p - ivec2(1, 0), ivec2(0)), 0).rgb;
    vec3 least = min(c, min(min(n, s), min(e, w))), most = max(c, max(max(n, s), max(e, w)));
    vec3 room = sqrt(clamp(min(least, 1.0 - most) / max(most, 1e-4), 0.0, 1.0));
    vec3 weight = -room * sharpness;
    return clamp(((n + s + e + w) * weight + c) / (1.0 + 4.0 * weight), 0.0, 1.0);
}

void main() {
    ivec2 p = ivec2(gl_FragCoord.xy);
    float sharpness = mode.x > 0 ? 0.0 : 0.14 * clamp(float(mode.z - 1) / 7.0, 0.0, 1.0);
    vec3 c = sharpness > 0.0 ? sharpened(p, sharpness) : texelFetch(sum, p, 0).rgb; // one sample has nothing to win back
    c = mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
    colour = vec4(c + (gradient_noise_1(gl_FragCoord.xy) - 0.5) / 255.0, 1.0);
}
