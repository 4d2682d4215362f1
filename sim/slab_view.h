#pragma once

#include "world/check.h"
#include "world/macros.h"
#include "world/random.h"

#include <cstdint>
#include <type_traits>

/// What kernels see of a TileDomain: one layer of all resident tiles, and where the cells lie in the world.
namespace sahel {

/// One layer of all slots. (slot, 0, 0) is the first owned cell of a tile; halo cells have negative or larger indices.
template <class T> struct SlabView {
    T* origin = nullptr; ///< element (0, 0, 0)
    int64_t stride = 0;  ///< elements from row to row
    int64_t slot_stride = 0;
    int32_t first = 0; ///< least local x and y: -halo
    int32_t last = 0;  ///< one past the largest

    SAHEL_HD T& operator()(int32_t slot, int32_t x, int32_t y) const {
#if defined(SAHEL_DEBUG) && !defined(__CUDA_ARCH__)
        SAHEL_CHECK_LE(first, x);
        SAHEL_CHECK_LT(x, last);
        SAHEL_CHECK_LE(first, y);
        SAHEL_CHECK_LT(y, last);
#endif
        return origin[slot * slot_stride + y * stride + x];
    }
    /// Row y of a slot, at x = 0.
    SAHEL_HD T* row(int32_t slot, int32_t y) const {
        return origin + slot * slot_stride + y * stride;
    }

    template <class U>
    requires(std::is_same_v<U, const T> && !std::is_const_v<T>) SAHEL_HD operator SlabView<U>() const { // NOLINT
        return {origin, stride, slot_stride, first, last};
    }
};

/// World cells of local cells. Halo cells beyond a periodic or a wall border are copies of cells inside, and draw the
/// random numbers of those: whoever computes a cell gets the same.
struct CellPlaces {
    const int64_t* origin = nullptr; ///< x, y of local (0, 0), two for each slot
    int64_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    int64_t period_x = 0, period_y = 0; ///< 0 where not periodic
    bool wall_x0 = false, wall_x1 = false, wall_y0 = false, wall_y1 = false;

    SAHEL_HD static int64_t place(int64_t c, int64_t lo, int64_t hi, int64_t period, bool wall_lo, bool wall_hi) {
        const int64_t wrapped = c + (c < lo ? period : 0) - (c >= hi ? period : 0);
        const int64_t low = wall_lo && wrapped < lo ? 2 * lo - 1 - wrapped : wrapped;
        return wall_hi && low >= hi ? 2 * hi - 1 - low : low;
    }
    SAHEL_HD int64_t x(int32_t slot, int32_t x_local) const {
        return place(origin[2 * slot] + x_local, x0, x1, period_x, wall_x0, wall_x1);
    }
    SAHEL_HD int64_t y(int32_t slot, int32_t y_local) const {
        return place(origin[2 * slot + 1] + y_local, y0, y1, period_y, wall_y0, wall_y1);
    }
    SAHEL_HD Random4 random(const RandomStream& stream, int32_t slot, int32_t x_local, int32_t y_local) const {
        return stream.at(x(slot, x_local), y(slot, y_local));
    }
};

} // namespace sahel
