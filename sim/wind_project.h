#pragma once

#include "sim/wind_plane.h"
#include "world/cpu_features.h"

#include <cstdint>
#include <vector>

/// Takes the divergence out of the coarse wind: w - grad q with div grad q = div w (the paper's projection, on a grid
/// that closes). Wind lives at the centres of coarse cells, divergence and q at their corners:
///
///     w    w    w        div at +: mean of the two right minus mean of the two left winds in x, plus the same in y
///       +    +           grad at w: the same with the four corners around it
///     w    w    w
///                        Wind that cells read is bilinear between centres; what flows out of the square between four
///                        centres is exactly the div in its middle. So after projection as much wind enters every
///                        such square as leaves it, and no wave of two cells is invisible but the one (+ - / - +),
///                        which no input has (wind_warp.h).
///
/// Across a periodic border everything wraps; the mean wind stays. At any other border q = 0 on the outermost row of
/// corners: wind enters and leaves freely there, and the mean wind stays too.
///
/// -div grad =: A is solved by conjugate gradients. A couples the diagonal neighbours alone, so it does not see the
/// checkerboard c = (-1)^(x + y), and treats a smooth plane times c like the smooth plane: A c p = c A p. Hence the
/// preconditioner B + c B' c: B is one V-cycle of multigrid for the compact five-point operator, which agrees with A in
/// all long waves; B' is the same from the second level on. (With exact inverses the eigenvalues are those of
/// 2 (X - 2 P) / X (2 - X), X = sin^2 + sin^2, P = sin^2 sin^2 of half the wave numbers: between 1 and 2.) Multigrid is
/// vertex-centred, coarsened while both axes are even, smoothed by Chebyshev iteration on the upper three quarters of
/// the spectrum, and on the coarsest grid by as many steps of it as its side needs. A fixed iteration, sums in one
/// order: the same bits anywhere. After Brandt (Math. Comp. 1977) and Tatebe (Copper Mountain 1993); Almgren, Bell and
/// Szymczak (SIAM J. Sci. Comput. 1996) for this pair of div and grad.
namespace sahel {

struct ProjectLevel {
    WindPlane b, e, r, d, next; ///< right side, solution, residual, search direction and the next one
    WindRing ring_x = WindRing::zero, ring_y = WindRing::zero;
};

struct ProjectWork {
    const ProjectLevel* levels;
    int32_t level_count;
    float coarsest_low; ///< least eigenvalue of the five-point operator there, apart from 0
    int32_t coarsest_steps;
    WindPlane wind_x, wind_y; ///< with rings filled
    WindRing ring_x, ring_y;  ///< of the wind
    WindPlane q, d, ad;       ///< at corners
    double* row_sums;         ///< one for each row
    int32_t most_iterations;
    float tolerance;
    // results
    float before, after; ///< largest divergence, m/s for each spacing
    int32_t iterations;
};
SAHEL_ISA_DECLARE(void run_project_wind(ProjectWork& work))

class WindProjection {
  public:
    static constexpr int k_most_iterations = 40;
    static constexpr float k_tolerance = 1e-4f; ///< largest residual, as a share of the largest divergence

    /// nx x ny coarse cells.
    WindProjection(int32_t nx, int32_t ny, bool periodic_x, bool periodic_y);
    struct Outcome {
        float before = 0.0f, after = 0.0f;
        int32_t iterations = 0;
    };
    /// Planes with rings filled; their rings are stale afterwards.
    Outcome run(WindPlane wind_x, WindPlane wind_y);

  private:
    WindPlane plane(int32_t nx, int32_t ny);

    std::vector<std::vector<float>> memory_;
    std::vector<double> row_sums_;
    std::vector<ProjectLevel> levels_;
    ProjectWork work_{};
};

} // namespace sahel
