#include "streaming/scene_ground.h"

#include "world/exr_image.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace sahel {

namespace fs = std::filesystem;

namespace {

constexpr float k_obstacle_m = 100.0f;
constexpr float k_max_height_m = 12000.0f;

struct Maps {
    std::optional<ExrImage> terrain;
    std::optional<ExrImage> resistance;
};

Result<std::optional<ExrImage>> read_map(const fs::path& path, std::initializer_list<const char*> channels) {
    std::error_code failed;
    if (!fs::exists(path, failed)) return std::optional<ExrImage>();
    SAHEL_ASSIGN(ExrImage image, read_exr_image(path));
    for (const char* channel : channels)
        if (!image.find(channel))
            return Error{ErrorKind::corrupt, fmt::format("{}: has no channel {}", path.string(), channel)};
    return std::optional<ExrImage>(std::move(image));
}

/// Samples a map at the cell centres of a grid; every value must be within [low, high].
Result<std::vector<float>> sample(const ExrImage& map, const char* channel, const fs::path& path, int32_t width,
                                  int32_t height, float low, float high) {
    const std::vector<float>& from = *map.find(channel);
    std::vector<float> to(static_cast<size_t>(width) * static_cast<size_t>(height));
    size_t i = 0;
    for (int32_t y = 0; y < height; ++y) {
        const int64_t sy = (int64_t{2} * y + 1) * map.height / (int64_t{2} * height);
        for (int32_t x = 0; x < width; ++x) {
            const int64_t sx = (int64_t{2} * x + 1) * map.width / (int64_t{2} * width);
            const float v = from[static_cast<size_t>(sy * map.width + sx)];
            if (!(v >= low && v <= high))
                return Error{ErrorKind::corrupt,
                             fmt::format("{}: channel {} is {} at ({}, {}); it must be from {} to {}", path.string(),
                                         channel, v, sx, sy, low, high)};
            to[i++] = v;
        }
    }
    return to;
}

int32_t short_side(int32_t size, int32_t full_short, int32_t full_long) {
    return static_cast<int32_t>((int64_t{2} * size * full_short + full_long) / (int64_t{2} * full_long));
}

Status check_side(const Scene& scene, int32_t width, int32_t height) {
    const auto good = [](int32_t n) { return n >= 2 * k_scene_side_step && n % k_scene_side_step == 0; };
    if (good(width) && good(height) && int64_t{width} * height <= int64_t{1} << 28) return {};
    return Error{ErrorKind::usage,
                 fmt::format("{}: a grid of {} x {} cells; sides must be multiples of {} from {} on, and at most 268 "
                             "million cells (choose another size)",
                             scene.path.empty() ? "scene" : scene.path.string(), width, height, k_scene_side_step,
                             2 * k_scene_side_step)};
}

/// True if the object cells of the map are those of the published obstacle, to the cell.
bool is_published_obstacle(const ExrImage& resistance) {
    const std::vector<float>& v = *resistance.find("G");
    size_t i = 0;
    for (int32_t y = 0; y < resistance.height; ++y)
        for (int32_t x = 0; x < resistance.width; ++x, ++i)
            if ((v[i] < 0.0f) != scene_obstacle(resistance.width, resistance.height, x, y, 2)) return false;
    return true;
}

void rebuild_obstacle(const ExrImage& resistance, SceneGround& g) {
    size_t i = 0;
    for (int32_t y = 0; y < g.height; ++y)
        for (int32_t x = 0; x < g.width; ++x, ++i) {
            const auto sx = static_cast<int32_t>((int64_t{2} * x + 1) * resistance.width / (int64_t{2} * g.width));
            const auto sy = static_cast<int32_t>((int64_t{2} * y + 1) * resistance.height / (int64_t{2} * g.height));
            const bool inside = scene_obstacle(resistance.width, resistance.height, sx, sy, 0);
            g.bedrock_m[i] = inside ? k_obstacle_m : 0.0f;
            if (inside) g.sand_m[i] = 0.0f;
        }
    g.rebuilt = true;
}

Status apply_maps(const Scene& scene, const Maps& maps, const fs::path& terrain_path, const fs::path& resistance_path,
                  bool keep_sticky, SceneGround& g) {
    const bool oasis = scene.format == SceneFormat::oasis;
    if (maps.terrain) {
        const ExrImage& m = *maps.terrain;
        const auto layer = [&](const char* channel, float low, std::vector<float>& out) -> Status {
            SAHEL_ASSIGN(out, sample(m, channel, terrain_path, g.width, g.height, low, k_max_height_m));
            return {};
        };
        SAHEL_TRY(layer("R", -k_max_height_m, g.bedrock_m));
        SAHEL_TRY(layer("G", 0.0f, g.sand_m));
        if (oasis) {
            SAHEL_TRY(layer("B", 0.0f, g.soil_m));
            if (m.find("A"))
                SAHEL_TRY(layer("A", 0.0f, g.water_m));
            else {
                std::fill(g.water_m.begin(), g.water_m.end(), 0.0f);
                g.notes.emplace_back("the terrain map has no channel A: no water (the published loader makes it 1 m)");
            }
        }
        g.mapped = true;
    }
    if (maps.resistance) {
        const ExrImage& m = *maps.resistance;
        SAHEL_ASSIGN(std::vector<float> v, sample(m, "G", resistance_path, g.width, g.height, -1.0e6f, 1.0e6f));
        SAHEL_ASSIGN(g.resistance, sample(m, "B", resistance_path, g.width, g.height, -1.0e6f, 1.0e6f));
        for (float& r : g.resistance) r = std::clamp(r, 0.0f, 1.0f);
        int64_t forbidden = 0;
        for (size_t i = 0; i < v.size(); ++i) {
            forbidden += v[i] < 0.0f;
            g.object[i] = v[i] < 0.0f && !oasis;
            g.vegetation[i] = std::clamp(v[i], 0.0f, 1.0f);
        }
        if (oasis && forbidden > 0)
            g.notes.push_back(fmt::format("{} cells are marked against plants; no plant grows yet", forbidden));
        if (keep_sticky && m.find("A")) {
            SAHEL_ASSIGN(g.echo, sample(m, "A", resistance_path, g.width, g.height, -1.0e6f, 1.0e6f));
        }
        g.mapped = true;
    }
    if (maps.terrain || oasis) return {};
    if (maps.resistance && is_published_obstacle(*maps.resistance)) {
        rebuild_obstacle(*maps.resistance, g);
        g.notes.push_back(fmt::format("{} is missing: the obstacle of the published scenes stands by its rule",
                                      terrain_path.filename().string()));
    } else {
        g.notes.push_back(fmt::format("{} is missing: the generated ground is used", terrain_path.filename().string()));
    }
    return {};
}

} // namespace

bool scene_obstacle(int32_t full_width, int32_t full_height, int32_t x, int32_t y, int32_t rim) {
    const int64_t cx = full_width / 2 - 100;
    const int64_t cy = full_height / 2;
    const int64_t dx = x - cx;
    const int64_t dy = y - cy;
    const int64_t radius = 150 + rim;
    if (dx * dx + dy * dy <= radius * radius) return true;
    const int64_t sides = rim > 0 ? 1 : 0; // the published mask is one cell longer at each end, two wider
    return dx > -sides && dx < 400 + sides && dy >= -radius && dy <= radius;
}

Result<SceneGround> make_scene_ground(const Scene& scene, const SceneGroundOptions& options) {
    SceneGround g;
    Maps maps;
    const fs::path terrain_path = scene.path.string() + ".terrain.exr";
    const fs::path resistance_path = scene.path.string() + ".resistance.exr";
    int32_t full_width = scene.values.grid_size[0];
    int32_t full_height = scene.values.grid_size[1];
    if (scene.values.export_maps && !scene.path.empty()) {
        SAHEL_ASSIGN(maps.terrain, read_map(terrain_path, {"R", "G"}));
        SAHEL_ASSIGN(maps.resistance, read_map(resistance_path, {"G", "B"}));
        for (const auto* map : {&maps.terrain, &maps.resistance})
            if (*map) {
                full_width = (*map)->width;
                full_height = (*map)->height;
            }
        if (maps.terrain && maps.resistance &&
            (maps.terrain->width != maps.resistance->width || maps.terrain->height != maps.resistance->height))
            return Error{ErrorKind::corrupt,
                         fmt::format("{} has {} x {} pixels, {} {} x {}: they must be alike", terrain_path.string(),
                                     maps.terrain->width, maps.terrain->height, resistance_path.filename().string(),
                                     maps.resistance->width, maps.resistance->height)};
        if (full_width != scene.values.grid_size[0] || full_height != scene.values.grid_size[1])
            g.notes.push_back(fmt::format("the maps have {} x {} cells, 'gridSize' {} x {}: the maps count", full_width,
                                          full_height, scene.values.grid_size[0], scene.values.grid_size[1]));
    }
    const int32_t longest = std::max(full_width, full_height);
    g.width = full_width;
    g.height = full_height;
    if (options.size != 0) {
        g.width = full_width == longest ? options.size : short_side(options.size, full_width, full_height);
        g.height = full_height == longest ? options.size : short_side(options.size, full_height, full_width);
        g.scale = static_cast<double>(options.size) / longest;
    }
    SAHEL_TRY(check_side(scene, g.width, g.height));

    const SceneLayers& l = scene.layers;
    const float no_floor = -2.0f * k_max_height_m;
    g.window = representative_window(full_width, full_height, g.width, g.height,
                                     {{l.bedrock, no_floor}, {l.sand, 0.0f}, {l.soil, 0.0f}});
    g.bedrock_m = scene_layer(l.bedrock, g.window);
    g.sand_m = scene_layer(l.sand, g.window);
    g.vegetation = scene_layer(l.vegetation, g.window);
    g.resistance = scene_layer(l.resistance, g.window);
    g.object.assign(g.cells(), 0);
    for (float& s : g.sand_m) s = std::max(s, 0.0f);
    for (float& v : g.vegetation) v = std::clamp(v, 0.0f, 1.0f);
    for (float& r : g.resistance) r = std::clamp(r, 0.0f, 1.0f);
    if (scene.format == SceneFormat::oasis) {
        g.soil_m = scene_layer(l.soil, g.window);
        g.water_m = scene_layer(l.water, g.window);
        g.moisture_m = scene_layer(l.moisture, g.window);
        for (size_t i = 0; i < g.cells(); ++i) {
            g.soil_m[i] = std::max(g.soil_m[i], 0.0f);
            g.moisture_m[i] = std::max(g.moisture_m[i], 0.0f);
            const float ground = g.bedrock_m[i] + g.sand_m[i] + g.soil_m[i];
            g.water_m[i] = l.water.enable ? std::max(g.water_m[i] - ground, 0.0f) : 0.0f; // a level becomes a depth
        }
    } else {
        g.soil_m.assign(g.cells(), 0.0f);
        g.water_m.assign(g.cells(), 0.0f);
        g.moisture_m.assign(g.cells(), 0.0f);
    }
    if (scene.values.export_maps)
        SAHEL_TRY(apply_maps(scene, maps, terrain_path, resistance_path, options.keep_sticky, g));
    for (size_t i = 0; i < g.cells(); ++i) {
        const float top = g.bedrock_m[i] + g.sand_m[i] + g.soil_m[i] + g.water_m[i];
        if (!(std::abs(top) <= 16000.0f))
            return Error{ErrorKind::usage, fmt::format("{}: the ground stands at {} m; heights stay within 16000 m",
                                                       scene.path.string(), top)};
    }
    if (options.size != 0 && g.mapped && g.scale != 1.0)
        g.notes.push_back(fmt::format("maps are resampled to {} x {} cells: what stands in them is {} times as wide",
                                      g.width, g.height, g.scale));
    if (!g.window.is_whole())
        g.notes.push_back(fmt::format("generated layers are a window of {} x {} cells at ({}, {}) of {} x {}", g.width,
                                      g.height, g.window.x0, g.window.y0, full_width, full_height));
    return g;
}

} // namespace sahel
