#pragma once

#include "world/result.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

/// One allocator for host and CUDA memory. It counts every byte exactly and refuses what would exceed its limit:
/// budgets are promises, so a refusal is an Error that the caller answers by loading less, never a crash.
namespace sahel {

enum class MemoryKind : uint8_t { host, cuda };

/// A named account of bytes. Thread safe. Outlives every Buffer taken from it.
class MemoryPool {
  public:
    MemoryPool(std::string name, MemoryKind kind, uint64_t limit_bytes)
        : name_(std::move(name)), kind_(kind), limit_bytes_(limit_bytes) {}
    MemoryPool(const MemoryPool&) = delete;
    MemoryPool& operator=(const MemoryPool&) = delete;
    ~MemoryPool();

    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] MemoryKind kind() const { return kind_; }
    [[nodiscard]] uint64_t used_bytes() const { return used_bytes_.load(std::memory_order_relaxed); }
    [[nodiscard]] uint64_t peak_bytes() const { return peak_bytes_.load(std::memory_order_relaxed); }
    [[nodiscard]] uint64_t limit_bytes() const { return limit_bytes_; }

    /// The process-wide pool of ordinary memory, without a limit.
    static MemoryPool& host();

  private:
    friend class Buffer;
    [[nodiscard]] bool reserve(uint64_t bytes);
    void release(uint64_t bytes);

    std::string name_;
    MemoryKind kind_;
    uint64_t limit_bytes_;
    std::atomic<uint64_t> used_bytes_{0};
    std::atomic<uint64_t> peak_bytes_{0};
};

/// Owns bytes of a pool, 64-byte aligned (256 on CUDA). Contents are not initialised; in debug builds host memory is
/// poisoned with signalling NaN patterns (0x7FA00000), so that reading what was never written shows.
class Buffer {
  public:
    Buffer() = default;
    Buffer(Buffer&& o) noexcept
        : pool_(std::exchange(o.pool_, nullptr)), data_(std::exchange(o.data_, nullptr)),
          bytes_(std::exchange(o.bytes_, 0)) {}
    Buffer& operator=(Buffer&& o) noexcept {
        if (this != &o) {
            reset();
            pool_ = std::exchange(o.pool_, nullptr);
            data_ = std::exchange(o.data_, nullptr);
            bytes_ = std::exchange(o.bytes_, 0);
        }
        return *this;
    }
    ~Buffer() { reset(); }

    /// Errors: budget (names the pool, what it holds, what was asked), io (the machine has no more memory).
    static Result<Buffer> allocate(MemoryPool& pool, uint64_t bytes);
    /// What allocate takes of the pool for so many: whole cache lines. For exact predictions.
    static constexpr uint64_t taken_bytes(uint64_t bytes) {
        return (bytes + k_alignment - 1) / k_alignment * k_alignment;
    }
    static constexpr uint64_t k_alignment = 64; // one cache line, one AVX-512 register

    void reset();
    [[nodiscard]] void* data() const { return data_; }
    [[nodiscard]] uint64_t bytes() const { return bytes_; }
    [[nodiscard]] bool empty() const { return bytes_ == 0; }
    [[nodiscard]] MemoryKind kind() const { return pool_ ? pool_->kind() : MemoryKind::host; }

  private:
    MemoryPool* pool_ = nullptr;
    void* data_ = nullptr;
    uint64_t bytes_ = 0;
};

} // namespace sahel
