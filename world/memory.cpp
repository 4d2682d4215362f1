#include "world/memory.h"

#include "world/cuda_runtime.h"

#include <fmt/format.h>

#include <cstdlib>
#include <limits>
#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace sahel {

namespace {
#if defined(SAHEL_DEBUG)
void poison(void* data, uint64_t bytes) {
    auto* words = static_cast<uint32_t*>(data);
    for (uint64_t i = 0; i < bytes / 4; ++i) words[i] = 0x7FA00000u; // a signalling NaN
}
#endif

/// Large columns lie in huge pages where the kernel grants them: a row of a wide slab is a page of its own, and passes
/// that read several columns row by row would wait for the page tables as long as for the data.
void* allocate_host(uint64_t bytes) {
    constexpr uint64_t k_huge_page = uint64_t{2} << 20;
    const bool huge = bytes >= 2 * k_huge_page;
    void* data = nullptr;
    if (posix_memalign(&data, huge ? k_huge_page : Buffer::k_alignment, bytes) != 0) return nullptr;
#if defined(__linux__)
    if (huge) madvise(data, bytes, MADV_HUGEPAGE); // a wish: nothing depends on it
#endif
    return data;
}
} // namespace

MemoryPool::~MemoryPool() {
    SAHEL_CHECK_EQ(used_bytes(), 0u);
}

MemoryPool& MemoryPool::host() {
    // Never destroyed: buffers with static lifetime may outlive any other static object.
    static auto* pool = new MemoryPool("host", MemoryKind::host, std::numeric_limits<uint64_t>::max());
    return *pool;
}

bool MemoryPool::reserve(uint64_t bytes) {
    uint64_t used = used_bytes_.load(std::memory_order_relaxed);
    do {
        if (bytes > limit_bytes_ || used > limit_bytes_ - bytes) return false;
    } while (!used_bytes_.compare_exchange_weak(used, used + bytes, std::memory_order_relaxed));
    uint64_t peak = peak_bytes_.load(std::memory_order_relaxed);
    while (peak < used + bytes && !peak_bytes_.compare_exchange_weak(peak, used + bytes, std::memory_order_relaxed)) {
    }
    return true;
}

void MemoryPool::release(uint64_t bytes) {
    const uint64_t before = used_bytes_.fetch_sub(bytes, std::memory_order_relaxed);
    SAHEL_CHECK_LE(bytes, before);
}

Result<Buffer> Buffer::allocate(MemoryPool& pool, uint64_t bytes) {
    Buffer buffer;
    if (bytes == 0) return buffer;
    const uint64_t rounded = taken_bytes(bytes);
    if (rounded < bytes || !pool.reserve(rounded))
        return Error{ErrorKind::budget,
                     fmt::format("memory pool '{}': {} bytes asked, {} of {} in use; raise the limit or load less",
                                 pool.name(), bytes, pool.used_bytes(), pool.limit_bytes())};
    void* data = nullptr;
    if (pool.kind() == MemoryKind::cuda) {
        auto allocated = cuda::allocate(rounded);
        if (!allocated.ok()) {
            pool.release(rounded);
            return allocated.error();
        }
        data = allocated.value();
    } else {
        data = allocate_host(rounded);
        if (!data) {
            pool.release(rounded);
            return Error{ErrorKind::io,
                         fmt::format("memory pool '{}': the machine could not give {} bytes", pool.name(), rounded)};
        }
#if defined(SAHEL_DEBUG)
        poison(data, rounded);
#endif
    }
    buffer.pool_ = &pool;
    buffer.data_ = data;
    buffer.bytes_ = rounded;
    return buffer;
}

void Buffer::reset() {
    if (!data_) return;
    if (pool_->kind() == MemoryKind::cuda)
        cuda::free(data_);
    else
        std::free(data_);
    pool_->release(bytes_);
    pool_ = nullptr;
    data_ = nullptr;
    bytes_ = 0;
}

} // namespace sahel
