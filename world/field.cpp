#include "world/field.h"

#include <cstring>
#include <limits>

namespace sahel {

namespace {
// Rows start on a cache line, so that neighbouring rows written by two threads never share one.
constexpr int64_t k_row_elements = 16;
int64_t stride_of(const CellRect& owned, int32_t halo) {
    const int64_t width = owned.width() + 2 * static_cast<int64_t>(halo);
    return (width + k_row_elements - 1) / k_row_elements * k_row_elements;
}
} // namespace

uint64_t LayerBlock::bytes_needed(const CellRect& owned, int32_t halo, LayerSet layers) {
    const auto rows = static_cast<uint64_t>(owned.height() + 2 * static_cast<int64_t>(halo));
    uint64_t bytes = 0;
    // What is more than a machine can address is "too much" for every pool, not a small remainder.
    if (__builtin_mul_overflow(rows, static_cast<uint64_t>(stride_of(owned, halo)), &bytes) ||
        __builtin_mul_overflow(bytes, 4u * static_cast<uint64_t>(layers.size()), &bytes))
        return std::numeric_limits<uint64_t>::max();
    return bytes;
}

Result<LayerBlock> LayerBlock::allocate(int32_t level, const CellRect& owned, int32_t halo, LayerSet layers,
                                        MemoryPool& pool) {
    SAHEL_CHECK(!owned.empty());
    SAHEL_CHECK_LE(0, halo);
    SAHEL_CHECK(!layers.empty());
    // Local coordinates are int32.
    SAHEL_CHECK_LE(owned.width() + 2 * static_cast<int64_t>(halo), std::numeric_limits<int32_t>::max());
    SAHEL_CHECK_LE(owned.height() + 2 * static_cast<int64_t>(halo), std::numeric_limits<int32_t>::max());
    LayerBlock block;
    block.level_ = level;
    block.halo_ = halo;
    block.owned_ = owned;
    block.layers_ = layers;
    block.stride_ = stride_of(owned, halo);
    block.column_elements_ =
        static_cast<uint64_t>(owned.height() + 2 * static_cast<int64_t>(halo)) * static_cast<uint64_t>(block.stride_);
    int8_t column = 0;
    layers.for_each([&](Layer l) { block.column_[static_cast<size_t>(l)] = column++; });
    SAHEL_ASSIGN(block.buffer_, Buffer::allocate(pool, bytes_needed(owned, halo, layers)));
    return block;
}

void LayerBlock::clear() {
    SAHEL_CHECK(memory_kind() == MemoryKind::host);
    if (!buffer_.empty()) std::memset(buffer_.data(), 0, buffer_.bytes());
}

} // namespace sahel
