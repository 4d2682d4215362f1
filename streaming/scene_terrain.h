#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

/// The start of a scene: layers made of a constant, white noise or hills, as the published programs make them
/// (Desertscape method 3.15, Oasis method 3.1).
///
///     hash     H(q) = frac(43758.5453 sin(12.9898 q_x + 78.233 q_y))
///     noise    hashes of the four lattice points around nu p, blended by (1 - cos pi t) / 2
///     fractal  Phi(p) = (sum_k 2^-k noise(p, 4 2^k) / sum_k 2^-k)^4, k = 0 .. iterations: isolated peaks
///     hills    Phi, blended within a frame at the border with its own mirror images, so that opposite sides meet
///
/// All are functions of uv, the place in the scene from 0 to 1. The published programs run on the sine of a GPU; here
/// it is that of det_math.h, so every machine gets the same hills (they agree with stored maps up to the last digits,
/// which the hash blows up to centimetres).
///
/// A run on a smaller grid is a window of the scene, of cells of the same size: hills and dunes keep their size in
/// metres. The frame that makes opposite sides meet is then that of the window.
namespace sahel {

struct SceneNoise {
    bool enable = true;
    bool flat = true;
    bool uniform = false; ///< wins over flat
    int iterations = 0;
    float scale = 1.0f;
    float bias = 0.0f;
    std::array<float, 2> stretch{1.0f, 1.0f};
    std::array<float, 2> offset{0.0f, 0.0f};
    std::array<float, 2> border{0.1f, 0.1f}; ///< width of the frame as a share of the side; 0: none
    friend bool operator==(const SceneNoise&, const SceneNoise&) = default;
    [[nodiscard]] bool hills() const { return enable && !uniform && !flat; }
};

/// Cells [x0, x0 + width) x [y0, y0 + height) of a scene of full_width x full_height.
struct SceneWindow {
    int32_t full_width = 0;
    int32_t full_height = 0;
    int32_t x0 = 0;
    int32_t y0 = 0;
    int32_t width = 0;
    int32_t height = 0;

    static SceneWindow whole(int32_t width, int32_t height) { return {width, height, 0, 0, width, height}; }
    [[nodiscard]] bool is_whole() const { return width == full_width && height == full_height; }
    [[nodiscard]] size_t cells() const { return static_cast<size_t>(width) * static_cast<size_t>(height); }
    friend bool operator==(const SceneWindow&, const SceneWindow&) = default;
};

/// In [0, 1].
float scene_hash(float x, float y);
/// Value noise of a frequency, in [0, 1].
float scene_value_noise(float px, float py, float frequency);
/// In [0, 1].
float scene_fractal(float px, float py, int iterations);
/// Hills at the cell (x, y) of the window, in [0, 1].
float scene_hills(const SceneNoise& noise, const SceneWindow& window, int32_t x, int32_t y);

/// The layer over the window, row after row. A layer that is not enabled is 0 (what a fresh program holds).
std::vector<float> scene_layer(const SceneNoise& noise, const SceneWindow& window);

/// Where a window of that size stands for the whole scene best: mean and spread of each layer of hills are nearest to
/// those of the whole, among 16 x 16 places; layers are clamped below at `least` first. Without hills: the corner.
SceneWindow representative_window(int32_t full_width, int32_t full_height, int32_t width, int32_t height,
                                  const std::vector<std::pair<SceneNoise, float>>& layers);

} // namespace sahel
