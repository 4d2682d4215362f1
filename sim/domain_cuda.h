#pragma once

#include "sim/exchange_plan.h"
#include "world/result.h"

#include <cstdint>

/// The device side of TileDomain. Built without CUDA these answer "unsupported" (domain_cuda_none.cpp).
namespace sahel::cuda {

/// One launch for all copies of a layer: on one device a message needs no buffer between its two ends.
Status exchange(const HaloCopy* device_copies, int32_t count, int32_t longest_cells, SlabView<uint32_t> slab,
                Mirror mirror);
/// Packs and unpacks one message, for neighbours on another machine; `words` is device memory.
Status pack(const HaloCopy* device_copies, const HaloMessage& m, SlabView<const uint32_t> slab, Mirror mirror,
            uint32_t* words);
Status unpack(const HaloCopy* device_copies, const HaloMessage& m, SlabView<uint32_t> slab, const uint32_t* words);
Status fill_words(uint32_t* words, int64_t count, uint32_t value);
Status fill_edges(const EdgeFill* device_fills, int32_t count, int32_t longest_cells, const EdgeLayers& layers);
/// Sums of owned cells for each slot, into host memory. Integer atomics: any order gives the same.
Status sums(SlabView<const int32_t> slab, int32_t slots, int32_t n, int64_t* host_sums);

} // namespace sahel::cuda
