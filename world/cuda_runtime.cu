#include "world/cuda_check.cuh"
#include "world/cuda_runtime.h"

namespace sahel::cuda {

const DeviceStatus& status() {
    static const DeviceStatus found = [] {
        DeviceStatus s;
        s.built = true;
        cudaRuntimeGetVersion(&s.runtime_version);
        int count = 0;
        const cudaError_t error = cudaGetDeviceCount(&count);
        if (error != cudaSuccess || count == 0) {
            // Also what the runtime says where there is no driver at all.
            const bool no_driver = error == cudaErrorInsufficientDriver;
            s.why_not = no_driver ? "no NVIDIA driver for CUDA " + std::to_string(s.runtime_version / 1000) +
                                        " or newer is installed"
                        : error != cudaSuccess ? cudaGetErrorString(error)
                                               : "no CUDA device";
            (void)cudaGetLastError(); // forget it: the CPU backend goes on
            return s;
        }
        cudaDeviceProp properties{};
        if (const cudaError_t asked = cudaGetDeviceProperties(&properties, 0); asked != cudaSuccess) {
            s.why_not = cudaGetErrorString(asked);
            return s;
        }
        s.device_count = count;
        s.name = properties.name;
        s.memory_bytes = properties.totalGlobalMem;
        return s;
    }();
    return found;
}

Result<void*> allocate(uint64_t bytes) {
    void* data = nullptr;
    SAHEL_TRY(check_call(cudaMalloc(&data, bytes), "cudaMalloc"));
    return data;
}

void free(void* data) {
    const Status freed = check_call(cudaFree(data), "cudaFree");
    SAHEL_CHECK(freed.ok());
}

Status copy_to_device(void* device, const void* host, uint64_t bytes) {
    return check_call(cudaMemcpy(device, host, bytes, cudaMemcpyHostToDevice), "cudaMemcpy to the device");
}

Status copy_to_host(void* host, const void* device, uint64_t bytes) {
    return check_call(cudaMemcpy(host, device, bytes, cudaMemcpyDeviceToHost), "cudaMemcpy to the host");
}

Status synchronize() {
    return check_call(cudaDeviceSynchronize(), "cudaDeviceSynchronize");
}

} // namespace sahel::cuda
