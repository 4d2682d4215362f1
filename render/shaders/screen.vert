out vec3 direction;
void main() {
    vec2 p = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0;
    vec4 q = inverse_view_projection * vec4(p, 1e-4, 1.0);
    direction = q.xyz / q.w;
    gl_Position = vec4(p, 0.0, 1.0);
}
