// Exposure, film curve, grade. The result is linear: samples are averaged after the curve, then encoded.
in vec3 direction;
layout(location = 0) out vec4 colour;
layout(binding = 6) uniform sampler2D scene;
layout(binding = 7) uniform sampler2D bloom;
layout(location = 0) uniform float weight;

vec3 film(vec3 x) {
    return clamp((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
}
void main() {
    vec2 uv = gl_FragCoord.xy / screen.yz;
    vec3 c = texture(scene, uv).rgb;
    if (mode.x > 0) {
        colour = vec4(pow(clamp(c, 0.0, 1.0), vec3(2.2)) * weight, 1.0);
        return;
    }
    const vec3 luminance = vec3(0.2126, 0.7152, 0.0722);
    c = mix(c, texture(bloom, uv).rgb, 0.06) * screen.x;
    c *= 1.0 - 0.38 * smoothstep(0.30, 0.75, length((uv - 0.5) * vec2(1.0, 0.75)));
    vec3 a = film(c);
    float l = dot(c, luminance);
    vec3 b = c * (film(vec3(l)).x / max(l, 1e-5));
    b = clamp(mix(b, vec3(1.0), smoothstep(0.75, 1.6, max(b.r, max(b.g, b.b)) - 0.1) * 0.6), 0.0, 1.0);
    c = mix(a, b, 0.35);
    c = max(mix(vec3(dot(c, luminance)), c, 1.06), 0.0);
    colour = vec4(c * weight, 1.0);
}
