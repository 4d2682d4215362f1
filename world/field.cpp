#include "world/field.h"

#include <cstring>

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
    return rows * static_cast<uint64_t>(stride_of(owned, halo)) * 4u * static_cast<uint64_t>(layers.size());
}

Result<LayerBlock> LayerBlock::allocate(int32_t level, const CellRect& owned, int32_t halo, LayerSet layers,
                                        MemoryPool& pool) {
    SAHEL_CHECK(!owned.empty());
    SAHEL_CHECK_LE(0, halo);
    SAHEL_CHECK(!layers.empty());
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
