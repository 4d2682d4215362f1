#pragma once

#include "world/result.h"

#include <cstdint>
#include <string>

/// The few CUDA runtime calls that plain C++ files need. Built with CUDA they call the runtime (cuda_runtime.cu);
/// built without, they answer "unsupported" (cuda_runtime_none.cpp). A program built with CUDA starts and runs on the
/// CPU where there is no driver.
namespace sahel::cuda {

struct DeviceStatus {
    bool built = false;   ///< compiled with a CUDA backend
    int device_count = 0; ///< devices that can be used now
    std::string name;     ///< of device 0, empty without one
    uint64_t memory_bytes = 0;
    int runtime_version = 0; ///< 13000 means 13.0
    std::string why_not;     ///< one line when there is no usable device
};

/// Looks once and remembers; never fails.
const DeviceStatus& status();
inline bool available() {
    return status().device_count > 0;
}

Result<void*> allocate(uint64_t bytes);
void free(void* data);
Status copy_to_device(void* device, const void* host, uint64_t bytes);
Status copy_to_host(void* host, const void* device, uint64_t bytes);
Status synchronize();

} // namespace sahel::cuda
