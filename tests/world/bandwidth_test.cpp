#include "world/bandwidth.h"

#include "world/cuda_runtime.h"
#include "world/memory.h"

#include <gtest/gtest.h>

namespace sahel {
namespace {

TEST(Bandwidth, CpuHasANameCoresAndMemory) {
    const CpuInfo cpu = cpu_info();
    EXPECT_FALSE(cpu.name.empty());
    EXPECT_EQ(cpu.name.find('\n'), std::string::npos);
    EXPECT_GE(cpu.cores, 1);
    EXPECT_GT(cpu.memory_bytes, uint64_t{64} << 20);
    EXPECT_GT(cpu.available_bytes, 0u);
    EXPECT_LE(cpu.available_bytes, cpu.memory_bytes);
}

// How fast is not for a test to say; that it is measured with what was asked, is.
TEST(Bandwidth, MeasuresWithTheThreadsAndSizeAskedFor) {
    const uint64_t before = MemoryPool::host().used_bytes();
    for (const int threads : {1, 3}) {
        const auto measured = measure_memory_bandwidth(threads, 4'000'000);
        ASSERT_TRUE(measured.ok()) << measured.error().message;
        EXPECT_EQ(measured->threads, threads);
        EXPECT_EQ(measured->array_bytes, 4'000'000u);
        EXPECT_GT(measured->gb_per_s, 0.0);
    }
    EXPECT_EQ(MemoryPool::host().used_bytes(), before);
}

TEST(Bandwidth, OfACudaDevice) {
    const auto measured = measure_cuda_bandwidth(64'000'000);
    if (!cuda::available()) {
        ASSERT_FALSE(measured.ok());
        EXPECT_EQ(measured.error().kind, ErrorKind::unsupported);
        GTEST_SKIP() << measured.error().message;
    }
    ASSERT_TRUE(measured.ok()) << measured.error().message;
    EXPECT_GT(measured->gb_per_s, 1.0);
}

} // namespace
} // namespace sahel
