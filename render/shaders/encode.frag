in vec3 direction;
layout(location = 0) out vec4 colour;
layout(binding = 6) uniform sampler2D sum;
void main() {
    vec3 c = texelFetch(sum, ivec2(gl_FragCoord.xy), 0).rgb;
    c = mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
    colour = vec4(c + (gradient_noise_1(gl_FragCoord.xy) - 0.5) / 255.0, 1.0);
}
