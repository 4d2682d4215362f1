#pragma once

#include "world/result.h"

#include <cuda_runtime.h>

#include <string>

/// Every CUDA call and launch is checked by name.
namespace sahel::cuda {

inline Status check_call(cudaError_t error, const char* what) {
    if (error == cudaSuccess) return {};
    const ErrorKind kind = error == cudaErrorMemoryAllocation ? ErrorKind::budget : ErrorKind::io;
    return Error{kind, std::string("CUDA: ") + what + ": " + cudaGetErrorString(error)};
}

/// Right after a launch: `check_launch("sim/talus")`.
inline Status check_launch(const char* kernel) {
    return check_call(cudaGetLastError(), kernel);
}

} // namespace sahel::cuda
