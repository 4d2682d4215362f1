#pragma once

#include <cstdint>
#include <vector>

/// References by Fourier transforms (FFTW, double precision), for tests alone. Planes are row by row, nx columns,
/// periodic; lengths in cells.
namespace sahel::test {

using Plane = std::vector<double>;

/// Convolution with a Gaussian sampled at whole cells, summed over its periodic images, of sum 1.
Plane gaussian_by_fft(const Plane& in, int32_t nx, int32_t ny, double sigma_cells);

struct VectorPlane {
    Plane x, y;
};
/// Removes the divergence with physical wave numbers.
VectorPlane project_by_fft(const VectorPlane& in, int32_t nx, int32_t ny);
Plane divergence_by_fft(const VectorPlane& in, int32_t nx, int32_t ny);

double rms(const Plane& p);
double largest(const Plane& p);
/// Largest minus smallest.
double range(const Plane& p);

} // namespace sahel::test
