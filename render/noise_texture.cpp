#include "render/noise_texture.h"

#include "world/noise.h"

#include <algorithm>
#include <cmath>

namespace sahel {

namespace {

/// Gradient noise on a lattice that repeats after `period` cells.
float periodic_noise(float x, float y, int period, uint32_t salt) {
    const int ix = static_cast<int>(x), iy = static_cast<int>(y);
    const float fx = x - static_cast<float>(ix), fy = y - static_cast<float>(iy);
    const auto corner = [&](int i, int j) {
        const auto cx = static_cast<uint32_t>((ix + i) % period), cy = static_cast<uint32_t>((iy + j) % period);
        const float angle = static_cast<float>(node_hash(column_hash(cx, salt), cy) >> 8) * (6.2831853f / 16777216.0f);
        return std::cos(angle) * (fx - static_cast<float>(i)) + std::sin(angle) * (fy - static_cast<float>(j));
    };
    const float u = quintic(fx), v = quintic(fy);
    const float a = corner(0, 0), b = corner(1, 0), c = corner(0, 1), d = corner(1, 1);
    return 1.5f * (a + (b - a) * u + (c - a) * v + (a - b - c + d) * u * v);
}

uint8_t unorm8(float v) {
    return static_cast<uint8_t>(std::clamp(v, 0.0f, 1.0f) * 255.0f + 0.5f);
}

} // namespace

std::vector<Rgba8> make_noise_texture() {
    constexpr int n = k_noise_texels;
    std::vector<float> sum(static_cast<size_t>(n) * n), ridged(sum.size());
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            float s = 0.0f, r = 0.0f, amplitude = 0.5f;
            for (int o = 0; o < 6; ++o) {
                const int period = 6 << o;
                const float scale = static_cast<float>(period) / n;
                const float v = periodic_noise(static_cast<float>(i) * scale, static_cast<float>(j) * scale, period,
                                               noise_salt(900, static_cast<uint32_t>(o)));
                s += amplitude * v;
                r += amplitude * (1.0f - std::fabs(v) * 2.0f);
                amplitude *= 0.58f;
            }
            sum[static_cast<size_t>(j * n + i)] = s;
            ridged[static_cast<size_t>(j * n + i)] = r;
        }
    std::vector<Rgba8> texels(sum.size());
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const auto at = [&](int x, int y) { return sum[static_cast<size_t>(((y + n) % n) * n + (x + n) % n)]; };
            const auto k = static_cast<size_t>(j * n + i);
            texels[k] = {unorm8(0.5f + (at(i + 1, j) - at(i - 1, j)) * 3.2f),
                         unorm8(0.5f + (at(i, j + 1) - at(i, j - 1)) * 3.2f), unorm8(0.5f + 0.75f * sum[k]),
                         unorm8(0.6f * ridged[k])};
        }
    return texels;
}

} // namespace sahel
