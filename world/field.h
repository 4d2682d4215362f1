#pragma once

#include "world/check.h"
#include "world/layers.h"
#include "world/macros.h"
#include "world/memory.h"
#include "world/tile_key.h"

#include <array>
#include <cstdint>
#include <type_traits>

/// Fields and views. A view is a pointer, a stride and bounds, passed by value to kernels; coordinates are local
/// (int32): (0, 0) is the first owned cell and halo cells have negative or larger indices.
///
///          x0 = -h        0                    n         x1 = n + h
///     y0 = -h +-----------------------------------------------+
///             |  halo                                         |
///           0 |          +--------------------+               |
///             |          |  owned cells       |               |
///           n |          +--------------------+               |
///             |                                               |
///     y1      +-----------------------------------------------+   rows are `stride` elements apart
namespace sahel {

template <class T> struct FieldView {
    T* origin = nullptr; ///< element (0, 0)
    int64_t stride = 0;  ///< elements from one row to the next
    int32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;

    /// Element (x, y); bounds are checked in debug builds on the host.
    SAHEL_HD T& operator()(int32_t x, int32_t y) const {
#if defined(SAHEL_DEBUG) && !defined(__CUDA_ARCH__)
        SAHEL_CHECK_LE(x0, x);
        SAHEL_CHECK_LT(x, x1);
        SAHEL_CHECK_LE(y0, y);
        SAHEL_CHECK_LT(y, y1);
#endif
        return origin[y * stride + x];
    }
    /// Start of row y at x = 0.
    SAHEL_HD T* row(int32_t y) const {
        return origin + y * stride;
    }
    [[nodiscard]] SAHEL_HD int32_t width() const {
        return x1 - x0;
    }
    [[nodiscard]] SAHEL_HD int32_t height() const {
        return y1 - y0;
    }

    /// To the view that only reads.
    template <class U>
    requires(std::is_same_v<U, const T> && !std::is_const_v<T>) SAHEL_HD
    operator FieldView<U>() const { // NOLINT(google-explicit-constructor)
        return {origin, stride, x0, y0, x1, y1};
    }
};

/// The layers of a rectangle of cells at one level, one column of memory per layer. `rect` may include a halo: local
/// (0, 0) is cell `origin`, and `rect` says how far the memory reaches around it.
///
/// Memory: for every layer of the set, in table order, (rect.height() x stride) elements of 4 bytes, row 0 first.
class LayerBlock {
  public:
    LayerBlock() = default;

    /// Owned cells `owned` at `level` with `halo` cells around them. Errors: budget, io.
    static Result<LayerBlock> allocate(int32_t level, const CellRect& owned, int32_t halo, LayerSet layers,
                                       MemoryPool& pool = MemoryPool::host());
    /// The bytes `allocate` would take, exactly.
    static uint64_t bytes_needed(const CellRect& owned, int32_t halo, LayerSet layers);

    [[nodiscard]] int32_t level() const { return level_; }
    [[nodiscard]] const CellRect& owned() const { return owned_; }
    [[nodiscard]] CellRect rect() const { return owned_.grown(halo_); }
    [[nodiscard]] int32_t halo() const { return halo_; }
    [[nodiscard]] LayerSet layers() const { return layers_; }
    [[nodiscard]] uint64_t bytes() const { return buffer_.bytes(); }
    [[nodiscard]] MemoryKind memory_kind() const { return buffer_.kind(); }

    /// View of an int32 layer (ticks or flags).
    [[nodiscard]] FieldView<int32_t> ints(Layer layer) { return view<int32_t>(layer); }
    [[nodiscard]] FieldView<const int32_t> ints(Layer layer) const { return view<int32_t>(layer); }
    /// View of a float layer.
    [[nodiscard]] FieldView<float> reals(Layer layer) { return view<float>(layer); }
    [[nodiscard]] FieldView<const float> reals(Layer layer) const { return view<float>(layer); }

    /// Sets every element of every layer to zero (host memory only).
    void clear();

  private:
    template <class T> [[nodiscard]] FieldView<T> view(Layer layer) const {
        SAHEL_CHECK(layers_.contains(layer));
        SAHEL_CHECK_EQ((info_of(layer).type == LayerType::real), (std::is_same_v<T, float>));
        const auto column = column_[static_cast<size_t>(layer)];
        T* base = static_cast<T*>(buffer_.data()) + static_cast<uint64_t>(column) * column_elements_;
        const auto w = static_cast<int32_t>(owned_.width());
        const auto h = static_cast<int32_t>(owned_.height());
        return {base + halo_ * stride_ + halo_, stride_, -halo_, -halo_, w + halo_, h + halo_};
    }

    int32_t level_ = 0;
    int32_t halo_ = 0;
    CellRect owned_;
    LayerSet layers_;
    int64_t stride_ = 0;
    uint64_t column_elements_ = 0;
    std::array<int8_t, k_layer_count> column_{};
    Buffer buffer_;
};

/// Metres of a ticks value, exact to a float's precision.
SAHEL_HD float metres_of_ticks(int32_t ticks) {
    return static_cast<float>(ticks) * k_m_per_tick;
}
/// Nearest tick (halves away from zero); the caller keeps |metres| below 16384.
SAHEL_HD int32_t ticks_of_metres(float metres) {
    const float t = metres * k_ticks_per_m; // exact: a power of two
    const int32_t whole = static_cast<int32_t>(t);
    const float part = t - static_cast<float>(whole); // exact, where adding a half would not be (|t| > 2^22)
    return whole + static_cast<int32_t>(part >= 0.5f) - static_cast<int32_t>(part <= -0.5f);
}

} // namespace sahel
