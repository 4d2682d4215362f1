#include "render/view_bake.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace sahel {

namespace {

constexpr int k_half = k_view_texels / 2;
constexpr int k_steps = 34;
constexpr size_t k_phase_of[2][2] = {{0, 2}, {3, 1}};
constexpr float k_penumbra = 0.024f; // tangent of the half width of the sun, as drawn

float smooth(float t) {
    t = std::clamp(t, 0.0f, 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

/// 3 x 3 binomial blur: without it, creases of the ground show as dotted lines.
void blur(std::vector<float>& v, int side) {
    std::vector<float> rows(v.size());
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const int l = std::max(x - 1, 0), r = std::min(x + 1, side - 1);
            const float* p = &v[static_cast<size_t>(y * side)];
            rows[static_cast<size_t>(y * side + x)] = 0.25f * (p[l] + 2.0f * p[x] + p[r]);
        }
    for (int y = 0; y < side; ++y) {
        const float* a = &rows[static_cast<size_t>(std::max(y - 1, 0) * side)];
        const float* b = &rows[static_cast<size_t>(y * side)];
        const float* c = &rows[static_cast<size_t>(std::min(y + 1, side - 1) * side)];
        for (int x = 0; x < side; ++x) v[static_cast<size_t>(y * side + x)] = 0.25f * (a[x] + 2.0f * b[x] + c[x]);
    }
}

/// The coarsest grid that still resolves features at a distance of `t` cells.
size_t level_for(const HeightChain& chain, float t) {
    size_t level = 0;
    while (level + 1 < chain.size() && t > 40.0f * chain.grid(level).spacing) ++level;
    return level;
}

} // namespace

HeightChain::HeightChain(std::span<const float> ground, int side, int first, const ViewTileContext& own)
    : highest_m_(own.max_m) {
    const float centre = static_cast<float>(first) + 0.5f;
    grids_.push_back({ground.data(), side, centre, centre, 1.0f, 1.0f, own.max_m});
    for (const ViewTileContext* c = &own; c != nullptr; c = c->parent.get()) {
        const int up = c->key.level - own.key.level;
        // Corner of the ancestor, in cells of the tile; exact in double for any world position.
        const double scale = std::ldexp(1.0, up);
        const double x =
            static_cast<double>(c->key.x) * k_view_cells * scale - static_cast<double>(own.key.x) * k_view_cells;
        const double y =
            static_cast<double>(c->key.y) * k_view_cells * scale - static_cast<double>(own.key.y) * k_view_cells;
        const double offset = (2.0 - k_view_border) * scale;
        const auto spacing = static_cast<float>(4.0 * scale);
        grids_.push_back({c->ground_m.data(), ViewTileContext::k_side, static_cast<float>(x + offset),
                          static_cast<float>(y + offset), 1.0f / spacing, spacing, c->max_m});
        highest_m_ = std::max(highest_m_, c->max_m);
    }
}

void bake_sun(const HeightChain& chain, double cell_m, const SunDirection& sun, std::vector<float>& visibility) {
    visibility.assign(static_cast<size_t>(k_half) * k_half, 1.0f);
    const float dx = std::cos(sun.azimuth_rad), dy = std::sin(sun.azimuth_rad);
    const auto cell = static_cast<float>(cell_m);
    const float rise = std::tan(std::max(sun.elevation_rad, 0.002f)) * cell; // m per cell of distance
    struct Step {
        float x, y, up, inverse;
        size_t level;
    };
    // Steps grow and would miss narrow ridges at some texels and meet them at the next: shade with teeth. The four
    // texels of every square step at places of their own, between which the blur below takes the exact mean.
    std::array<std::array<Step, k_steps>, 4> steps_of{};
    for (size_t phase = 0; phase < 4; ++phase) {
        float at = 1.2f;
        for (Step& s : steps_of[phase]) {
            const float next = 1.17f * at + 0.6f;
            const float t = at + 0.25f * static_cast<float>(phase) * (next - at);
            s = {dx * t, dy * t, rise * t, 1.0f / ((k_penumbra * t + 0.12f) * cell), level_for(chain, t)};
            at = next;
        }
    }
    for (int j = 0; j < k_half; ++j)
        for (int i = 0; i < k_half; ++i) {
            const float x = static_cast<float>(2 * i - k_view_border + 1),
                        y = static_cast<float>(2 * j - k_view_border + 1);
            float here = 0.0f;
            if (!chain.sample(x, y, 0, here)) continue;
            here += 0.05f * cell;
            float v = 1.0f;
            for (const Step& s : steps_of[k_phase_of[j % 2][i % 2]]) {
                const float ray = here + s.up;
                float ground = 0.0f;
                if (ray > chain.highest_m() || !chain.sample(x + s.x, y + s.y, s.level, ground)) break;
                v = std::min(v, 0.5f + 0.5f * (ray - ground) * s.inverse);
                if (v <= 0.0f) break;
            }
            visibility[static_cast<size_t>(j * k_half + i)] = smooth(v);
        }
    blur(visibility, k_half);

    // On a wall a few texels span its whole height: an edge of shade would be a row of teeth. There it is drawn softer.
    std::vector<float> soft = visibility;
    for (int i = 0; i < 3; ++i) blur(soft, k_half);
    for (int j = 0; j < k_half; ++j)
        for (int i = 0; i < k_half; ++i) {
            const auto at = static_cast<size_t>(j * k_half + i);
            if (soft[at] == visibility[at]) continue; // no edge here
            const float x = static_cast<float>(2 * i - k_view_border + 1),
                        y = static_cast<float>(2 * j - k_view_border + 1);
            float west = 0.0f, east = 0.0f, north = 0.0f, south = 0.0f;
            if (!chain.sample(x - 2.0f, y, 0, west) || !chain.sample(x + 2.0f, y, 0, east) ||
                !chain.sample(x, y - 2.0f, 0, north) || !chain.sample(x, y + 2.0f, 0, south))
                continue;
            const float slope = std::hypot(east - west, south - north) / (4.0f * cell);
            visibility[at] += (soft[at] - visibility[at]) * smooth((slope - 0.7f) / 0.8f);
        }
}

void bake_sky(const HeightChain& chain, double cell_m, std::vector<float>& visibility) {
    // The sky changes slowly over the ground: every second texel, the others between them.
    constexpr int k_quarter = k_half / 2;
    const auto cell = static_cast<float>(cell_m);
    struct Probe {
        float x, y, inverse;
        size_t level;
    };
    std::array<Probe, 40> probes{};
    for (size_t d = 0; d < 8; ++d) {
        const float angle = static_cast<float>(d) * 0.78539816f + 0.3f;
        float t = 1.6f;
        for (size_t k = 0; k < 5; ++k, t *= 2.1f)
            probes[d * 5 + k] = {std::cos(angle) * t, std::sin(angle) * t, 1.0f / (t * cell),
                                 level_for(chain, 4.0f * t)};
    }
    std::vector<float> coarse(static_cast<size_t>(k_quarter) * k_quarter, 1.0f);
    for (int j = 0; j < k_quarter; ++j)
        for (int i = 0; i < k_quarter; ++i) {
            const float x = static_cast<float>(4 * i - k_view_border + 2),
                        y = static_cast<float>(4 * j - k_view_border + 2);
            float here = 0.0f;
            if (!chain.sample(x, y, 0, here)) continue;
            float seen = 0.0f;
            for (size_t d = 0; d < 8; ++d) {
                float steepest = 0.0f;
                for (size_t k = 0; k < 5; ++k) {
                    const Probe& p = probes[d * 5 + k];
                    float ground = 0.0f;
                    if (chain.sample(x + p.x, y + p.y, p.level, ground))
                        steepest = std::max(steepest, (ground - here) * p.inverse);
                }
                seen += 1.0f - steepest / std::sqrt(1.0f + steepest * steepest);
            }
            coarse[static_cast<size_t>(j * k_quarter + i)] = std::pow(seen * 0.125f, 1.15f);
        }
    blur(coarse, k_quarter);
    visibility.resize(static_cast<size_t>(k_half) * k_half);
    for (int j = 0; j < k_half; ++j)
        for (int i = 0; i < k_half; ++i) {
            const float u = std::clamp((static_cast<float>(i) - 0.5f) * 0.5f, 0.0f, static_cast<float>(k_quarter - 1));
            const float v = std::clamp((static_cast<float>(j) - 0.5f) * 0.5f, 0.0f, static_cast<float>(k_quarter - 1));
            const int iu = std::min(static_cast<int>(u), k_quarter - 2),
                      iv = std::min(static_cast<int>(v), k_quarter - 2);
            const float a = u - static_cast<float>(iu), b = v - static_cast<float>(iv);
            const float* p = &coarse[static_cast<size_t>(iv * k_quarter + iu)];
            const float top = p[0] + a * (p[1] - p[0]), bottom = p[k_quarter] + a * (p[k_quarter + 1] - p[k_quarter]);
            visibility[static_cast<size_t>(j * k_half + i)] = top + b * (bottom - top);
        }
}

} // namespace sahel
