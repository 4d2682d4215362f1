#pragma once

#include "world/executor.h"
#include "world/macros.h"

#include <cstdint>

/// What the solver of the coarse wind works on: planes of floats with a ring of one cell around them, and loops over
/// rows on the threads set. Included by sources of the solver alone.
namespace sahel {

/// How the ring follows from the cells inside.
enum class WindRing : uint8_t { wrap, edge, zero };

struct WindPlane {
    float* origin = nullptr; ///< cell (0, 0)
    int32_t nx = 0, ny = 0;
    int64_t stride = 0;

    SAHEL_HD float* row(int32_t y) const { return origin + y * stride; }
    /// Floats that a plane takes, and the place of its first cell among them.
    static constexpr int64_t floats(int64_t nx, int64_t ny) { return (nx + 2) * (ny + 2); }
    static WindPlane in(float* memory, int32_t nx, int32_t ny) { return {memory + (nx + 2) + 1, nx, ny, nx + 2}; }

    /// Columns first, then rows with their corners. A ring of zeros is cleared once, with the memory.
    SAHEL_HD void fill_ring(WindRing x, WindRing y) const {
        if (x != WindRing::zero) {
            for (int32_t j = 0; j < ny; ++j) {
                float* r = row(j);
                r[-1] = x == WindRing::wrap ? r[nx - 1] : r[0];
                r[nx] = x == WindRing::wrap ? r[0] : r[nx - 1];
            }
        }
        if (y != WindRing::zero) {
            float* low = row(-1);
            float* high = row(ny);
            const float* from_low = y == WindRing::wrap ? row(ny - 1) : row(0);
            const float* from_high = y == WindRing::wrap ? row(0) : row(ny - 1);
            for (int32_t i = -1; i <= nx; ++i) {
                low[i] = from_low[i];
                high[i] = from_high[i];
            }
        }
    }
};

inline namespace SAHEL_EXECUTOR_NAMESPACE {
namespace wind_detail {

template <class F> struct RowWork {
    const F* f;
    int32_t rows;
    int32_t rows_per_block;
};
template <class F> void run_some_rows(const void* context, int64_t block) {
    const auto& work = *static_cast<const RowWork<F>*>(context);
    const auto y0 = static_cast<int32_t>(block) * work.rows_per_block;
    const int32_t y1 = y0 + work.rows_per_block < work.rows ? y0 + work.rows_per_block : work.rows;
    for (int32_t y = y0; y < y1; ++y) (*work.f)(y);
}

} // namespace wind_detail

/// f(y) for every row, in any order.
template <class F> void for_each_row(const char* name, int32_t cells, int32_t rows, const F& f) {
    if (cells <= 0 || rows <= 0) return;
    const int64_t wanted = (2 * detail::k_cells_per_block + cells - 1) / cells;
    const auto per_block = static_cast<int32_t>(wanted < rows ? wanted : rows);
    const wind_detail::RowWork<F> work{&f, rows, per_block};
    detail::run_blocks(name, int64_t{cells} * rows, (rows + per_block - 1) / per_block, &wind_detail::run_some_rows<F>,
                       &work);
}

} // namespace SAHEL_EXECUTOR_NAMESPACE
} // namespace sahel
