#pragma once

#include "world/macros.h"

#include <cstdint>

/// The eight directions of a cell, in one order everywhere: east first, then turning from +x towards +y.
///
///     5 6 7        sides 0 2 4 6, distance 1;  corners 1 3 5 7, distance sqrt 2;  the opposite of k is k ^ 4
///     4 . 0
///     3 2 1        (y grows downwards)
namespace sahel {

inline constexpr int k_direction_count = 8;

SAHEL_HD constexpr int32_t direction_x(int k) {
    return (k == 0 || k == 1 || k == 7) - (k == 3 || k == 4 || k == 5);
}
SAHEL_HD constexpr int32_t direction_y(int k) {
    return (k == 1 || k == 2 || k == 3) - (k == 5 || k == 6 || k == 7);
}
/// Direction of an offset by its signs; -1 for (0, 0).
SAHEL_HD constexpr int direction_of(int32_t dx, int32_t dy) {
    const int sx = (dx > 0) - (dx < 0);
    const int sy = (dy > 0) - (dy < 0);
    for (int k = 0; k < k_direction_count; ++k)
        if (direction_x(k) == sx && direction_y(k) == sy) return k;
    return -1;
}
inline constexpr float k_sqrt2 = 1.41421356237309505f;

} // namespace sahel
