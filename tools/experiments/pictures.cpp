#include "tools/experiments/pictures.h"

#include "tools/experiments/measure_relief.h"

#include <algorithm>
#include <array>

namespace sahel::experiments {

namespace {

using Colour = std::array<double, 3>;

Colour mixed(const Colour& a, const Colour& b, double t) {
    const double s = std::clamp(t, 0.0, 1.0);
    return {a[0] + (b[0] - a[0]) * s, a[1] + (b[1] - a[1]) * s, a[2] + (b[2] - a[2]) * s};
}

/// Light from the north-west, 40 degrees high, and a little from everywhere.
double shade_at(const Plane& h, int32_t x, int32_t y) {
    const double gx = (h.at(x + 1, y) - h.at(x - 1, y)) / (2.0 * h.cell_m);
    const double gy = (h.at(x, y + 1) - h.at(x, y - 1)) / (2.0 * h.cell_m);
    const double up = std::sin(40.0 * k_pi / 180.0);
    const double flat = std::cos(40.0 * k_pi / 180.0) / std::sqrt(2.0);
    const double lit = std::max((gx * flat + gy * flat + up) / std::sqrt(1.0 + gx * gx + gy * gy), 0.0);
    return 0.25 + 0.75 * lit / up;
}

template <class F> Image shaded(const Plane& height, F&& colour_at) {
    Image image(height.width, height.height, 4);
    for (int32_t y = 0; y < height.height; ++y)
        for (int32_t x = 0; x < height.width; ++x) {
            const Colour c = colour_at(x, y);
            const double shade = shade_at(height, x, y);
            uint8_t* pixel = image.at(x, y);
            for (size_t i = 0; i < 3; ++i) pixel[i] = static_cast<uint8_t>(std::clamp(c[i] * shade, 0.0, 255.0));
            pixel[3] = 255;
        }
    return image;
}

constexpr Colour k_rock{112, 108, 104};
constexpr Colour k_sand{216, 184, 128};
constexpr Colour k_plant{84, 140, 66};
constexpr Colour k_object{150, 84, 72};

} // namespace

Image relief_picture(const Plane& height) {
    const double low = least_of(height);
    const double span = std::max(largest_of(height) - low, 1.0e-6);
    return shaded(height, [&](int32_t x, int32_t y) {
        return mixed({150, 112, 76}, {246, 222, 170}, (height.at(x, y) - low) / span);
    });
}

Image ground_picture(const DuneRun& run) {
    const Plane sand = run.sand();
    const Ground& ground = run.desc().ground;
    return shaded(run.surface(), [&](int32_t x, int32_t y) {
        Colour c = mixed(k_rock, k_sand, sand.at(x, y) / 0.5);
        if (ground.vegetation) c = mixed(c, k_plant, 0.7 * ground.vegetation(x, y));
        if (ground.object && ground.object(x, y)) c = k_object;
        return c;
    });
}

Image value_picture(const Plane& height, const Plane& values, double low, double high) {
    SAHEL_CHECK(height.same_shape(values));
    return shaded(height, [&](int32_t x, int32_t y) {
        const double t = (values.at(x, y) - low) / (high - low);
        return t < 0.5 ? mixed({58, 104, 190}, {236, 232, 226}, 2.0 * t)
                       : mixed({236, 232, 226}, {196, 70, 54}, 2.0 * t - 1.0);
    });
}

} // namespace sahel::experiments
