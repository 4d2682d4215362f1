#pragma once

#include "world/result.h"

#include <cstdint>
#include <string>

/// What the machine is and how fast its memory is: the ceiling that every kernel's number is held against
/// (`sahel doctor`, `sahel bench`).
namespace sahel {

struct CpuInfo {
    std::string name;             ///< as the processor calls itself, or the architecture
    int cores = 1;                ///< that this process may run on
    uint64_t memory_bytes = 0;    ///< of the machine
    uint64_t available_bytes = 0; ///< that could be taken now without swapping
};
CpuInfo cpu_info();

struct Bandwidth {
    double gb_per_s = 0.0;    ///< best of the repetitions; 1 GB = 1e9 bytes
    uint64_t array_bytes = 0; ///< of each of the three arrays
    int threads = 0;          ///< 0 on a CUDA device
};

/// STREAM triad, a[i] = b[i] + s * c[i] (McCalpin 1995), each array counted once: the line of `a` that a write first
/// reads is not counted. Each array is 256 MB, or less where an eighth of the available memory is less; `array_bytes`
/// asks for another size. 0 threads means one per core. Takes about a second. Errors: budget, io (no memory).
Result<Bandwidth> measure_memory_bandwidth(int threads = 0, uint64_t array_bytes = 0);

/// The same triad in the memory of CUDA device 0. Errors: unsupported (no device, or built without CUDA), budget, io.
Result<Bandwidth> measure_cuda_bandwidth(uint64_t array_bytes = 256'000'000);

} // namespace sahel
