in vec3 direction;
layout(location = 0) out vec4 colour;
layout(binding = 6) uniform sampler2D source;
void main() {
    vec2 texel = 1.0 / vec2(textureSize(source, 0));
    vec2 uv = gl_FragCoord.xy * 2.0 * texel;
    vec3 c = vec3(0.0);
    for (int j = -1; j <= 1; j += 2)
        for (int i = -1; i <= 1; i += 2) c += min(texture(source, uv + vec2(i, j) * texel * 0.5).rgb, vec3(60.0));
    colour = vec4(c * 0.25, 1.0);
}
