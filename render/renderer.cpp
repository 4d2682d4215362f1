#include "render/renderer.h"

#include "render/frame_uniforms.h"
#include "render/gl_shader.h"
#include "render/noise_texture.h"
#include "render/terrain_nodes.h"

#include <epoxy/gl.h>
#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

namespace sahel {

namespace {

constexpr int k_bloom_levels = 4;
constexpr int k_grid_orders = 4; ///< of the grid's quads: near ones first, from each corner

GLuint make_texture_2d(GLenum format, int width, int height, GLenum filter) {
    GLuint t = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &t);
    glTextureStorage2D(t, 1, format, width, height);
    glTextureParameteri(t, GL_TEXTURE_MIN_FILTER, static_cast<GLint>(filter));
    glTextureParameteri(t, GL_TEXTURE_MAG_FILTER, static_cast<GLint>(filter));
    glTextureParameteri(t, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(t, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return t;
}

GLuint make_tile_array(GLenum format, int side, int layers) {
    GLuint t = 0;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &t);
    glTextureStorage3D(t, k_view_mips, format, side, side, layers);
    // Nearest mip: 12 to 15 % of the terrain pass on a software driver, and no seam between levels of a tile's border.
    glTextureParameteri(t, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_NEAREST);
    glTextureParameteri(t, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(t, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(t, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return t;
}

GLuint make_framebuffer(GLuint colour, GLuint depth) {
    GLuint f = 0;
    glCreateFramebuffers(1, &f);
    if (colour) glNamedFramebufferTexture(f, GL_COLOR_ATTACHMENT0, colour, 0);
    if (depth) glNamedFramebufferTexture(f, GL_DEPTH_ATTACHMENT, depth, 0);
    SAHEL_CHECK_EQ(glCheckNamedFramebufferStatus(f, GL_FRAMEBUFFER), static_cast<GLenum>(GL_FRAMEBUFFER_COMPLETE));
    return f;
}

double now_ms() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

} // namespace

const char* name_of(DebugView view) {
    static constexpr std::array<const char*, static_cast<size_t>(DebugView::count_)> k_names = {
        "off",   "normals", "slope", "sand", "litter", "moisture", "shore",   "sun",     "sky",
        "level", "morph",   "water", "rock", "slot",   "wind",     "shelter", "airborne"};
    return k_names[static_cast<size_t>(view)];
}

struct Renderer::Impl {
    RendererDesc desc;
    Atmosphere atmosphere;
    SkyTable table;
    RenderStats stats;
    bool timing = false;

    GLuint tile_normal = 0, tile_material = 0, tile_bake = 0, tile_water = 0, tile_wind = 0, sky = 0, noise = 0;
    GLuint heights = 0, uniforms = 0, instances = 0, grid = 0, grid_indices = 0;
    GLuint terrain_array = 0, empty_array = 0;
    GLsizei index_count = 0; ///< of one order
    GLuint terrain_program = 0, debug_program = 0, depth_program = 0, water_program = 0, sky_program = 0,
           bloom_program = 0, tone_program = 0, encode_program = 0;
    // targets: scene and its copy, bloom chain, sum of samples, picture
    GLuint scene = 0, scene_depth = 0, copy = 0, copy_depth = 0, sum = 0, picture = 0;
    GLuint scene_fbo = 0, copy_fbo = 0, sum_fbo = 0, picture_fbo = 0;
    std::array<GLuint, k_bloom_levels> bloom{}, bloom_fbo{};

    std::vector<WaterBlocks> slot_water;
    std::vector<NodeInstance> nodes; ///< ground, then water; of each the orders one after the other
    std::array<size_t, k_grid_orders> ground_counts{}, water_counts{};
    size_t ground_count = 0, water_count = 0;
    size_t instance_capacity = 0;

    enum class SlotWind : uint8_t { unset, none, blown };
    std::vector<SlotWind> slot_wind; ///< what the wind texture of a slot holds

    void make_tiles();
    void make_grid();
    void make_targets();
    void drop_targets();
    void upload_sky();
    void choose_nodes(const FrameDesc& frame, std::span<const VisibleTile> tiles);
    void draw_nodes(GLuint program, size_t first, std::span<const size_t> counts);
    void draw_sample(const FrameDesc& frame, int sample);
    double lap(double& since) const;
};

void Renderer::Impl::make_tiles() {
    tile_normal = make_tile_array(GL_RG16_SNORM, k_view_texels, desc.slots);
    tile_material = make_tile_array(GL_RGBA8, k_view_texels, desc.slots);
    tile_bake = make_tile_array(GL_RGBA8, k_view_texels / 2, desc.slots);
    tile_wind = make_tile_array(GL_RGBA8, k_view_texels / 2, desc.slots);
    tile_water = make_tile_array(GL_RG16_SNORM, k_view_texels, desc.slots);
    glCreateBuffers(1, &heights);
    glNamedBufferStorage(heights, static_cast<GLsizeiptr>(desc.slots) * k_slot_values * 4, nullptr,
                         GL_DYNAMIC_STORAGE_BIT);
    glCreateBuffers(1, &uniforms);
    glNamedBufferStorage(uniforms, sizeof(FrameUniforms), nullptr, GL_DYNAMIC_STORAGE_BIT);
    slot_water.assign(static_cast<size_t>(desc.slots), {});
    slot_wind.assign(static_cast<size_t>(desc.slots), SlotWind::unset);

    glCreateTextures(GL_TEXTURE_2D, 1, &noise);
    glTextureStorage2D(noise, 10, GL_RGBA8, k_noise_texels, k_noise_texels);
    const std::vector<Rgba8> texels = make_noise_texture();
    glTextureSubImage2D(noise, 0, 0, 0, k_noise_texels, k_noise_texels, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
    glGenerateTextureMipmap(noise);
    glTextureParameteri(noise, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_NEAREST);
    glTextureParameteri(noise, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    sky = make_texture_2d(GL_RGBA16F, SkyTable::k_width, SkyTable::k_height, GL_LINEAR);
}

void Renderer::Impl::make_grid() {
    struct Vertex {
        float x, y, skirt;
    };
    constexpr int n = k_node_quads + 1;
    std::vector<Vertex> vertices;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) vertices.push_back({static_cast<float>(x), static_cast<float>(y), 0.0f});
    // Skirts: each side once more, lowered in the vertex shader; flat where the depth is zero.
    constexpr std::array<std::array<int, 2>, 4> k_sides = {{{0, 1}, {n * (n - 1), 1}, {0, n}, {n - 1, n}}};
    for (const auto& [first, stride] : k_sides)
        for (int i = 0; i < n; ++i) {
            Vertex v = vertices[static_cast<size_t>(first + i * stride)];
            v.skirt = 1.0f;
            vertices.push_back(v);
        }
    std::vector<uint16_t> indices;
    const auto triangle = [&](int a, int b, int c) {
        for (const int i : {a, b, c}) indices.push_back(static_cast<uint16_t>(i));
    };
    for (int order = 0; order < k_grid_orders;
         ++order) { // seen from the north-west, north-east, south-west, south-east
        for (int j = 0; j < k_node_quads; ++j)
            for (int i = 0; i < k_node_quads; ++i) {
                const int x = (order & 1) != 0 ? k_node_quads - 1 - i : i;
                const int y = (order & 2) != 0 ? k_node_quads - 1 - j : j;
                // All diagonals run the same way: when the odd corners have slid onto the even ones, what is left is
                // the coarser grid, diagonals included.
                const int a = y * n + x, b = a + 1, c = a + n, d = c + 1;
                triangle(a, c, b);
                triangle(b, c, d);
            }
        for (size_t side = 0; side < k_sides.size(); ++side)
            for (int i = 0; i < k_node_quads; ++i) {
                const auto [first, stride] = k_sides[side];
                const int a = first + i * stride, b = a + stride, low = n * n + static_cast<int>(side) * n + i;
                triangle(a, b, low);
                triangle(b, low + 1, low);
            }
    }
    index_count = static_cast<GLsizei>(indices.size()) / k_grid_orders;
    glCreateBuffers(1, &grid);
    glNamedBufferStorage(grid, static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)), vertices.data(), 0);
    glCreateBuffers(1, &grid_indices);
    glNamedBufferStorage(grid_indices, static_cast<GLsizeiptr>(indices.size() * 2), indices.data(), 0);
    glCreateVertexArrays(1, &terrain_array);
    glVertexArrayVertexBuffer(terrain_array, 0, grid, 0, sizeof(Vertex));
    glVertexArrayElementBuffer(terrain_array, grid_indices);
    glVertexArrayBindingDivisor(terrain_array, 1, 1);
    glEnableVertexArrayAttrib(terrain_array, 0);
    glVertexArrayAttribFormat(terrain_array, 0, 3, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(terrain_array, 0, 0);
    for (GLuint i = 1; i <= 5; ++i) {
        glEnableVertexArrayAttrib(terrain_array, i);
        if (i <= 3)
            glVertexArrayAttribIFormat(terrain_array, i, 4, GL_INT, (i - 1) * 16);
        else
            glVertexArrayAttribFormat(terrain_array, i, 4, GL_FLOAT, GL_FALSE, (i - 1) * 16);
        glVertexArrayAttribBinding(terrain_array, i, 1);
    }
    glCreateVertexArrays(1, &empty_array);
}

void Renderer::Impl::make_targets() {
    const int w = desc.width, h = desc.height;
    scene = make_texture_2d(GL_RGBA16F, w, h, GL_LINEAR);
    scene_depth = make_texture_2d(GL_DEPTH_COMPONENT32F, w, h, GL_NEAREST);
    copy = make_texture_2d(GL_RGBA16F, w, h, GL_LINEAR);
    copy_depth = make_texture_2d(GL_DEPTH_COMPONENT32F, w, h, GL_NEAREST);
    sum = make_texture_2d(GL_RGBA32F, w, h, GL_NEAREST);
    picture = make_texture_2d(GL_RGBA8, w, h, GL_NEAREST);
    scene_fbo = make_framebuffer(scene, scene_depth);
    copy_fbo = make_framebuffer(copy, copy_depth);
    sum_fbo = make_framebuffer(sum, 0);
    picture_fbo = make_framebuffer(picture, 0);
    for (size_t i = 0; i < k_bloom_levels; ++i) {
        bloom[i] = make_texture_2d(GL_RGBA16F, std::max(1, w >> (i + 1)), std::max(1, h >> (i + 1)), GL_LINEAR);
        bloom_fbo[i] = make_framebuffer(bloom[i], 0);
    }
}

void Renderer::Impl::drop_targets() {
    for (const GLuint t : {scene, scene_depth, copy, copy_depth, sum, picture}) glDeleteTextures(1, &t);
    for (const GLuint f : {scene_fbo, copy_fbo, sum_fbo, picture_fbo}) glDeleteFramebuffers(1, &f);
    glDeleteTextures(k_bloom_levels, bloom.data());
    glDeleteFramebuffers(k_bloom_levels, bloom_fbo.data());
}

void Renderer::Impl::upload_sky() {
    table = make_sky_table(atmosphere);
    glTextureSubImage2D(sky, 0, 0, 0, SkyTable::k_width, SkyTable::k_height, GL_RGBA, GL_FLOAT, table.radiance.data());
}

/// Nodes of the ground and of the water, from near to far in each of the four quarters around the eye: what is hidden
/// comes late and is not shaded.
void Renderer::Impl::choose_nodes(const FrameDesc& frame, std::span<const VisibleTile> tiles) {
    const Frustum frustum(frame.view);
    NodeSettings settings{desc.cell_m, desc.lod_factor, frame.view.eye_m[2] - frame.view.ground_m, false, &frustum};
    // Levels meet exactly where each tile is as the eye asks for it; elsewhere skirts close what is left.
    for (const VisibleTile& t : tiles) settings.skirts |= t.fallback_mask != 0 || t.fade < 1.0f;
    nodes.clear();
    select_nodes(tiles, {frame.view.eye_m[0], frame.view.eye_m[1]}, settings, nodes);
    const auto middle = [](const NodeInstance& n, size_t axis) { // cells from the eye's cell
        return int64_t{n.node[axis]} + int64_t{n.node[2]} * (k_node_quads / 2);
    };
    const auto order = [&](const NodeInstance& n) {
        return static_cast<size_t>((middle(n, 0) < 0 ? 1 : 0) + (middle(n, 1) < 0 ? 2 : 0));
    };
    const auto distance2 = [&](const NodeInstance& n) {
        return middle(n, 0) * middle(n, 0) + middle(n, 1) * middle(n, 1);
    };
    std::stable_sort(nodes.begin(), nodes.end(), [&](const NodeInstance& a, const NodeInstance& b) {
        return order(a) != order(b) ? order(a) < order(b) : distance2(a) < distance2(b);
    });
    ground_count = nodes.size();
    ground_counts.fill(0);
    water_counts.fill(0);
    for (size_t i = 0; i < ground_count; ++i) { // the same nodes on the water lattices
        ++ground_counts[order(nodes[i])];
        const auto cells = [&](size_t k) { return static_cast<int>(nodes[i].place[k]); };
        const WaterBlocks& water = slot_water[static_cast<size_t>(nodes[i].node[3])];
        if (!water.any(cells(0), cells(1), cells(2) * k_node_quads)) continue;
        NodeInstance n = nodes[i];
        n.own[0] += k_lattice_values;
        if (n.coarse[0] >= 0) n.coarse[0] += k_lattice_values;
        n.params[2] = 0.0f;
        ++water_counts[order(n)];
        nodes.push_back(n);
    }
    water_count = nodes.size() - ground_count;
}

void Renderer::Impl::draw_nodes(GLuint program, size_t first, std::span<const size_t> counts) {
    glUseProgram(program);
    glBindVertexArray(terrain_array);
    for (size_t order = 0; order < counts.size(); ++order) {
        if (counts[order] == 0) continue;
        const auto* indices = reinterpret_cast<const void*>(order * static_cast<size_t>(index_count) * 2);
        glDrawElementsInstancedBaseInstance(GL_TRIANGLES, index_count, GL_UNSIGNED_SHORT, indices,
                                            static_cast<GLsizei>(counts[order]), static_cast<GLuint>(first));
        first += counts[order];
    }
}

double Renderer::Impl::lap(double& since) const {
    if (!timing) return 0.0;
    glFinish();
    const double now = now_ms();
    return now - std::exchange(since, now);
}

void Renderer::Impl::draw_sample(const FrameDesc& frame, int sample) {
    const FrameUniforms u = frame_uniforms(desc, atmosphere, table, frame, sample);
    glNamedBufferSubData(uniforms, 0, sizeof(u), &u);
    double since = timing ? (glFinish(), now_ms()) : 0.0;

    glBindFramebuffer(GL_FRAMEBUFFER, scene_fbo);
    glViewport(0, 0, desc.width, desc.height);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_GREATER);
    glDisable(GL_BLEND);
    glClearColor(0.0f, 0.0f, 0.0f, 1.0f);
    glClearDepth(0.0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    if (frame.wireframe) glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    // Back faces are drawn: they lie behind front faces. Drivers that cull by unrounded positions lose front faces that
    // are nearly on edge, and the ground had single pixels missing.
    glDisable(GL_CULL_FACE);
    draw_nodes(frame.depth_only                 ? depth_program
               : frame.debug == DebugView::none ? terrain_program
                                                : debug_program,
               0, ground_counts);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    stats.terrain_ms += lap(since);

    if (frame.depth_only) return;

    glUseProgram(sky_program);
    glBindVertexArray(empty_array);
    glDepthFunc(GL_GEQUAL); // the sky lies at depth 0: only where nothing was drawn
    glDepthMask(GL_FALSE);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_GREATER);
    stats.sky_ms += lap(since);
    if (water_count > 0 && frame.debug == DebugView::none) {
        glBlitNamedFramebuffer(scene_fbo, copy_fbo, 0, 0, desc.width, desc.height, 0, 0, desc.width, desc.height,
                               GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT, GL_NEAREST);
        glBindTextureUnit(6, copy);
        glBindTextureUnit(7, copy_depth);
        draw_nodes(water_program, ground_count, water_counts);
        stats.water_ms += lap(since);
    }

    glDisable(GL_DEPTH_TEST);
    glBindVertexArray(empty_array);
    glUseProgram(bloom_program);
    GLuint from = scene;
    for (size_t i = 0; i < k_bloom_levels; ++i) {
        glBindFramebuffer(GL_FRAMEBUFFER, bloom_fbo[i]);
        glViewport(0, 0, std::max(1, desc.width >> (i + 1)), std::max(1, desc.height >> (i + 1)));
        glBindTextureUnit(6, from);
        glDrawArrays(GL_TRIANGLES, 0, 3);
        from = bloom[i];
    }
    glBindFramebuffer(GL_FRAMEBUFFER, sum_fbo);
    glViewport(0, 0, desc.width, desc.height);
    if (sample == 0) {
        glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
        glClear(GL_COLOR_BUFFER_BIT);
    }
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    glUseProgram(tone_program);
    glUniform1f(0, 1.0f / static_cast<float>(frame.samples));
    glBindTextureUnit(6, scene);
    glBindTextureUnit(7, bloom[k_bloom_levels - 1]);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDisable(GL_BLEND);
    stats.post_ms += lap(since);
}

Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Result<std::unique_ptr<Renderer>> Renderer::create(const RendererDesc& desc) {
    SAHEL_CHECK_LT(0, desc.width);
    SAHEL_CHECK_LT(0, desc.height);
    GLint layers = 0;
    GLint64 storage = 0;
    glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &layers);
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &storage);
    const int64_t limit = std::min<int64_t>(layers, storage / (int64_t{k_slot_values} * 4));
    if (desc.slots < 1 || desc.slots > limit)
        return Error{ErrorKind::budget, "renderer: " + std::to_string(desc.slots) +
                                            " tile slots asked; this driver holds 1 to " + std::to_string(limit)};
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    auto impl = std::make_unique<Impl>();
    impl->desc = desc;
    impl->make_tiles();
    impl->make_grid();
    impl->make_targets();
    impl->upload_sky();
    impl->terrain_program = link_program("terrain.vert", "terrain.frag", "tile.glsl");
    impl->debug_program = link_program("terrain.vert", "debug.frag", "tile.glsl");
    impl->depth_program = link_program("terrain.vert", "depth.frag");
    impl->water_program = link_program("terrain.vert", "water.frag", "tile.glsl");
    impl->sky_program = link_program("screen.vert", "sky.frag");
    impl->bloom_program = link_program("screen.vert", "bloom.frag");
    impl->tone_program = link_program("screen.vert", "tone.frag");
    impl->encode_program = link_program("screen.vert", "encode.frag");
    return std::unique_ptr<Renderer>(new Renderer(std::move(impl)));
}

Renderer::~Renderer() {
    Impl& r = *impl_;
    r.drop_targets();
    for (const GLuint t : {r.tile_normal, r.tile_material, r.tile_bake, r.tile_water, r.tile_wind, r.sky, r.noise})
        glDeleteTextures(1, &t);
    for (const GLuint b : {r.heights, r.uniforms, r.instances, r.grid, r.grid_indices}) glDeleteBuffers(1, &b);
    for (const GLuint a : {r.terrain_array, r.empty_array}) glDeleteVertexArrays(1, &a);
    for (const GLuint p : {r.terrain_program, r.debug_program, r.depth_program, r.water_program, r.sky_program,
                           r.bloom_program, r.tone_program, r.encode_program})
        glDeleteProgram(p);
}

uint64_t Renderer::slot_bytes() {
    uint64_t texels = 0;
    for (int m = 0, side = k_view_texels; m < k_view_mips; ++m, side /= 2)
        texels += static_cast<uint64_t>(side) * static_cast<uint64_t>(side) * 12 +
                  static_cast<uint64_t>(side / 2) * static_cast<uint64_t>(side / 2) * 8;
    return texels + static_cast<uint64_t>(k_slot_values) * 4;
}

uint64_t Renderer::fixed_bytes() const {
    const auto pixels = static_cast<uint64_t>(impl_->desc.width) * static_cast<uint64_t>(impl_->desc.height);
    const uint64_t targets = pixels * (8 + 4 + 8 + 4 + 16 + 4);
    uint64_t bloom = 0;
    for (int i = 1; i <= k_bloom_levels; ++i) bloom += (pixels >> (2 * i)) * 8;
    return targets + bloom + uint64_t{k_noise_texels} * k_noise_texels * 4 * 4 / 3 +
           uint64_t{SkyTable::k_width} * SkyTable::k_height * 8;
}

void Renderer::upload(uint32_t slot, const ViewTile& tile) {
    Impl& r = *impl_;
    SAHEL_CHECK_LT(slot, static_cast<uint32_t>(r.desc.slots));
    const auto layer = static_cast<GLint>(slot);
    const auto put = [&](GLuint texture, GLenum format, GLenum type, const auto& chain, int side) {
        for (GLint m = 0; m < k_view_mips; ++m, side /= 2) {
            SAHEL_CHECK_EQ(chain[static_cast<size_t>(m)].size(), static_cast<size_t>(side) * static_cast<size_t>(side));
            glTextureSubImage3D(texture, m, 0, 0, layer, side, side, 1, format, type,
                                chain[static_cast<size_t>(m)].data());
        }
    };
    put(r.tile_normal, GL_RG, GL_SHORT, tile.normal, k_view_texels);
    put(r.tile_material, GL_RGBA, GL_UNSIGNED_BYTE, tile.material, k_view_texels);
    put(r.tile_bake, GL_RGBA, GL_UNSIGNED_BYTE, tile.bake, k_view_texels / 2);
    put(r.tile_water, GL_RG, GL_SHORT, tile.water, k_view_texels);
    if (!tile.wind[0].empty()) {
        put(r.tile_wind, GL_RGBA, GL_UNSIGNED_BYTE, tile.wind, k_view_texels / 2);
    } else if (r.slot_wind[slot] != Renderer::Impl::SlotWind::none) {
        constexpr Rgba8 k_calm{128, 128, 0, 0};
        for (GLint m = 0, side = k_view_texels / 2; m < k_view_mips; ++m, side /= 2)
            glClearTexSubImage(r.tile_wind, m, 0, 0, layer, side, side, 1, GL_RGBA, GL_UNSIGNED_BYTE, &k_calm);
    }
    r.slot_wind[slot] = tile.wind[0].empty() ? Renderer::Impl::SlotWind::none : Renderer::Impl::SlotWind::blown;
    for (size_t k = 0; k < k_lattice_count; ++k) {
        const auto put_lattice = [&](const std::vector<float>& values, int64_t offset) {
            if (values.empty()) return;
            const int64_t first = static_cast<int64_t>(slot) * k_slot_values + offset + k_lattice_offset[k];
            glNamedBufferSubData(r.heights, first * 4, static_cast<GLsizeiptr>(values.size() * 4), values.data());
        };
        put_lattice(tile.ground_m[k], 0);
        put_lattice(tile.water_m[k], k_lattice_values);
    }
    r.slot_water[slot] = tile.water_blocks;
}

void Renderer::set_atmosphere(const Atmosphere& atmosphere) {
    impl_->atmosphere = atmosphere;
    impl_->upload_sky();
}

const Atmosphere& Renderer::atmosphere() const {
    return impl_->atmosphere;
}

const SkyTable& Renderer::sky() const {
    return impl_->table;
}

void Renderer::render(const FrameDesc& frame, std::span<const VisibleTile> tiles) {
    Impl& r = *impl_;
    SAHEL_CHECK_LT(0, frame.samples);
    r.stats = {};
    r.stats.tiles = static_cast<int>(tiles.size());
    r.choose_nodes(frame, tiles);
    r.stats.nodes = static_cast<int>(r.ground_count);
    r.stats.triangles = static_cast<int>(r.ground_count) * k_node_quads * k_node_quads * 2;
    if (r.nodes.size() > r.instance_capacity) {
        r.instance_capacity = r.nodes.size() * 2;
        if (r.instances) glDeleteBuffers(1, &r.instances);
        glCreateBuffers(1, &r.instances);
        glNamedBufferStorage(r.instances, static_cast<GLsizeiptr>(r.instance_capacity * sizeof(NodeInstance)), nullptr,
                             GL_DYNAMIC_STORAGE_BIT);
        glVertexArrayVertexBuffer(r.terrain_array, 1, r.instances, 0, sizeof(NodeInstance));
    }
    if (!r.nodes.empty())
        glNamedBufferSubData(r.instances, 0, static_cast<GLsizeiptr>(r.nodes.size() * sizeof(NodeInstance)),
                             r.nodes.data());

    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, r.uniforms);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, r.heights);
    GLuint unit = 0;
    for (const GLuint t : {r.tile_normal, r.tile_material, r.tile_bake, r.tile_water, r.sky, r.noise})
        glBindTextureUnit(unit++, t);
    glBindTextureUnit(8, r.tile_wind); // 6 and 7 are the targets
    for (int s = 0; s < frame.samples; ++s) r.draw_sample(frame, s);
    if (frame.depth_only) return;

    glBindFramebuffer(GL_FRAMEBUFFER, r.picture_fbo);
    glViewport(0, 0, r.desc.width, r.desc.height);
    glUseProgram(r.encode_program);
    glBindVertexArray(r.empty_array);
    glBindTextureUnit(6, r.sum);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

void Renderer::read_pixels(std::vector<uint8_t>& rgba) const {
    const auto w = static_cast<size_t>(impl_->desc.width), h = static_cast<size_t>(impl_->desc.height);
    std::vector<uint8_t> bottom_up(w * h * 4);
    glGetTextureImage(impl_->picture, 0, GL_RGBA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(bottom_up.size()),
                      bottom_up.data());
    rgba.resize(bottom_up.size());
    for (size_t y = 0; y < h; ++y) std::copy_n(&bottom_up[(h - 1 - y) * w * 4], w * 4, &rgba[y * w * 4]);
}

void Renderer::read_depth(std::vector<float>& depth) const {
    const auto w = static_cast<size_t>(impl_->desc.width), h = static_cast<size_t>(impl_->desc.height);
    std::vector<float> bottom_up(w * h);
    glGetTextureImage(impl_->scene_depth, 0, GL_DEPTH_COMPONENT, GL_FLOAT, static_cast<GLsizei>(bottom_up.size() * 4),
                      bottom_up.data());
    depth.resize(bottom_up.size());
    for (size_t y = 0; y < h; ++y) std::copy_n(&bottom_up[(h - 1 - y) * w], w, &depth[y * w]);
}

uint32_t Renderer::framebuffer() const {
    return impl_->picture_fbo;
}

void Renderer::resize(int width, int height) {
    if (width == impl_->desc.width && height == impl_->desc.height) return;
    impl_->drop_targets();
    impl_->desc.width = std::max(1, width);
    impl_->desc.height = std::max(1, height);
    impl_->make_targets();
}

int Renderer::width() const {
    return impl_->desc.width;
}

int Renderer::height() const {
    return impl_->desc.height;
}

void Renderer::time_passes(bool on) {
    impl_->timing = on;
}

const RenderStats& Renderer::stats() const {
    return impl_->stats;
}

} // namespace sahel
