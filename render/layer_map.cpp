#include "render/layer_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace sahel {

namespace {

using Ramp = std::array<std::array<float, 3>, 5>;

// Colours from low to high, sRGB 0..255; each is told from its neighbours by lightness too.
Ramp ramp_of(Layer layer) {
    switch (layer) {
    case Layer::water:
        return {{{205, 196, 170}, {150, 200, 205}, {88, 160, 190}, {44, 104, 160}, {18, 48, 108}}};
    case Layer::sand:
    case Layer::airborne_sand:
    case Layer::dune:
        return {{{74, 66, 60}, {130, 104, 76}, {186, 146, 88}, {226, 190, 120}, {252, 236, 184}}};
    case Layer::soil:
    case Layer::sediment:
        return {{{214, 200, 170}, {180, 150, 112}, {140, 106, 74}, {100, 70, 48}, {58, 38, 28}}};
    case Layer::moisture:
    case Layer::wetness:
        return {{{224, 204, 160}, {190, 190, 130}, {130, 168, 104}, {66, 132, 100}, {24, 84, 84}}};
    default:
        return {{{66, 92, 84}, {126, 140, 96}, {196, 178, 122}, {176, 130, 96}, {240, 236, 230}}};
    }
}

std::array<float, 3> colour_at(const Ramp& ramp, float t) {
    const float s = std::clamp(t, 0.0f, 1.0f) * 4.0f;
    const auto i = static_cast<size_t>(std::min(s, 3.0f));
    const float f = s - static_cast<float>(i);
    std::array<float, 3> c{};
    for (size_t k = 0; k < 3; ++k) c[k] = ramp[i][k] + (ramp[i + 1][k] - ramp[i][k]) * f;
    return c;
}

/// The value below which `share` of all lie.
float quantile(std::vector<float>& values, double share) {
    const auto k = static_cast<ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + k, values.end());
    return values[static_cast<size_t>(k)];
}

} // namespace

Result<LayerMap> make_layer_map(const SurfaceSource& source, Layer layer, double x_m, double y_m, double side_m,
                                int pixels) {
    if (pixels < 16 || pixels > 4096 || !(side_m > 0.0 && side_m < 1e12) || !(std::abs(x_m) < 1e15) ||
        !(std::abs(y_m) < 1e15))
        return Error{ErrorKind::usage,
                     fmt::format("layer map of {} m in {} pixels at ({}, {})", side_m, pixels, x_m, y_m)};
    int level = 0;
    while (level < 20 && std::ldexp(source.cell_m(), level) * pixels < side_m) ++level;
    const double cell = std::ldexp(source.cell_m(), level);
    const auto x0 = static_cast<int64_t>(std::floor(x_m / cell)) - pixels / 2;
    const auto y0 = static_cast<int64_t>(std::floor(y_m / cell)) - pixels / 2;
    LayerSet layers{Layer::bedrock, Layer::soil, Layer::sand, Layer::water};
    layers.insert(layer);
    SAHEL_ASSIGN(LayerBlock block, LayerBlock::allocate(level, {x0, y0, x0 + pixels, y0 + pixels}, 1, layers));
    SAHEL_TRY(source.read(block));

    const auto rock = block.ints(Layer::bedrock), soil = block.ints(Layer::soil), sand = block.ints(Layer::sand);
    const auto ground_m = [&](int x, int y) { return metres_of_ticks(rock(x, y) + soil(x, y) + sand(x, y)); };
    const auto value = [&](int x, int y) {
        if (layer == Layer::bedrock) return ground_m(x, y);
        switch (info_of(layer).type) {
        case LayerType::ticks:
            return metres_of_ticks(block.ints(layer)(x, y));
        case LayerType::flags:
            return static_cast<float>(block.ints(layer)(x, y));
        case LayerType::real:
            break;
        }
        return block.reals(layer)(x, y);
    };

    LayerMap map;
    map.image = Image(pixels, pixels, 4);
    map.x0_m = static_cast<double>(x0) * cell;
    map.y0_m = static_cast<double>(y0) * cell;
    map.side_m = cell * pixels;
    std::vector<float> values;
    for (int y = 0; y < pixels; ++y)
        for (int x = 0; x < pixels; ++x) values.push_back(value(x, y));
    // A few extreme cells must not take all colours.
    std::vector<float> sorted = values;
    map.low = quantile(sorted, 0.005);
    map.high = quantile(sorted, 0.995);
    if (layer != Layer::bedrock && info_of(layer).type != LayerType::real) map.low = std::min(map.low, 0.0f);
    if (map.high <= map.low) map.high = *std::max_element(values.begin(), values.end());
    const float span = std::max(map.high - map.low, 1e-6f);

    const Ramp ramp = ramp_of(layer);
    const auto two_cells = static_cast<float>(2.0 * cell);
    for (int y = 0; y < pixels; ++y)
        for (int x = 0; x < pixels; ++x) {
            auto c = colour_at(ramp, (values[static_cast<size_t>(y * pixels + x)] - map.low) / span);
            // Light from the north-west.
            const float gx = (ground_m(x + 1, y) - ground_m(x - 1, y)) / two_cells;
            const float gy = (ground_m(x, y + 1) - ground_m(x, y - 1)) / two_cells;
            const float lit = (0.5f * gx + 0.5f * gy + 0.7071f) / std::sqrt(gx * gx + gy * gy + 1.0f) / 0.7071f;
            const float shade = std::clamp(0.35f + 0.65f * lit, 0.2f, 1.35f);
            uint8_t* p = map.image.at(x, y);
            for (int k = 0; k < 3; ++k)
                p[k] = static_cast<uint8_t>(std::clamp(c[static_cast<size_t>(k)] * shade, 0.0f, 255.0f));
            p[3] = 255;
        }
    const std::string unit(info_of(layer).unit);
    map.legend = fmt::format("{:.3g} to {:.3g}{}{}", map.low, map.high, unit.empty() ? "" : " ", unit);
    return map;
}

} // namespace sahel
