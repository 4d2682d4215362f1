#include "streaming/scene_terrain.h"

#include "world/det_math.h"
#include "world/executor.h"

#include <cmath>
#include <limits>

namespace sahel {

namespace {

struct Axis {
    float p;        ///< coordinate of the hills
    float mirrored; ///< the same of the mirror image
    float weight;   ///< of the mirror image
};

/// One axis of 3.15, "Seamless", within the window.
Axis seamless(float uv, float border, float stretch, float offset, float shift, float share) {
    const float c = 2.0f * uv - 1.0f;
    const float limit = 1.0f - 2.0f * border;
    const float d = det::max(det::abs(c) - limit, 0.0f);
    const float mirrored = 0.5f * (c >= 0.0f ? -(limit + d) : limit + d) + 0.5f;
    const float a = border > 0.0f ? det::min(d / (2.0f * border), 1.0f) : 0.0f;
    return {offset + stretch * (shift + share * uv), offset + stretch * (shift + share * mirrored),
            0.5f * (a * a * (3.0f - 2.0f * a))};
}

float lerp(float a, float b, float t) {
    return a + t * (b - a);
}

float hills_at(const SceneNoise& noise, const SceneWindow& w, float u, float v) {
    const auto full_x = static_cast<float>(w.full_width);
    const auto full_y = static_cast<float>(w.full_height);
    const Axis x = seamless(u, noise.border[0], noise.stretch[0], noise.offset[0], static_cast<float>(w.x0) / full_x,
                            static_cast<float>(w.width) / full_x);
    const Axis y = seamless(v, noise.border[1], noise.stretch[1], noise.offset[1], static_cast<float>(w.y0) / full_y,
                            static_cast<float>(w.height) / full_y);
    const float here = scene_fractal(x.p, y.p, noise.iterations);
    if (x.weight == 0.0f && y.weight == 0.0f) return here;
    const float top = lerp(here, scene_fractal(x.mirrored, y.p, noise.iterations), x.weight);
    if (y.weight == 0.0f) return top;
    const float bottom = lerp(scene_fractal(x.p, y.mirrored, noise.iterations),
                              scene_fractal(x.mirrored, y.mirrored, noise.iterations), x.weight);
    return lerp(top, bottom, y.weight);
}

struct MeanSpread {
    double mean;
    double spread;
};

/// Of bias + scale hills, clamped below, on 32 x 32 places of the window.
MeanSpread mean_spread(const SceneNoise& noise, const SceneWindow& w, float least) {
    constexpr int k_side = 32;
    double sum = 0.0;
    double squares = 0.0;
    for (int j = 0; j < k_side; ++j)
        for (int i = 0; i < k_side; ++i) {
            const float u = (static_cast<float>(i) + 0.5f) / k_side;
            const float v = (static_cast<float>(j) + 0.5f) / k_side;
            const double z = std::max(noise.bias + noise.scale * hills_at(noise, w, u, v), least);
            sum += z;
            squares += z * z;
        }
    constexpr double k_count = k_side * k_side;
    const double mean = sum / k_count;
    return {mean, std::sqrt(std::max(squares / k_count - mean * mean, 0.0))};
}

} // namespace

float scene_hash(float x, float y) {
    const float s = 43758.5453f * det::sin(12.9898f * x + 78.233f * y);
    return s - det::floor(s);
}

float scene_value_noise(float px, float py, float frequency) {
    const float qx = frequency * px;
    const float qy = frequency * py;
    const float ax = det::floor(qx);
    const float ay = det::floor(qy);
    const float tx = 0.5f * (1.0f - det::cos(det::k_pi * (qx - ax)));
    const float ty = 0.5f * (1.0f - det::cos(det::k_pi * (qy - ay)));
    const float top = lerp(scene_hash(ax, ay), scene_hash(ax + 1.0f, ay), tx);
    const float bottom = lerp(scene_hash(ax, ay + 1.0f), scene_hash(ax + 1.0f, ay + 1.0f), tx);
    return lerp(top, bottom, ty);
}

float scene_fractal(float px, float py, int iterations) {
    float sum = 0.0f;
    float weights = 0.0f;
    float weight = 1.0f;
    float frequency = 4.0f;
    for (int k = 0; k <= iterations; ++k) {
        sum += weight * scene_value_noise(px, py, frequency);
        weights += weight;
        weight *= 0.5f;
        frequency *= 2.0f;
    }
    const float mean = sum / weights;
    return (mean * mean) * (mean * mean);
}

float scene_hills(const SceneNoise& noise, const SceneWindow& w, int32_t x, int32_t y) {
    return hills_at(noise, w, (static_cast<float>(x) + 0.5f) / static_cast<float>(w.width),
                    (static_cast<float>(y) + 0.5f) / static_cast<float>(w.height));
}

std::vector<float> scene_layer(const SceneNoise& noise, const SceneWindow& w) {
    std::vector<float> values(w.cells(), 0.0f);
    if (!noise.enable) return values;
    if (noise.flat && !noise.uniform) {
        std::fill(values.begin(), values.end(), noise.bias);
        return values;
    }
    struct Fill {
        const SceneNoise* noise;
        SceneWindow window;
        float* out;
        void operator()(int32_t x, int32_t y) const {
            const SceneNoise& n = *noise;
            float z = 0.0f;
            if (n.uniform) {
                const float u = (static_cast<float>(window.x0 + x) + 0.5f) / static_cast<float>(window.full_width);
                const float v = (static_cast<float>(window.y0 + y) + 0.5f) / static_cast<float>(window.full_height);
                z = scene_hash(n.offset[0] + n.stretch[0] * u, n.offset[1] + n.stretch[1] * v);
            } else {
                z = scene_hills(n, window, x, y);
            }
            out[static_cast<int64_t>(y) * window.width + x] = n.bias + n.scale * z;
        }
    };
    for_each_cell("scene/layer", {0, 0, w.width, w.height}, Fill{&noise, w, values.data()});
    return values;
}

SceneWindow representative_window(int32_t full_width, int32_t full_height, int32_t width, int32_t height,
                                  const std::vector<std::pair<SceneNoise, float>>& layers) {
    SceneWindow best{full_width, full_height, 0, 0, width, height};
    if (best.is_whole()) return best;
    struct Whole {
        const SceneNoise* noise;
        float least;
        MeanSpread stats;
    };
    std::vector<Whole> hills;
    for (const auto& [noise, least] : layers)
        if (noise.hills())
            hills.push_back({&noise, least, mean_spread(noise, SceneWindow::whole(full_width, full_height), least)});
    if (hills.empty() || width > full_width || height > full_height) return best;
    constexpr int k_places = 16;
    double least_cost = std::numeric_limits<double>::infinity();
    for (int j = 0; j < k_places; ++j)
        for (int i = 0; i < k_places; ++i) {
            SceneWindow w = best;
            w.x0 = static_cast<int32_t>(int64_t{full_width - width} * i / (k_places - 1));
            w.y0 = static_cast<int32_t>(int64_t{full_height - height} * j / (k_places - 1));
            double cost = 0.0;
            for (const Whole& h : hills) {
                const MeanSpread here = mean_spread(*h.noise, w, h.least);
                const double unit = std::max(h.stats.spread, 1.0e-9);
                cost += std::abs(here.mean - h.stats.mean) / unit + std::abs(here.spread - h.stats.spread) / unit;
            }
            if (cost < least_cost) {
                least_cost = cost;
                best = w;
            }
        }
    return best;
}

} // namespace sahel
