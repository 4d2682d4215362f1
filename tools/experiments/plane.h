#pragma once

#include "world/check.h"

#include <cmath>
#include <cstdint>
#include <vector>

/// A field of the experiments: a rectangle of cells whose opposite borders meet, as in the papers.
namespace sahel::experiments {

inline constexpr double k_pi = 3.14159265358979323846;

struct Vec2 {
    double x = 0.0;
    double y = 0.0;
};

/// Unit vector of an angle in degrees, from +x towards +y (south on pictures).
inline Vec2 unit_of(double angle_deg) {
    return {std::cos(angle_deg * k_pi / 180.0), std::sin(angle_deg * k_pi / 180.0)};
}

template <class T> struct BasicPlane {
    int32_t width = 0;
    int32_t height = 0;
    double cell_m = 1.0;
    std::vector<T> values; ///< row 0 first

    BasicPlane() = default;
    BasicPlane(int32_t w, int32_t h, double cell, T value = {})
        : width(w), height(h), cell_m(cell), values(static_cast<size_t>(w) * static_cast<size_t>(h), value) {}

    [[nodiscard]] size_t size() const { return values.size(); }
    /// Index of the cell, across the seams.
    [[nodiscard]] size_t index(int64_t x, int64_t y) const {
        const auto wrap = [](int64_t a, int64_t n) { return (a % n + n) % n; };
        return static_cast<size_t>(wrap(y, height) * width + wrap(x, width));
    }
    [[nodiscard]] T& at(int64_t x, int64_t y) { return values[index(x, y)]; }
    [[nodiscard]] const T& at(int64_t x, int64_t y) const { return values[index(x, y)]; }
    [[nodiscard]] bool same_shape(const auto& o) const { return width == o.width && height == o.height; }

    /// f(x, y) for every cell.
    template <class F> static BasicPlane made(int32_t w, int32_t h, double cell, F&& f) {
        BasicPlane plane(w, h, cell);
        size_t i = 0;
        for (int32_t y = 0; y < h; ++y)
            for (int32_t x = 0; x < w; ++x) plane.values[i++] = static_cast<T>(f(x, y));
        return plane;
    }
};
using Plane = BasicPlane<float>;
using CellMask = BasicPlane<uint8_t>; ///< 1: the cell counts

/// a + b, cell by cell.
inline Plane sum_of(const Plane& a, const Plane& b) {
    SAHEL_CHECK(a.same_shape(b));
    Plane out = a;
    for (size_t i = 0; i < out.values.size(); ++i) out.values[i] += b.values[i];
    return out;
}

/// The shorter way round from a to b on a circle of `period`.
inline double shortest(double from, double to, double period) {
    const double d = std::remainder(to - from, period);
    return d;
}

/// Smallest angle between two lines (directions without a sense), degrees, 0 to 90.
inline double line_angle_between(double a_deg, double b_deg) {
    return std::abs(shortest(a_deg, b_deg, 180.0));
}

} // namespace sahel::experiments
