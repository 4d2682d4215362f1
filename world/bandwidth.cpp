#include "world/bandwidth.h"

#include "world/executor.h"
#include "world/memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <sched.h>
#include <string_view>
#include <sys/utsname.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace sahel {

namespace {

// The value of the first line "key ... : value" or "key: value" of a file in /proc; empty if there is none.
std::string proc_value(const char* path, std::string_view key) {
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        if (!line.starts_with(key)) continue;
        const size_t colon = line.find(':');
        if (colon == std::string::npos) continue;
        const size_t first = line.find_first_not_of(" \t", colon + 1);
        return first == std::string::npos ? std::string() : line.substr(first);
    }
    return {};
}

constexpr int k_repetitions = 6; // the first ones also fault in the pages and wake the clock
constexpr uint64_t k_default_array_bytes = 256'000'000;
constexpr uint64_t k_smallest_array_bytes = 1 << 20;

} // namespace

CpuInfo cpu_info() {
    CpuInfo info;
    info.name = proc_value("/proc/cpuinfo", "model name");
    if (info.name.empty()) {
        utsname system{};
        info.name = uname(&system) == 0 ? system.machine : "unknown";
    }
    cpu_set_t allowed;
    CPU_ZERO(&allowed);
    if (sched_getaffinity(0, sizeof(allowed), &allowed) == 0)
        info.cores = std::max(1, CPU_COUNT(&allowed));
    else
        info.cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    const long pages = sysconf(_SC_PHYS_PAGES);
    const long page = sysconf(_SC_PAGESIZE);
    if (pages > 0 && page > 0) info.memory_bytes = static_cast<uint64_t>(pages) * static_cast<uint64_t>(page);
    const std::string available = proc_value("/proc/meminfo", "MemAvailable"); // in kB
    info.available_bytes =
        available.empty() ? info.memory_bytes / 2 : std::strtoull(available.c_str(), nullptr, 10) * 1024;
    return info;
}

Result<Bandwidth> measure_memory_bandwidth(int threads, uint64_t array_bytes) {
    const CpuInfo cpu = cpu_info();
    const int count = threads > 0 ? threads : cpu.cores;
    if (array_bytes == 0) array_bytes = std::min(k_default_array_bytes, cpu.available_bytes / 8);
    array_bytes = std::max(array_bytes, k_smallest_array_bytes) / sizeof(float) * sizeof(float);
    SAHEL_ASSIGN(Buffer a_buffer, Buffer::allocate(MemoryPool::host(), array_bytes));
    SAHEL_ASSIGN(Buffer b_buffer, Buffer::allocate(MemoryPool::host(), array_bytes));
    SAHEL_ASSIGN(Buffer c_buffer, Buffer::allocate(MemoryPool::host(), array_bytes));
    auto* const a = static_cast<float*>(a_buffer.data());
    auto* const b = static_cast<float*>(b_buffer.data());
    auto* const c = static_cast<float*>(c_buffer.data());
    const auto n = static_cast<int64_t>(array_bytes / sizeof(float));

    // Plain threads, one slice each, which first touch their own pages. The threads of the executor may be fewer.
    const auto on_slices = [&](const auto& work) {
        std::vector<std::thread> helpers;
        for (int t = 1; t < count; ++t) helpers.emplace_back([&, t] { work(n * t / count, n * (t + 1) / count); });
        work(0, n / count);
        for (std::thread& helper : helpers) helper.join();
    };
    on_slices([&](int64_t first, int64_t last) {
        for (int64_t i = first; i < last; ++i) {
            a[i] = 0.0f;
            b[i] = 1.0f;
            c[i] = static_cast<float>(i & 7);
        }
    });
    double best_s = 1e30;
    for (int r = 0; r < k_repetitions; ++r) {
        const float s = 2.0f + static_cast<float>(r);
        const auto start = std::chrono::steady_clock::now();
        on_slices([&](int64_t first, int64_t last) {
            SAHEL_VECTORIZE
            for (int64_t i = first; i < last; ++i) a[i] = b[i] + s * c[i];
        });
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        best_s = std::min(best_s, took.count());
        SAHEL_CHECK_EQ(a[n - 1], 1.0f + s * static_cast<float>((n - 1) & 7)); // the work was done
    }
    return Bandwidth{3.0 * static_cast<double>(array_bytes) / best_s * 1e-9, array_bytes, count};
}

} // namespace sahel
