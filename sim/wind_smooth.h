#pragma once

#include "world/cpu_features.h"

#include <cstdint>
#include <vector>

/// Gaussian smoothing of a plane by a pyramid, axis by axis: halve the axis while the standard deviation stays at least
/// four cells, convolve there with a sampled Gaussian, interpolate back.
///
///     level 0   in --[1 3 3 1]/8--.                                .--[1 3], [3 1] /4--> out
///     level 1                      '--[1 3 3 1]/8--.        .-----'
///     level 2                                       Gaussian        of variance sigma^2 / 16 - (1 - 1/16) / 2
///
/// Halving and interpolating smooth by a variance of 3/4 cell each (of the finer level); the Gaussian has what is left.
/// A periodic axis wraps; any other is continued by its mirror image (the edge cell twice: no slope across the edge).
/// An axis of an odd number of cells is not halved further.
///
/// Measured against the Fourier transform of a sampled Gaussian: see sim/README.md. Burt and Adelson: The Laplacian
/// pyramid as a compact image code (IEEE Trans. Comm. 1983), with the Gaussian made exact.
namespace sahel {

struct SmoothAxis {
    int32_t cells = 0;
    int32_t levels = 0; ///< halvings
    int32_t radius = 0;
    bool periodic = false;
    const float* weights = nullptr; ///< [0 .. radius]; w0 + 2 (w1 + ...) = 1
};

struct SmoothWork {
    SmoothAxis x, y;
    const float* in; ///< rows of x.cells floats, without padding; so are all
    float* out;
    float* a; ///< working planes of the size of `in`
    float* b;
    float* rows; ///< rows with margins: (cells + 2 radius) x rows, of the coarsest level in x
};
SAHEL_ISA_DECLARE(void run_smooth_wind(const SmoothWork& work))

class GaussianSmoother {
  public:
    /// sigma in cells of the plane; 0 copies.
    GaussianSmoother(int32_t nx, int32_t ny, bool periodic_x, bool periodic_y, double sigma_cells);
    /// Planes of nx x ny floats; `out` is not `in`.
    void run(const float* in, float* out);

  private:
    SmoothWork work_{};
    std::vector<float> weights_x_, weights_y_;
    std::vector<float> a_, b_, rows_;
};

} // namespace sahel
