#include "sim/wind_smooth.h"

#include "pass_check.h"
#include "spectral.h"
#include "world/cpu_features.h"
#include "world/executor.h"
#include "world/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace sahel::test {
namespace {

// Ground-like: waves whose height falls with their number, a cliff, and noise from cell to cell.
Plane terrain(int32_t nx, int32_t ny) {
    Plane h;
    for (int32_t y = 0; y < ny; ++y)
        for (int32_t x = 0; x < nx; ++x) {
            double v = 0.0;
            for (int k = 1; k <= 16; k *= 2)
                v += std::sin(2.0 * M_PI * k * x / nx + k) * std::cos(2.0 * M_PI * k * y / ny + 2.0 * k) / k;
            if (x > nx / 3 && x < nx / 2 && y > ny / 4 && y < 3 * ny / 4) v += 1.0;
            v += 0.4 * uniform(RandomStream(1, 0, Purpose::test).at(x, y).v[0]);
            h.push_back(100.0 * v);
        }
    return h;
}

std::vector<float> smoothed(const Plane& in, int32_t nx, int32_t ny, bool px, bool py, double sigma) {
    const std::vector<float> from(in.begin(), in.end());
    std::vector<float> to(in.size());
    GaussianSmoother(nx, ny, px, py, sigma).run(from.data(), to.data());
    return to;
}

double error_of(const std::vector<float>& found, const Plane& wanted) {
    double most = 0.0;
    for (size_t i = 0; i < wanted.size(); ++i)
        most = std::max(most, std::abs(static_cast<double>(found[i]) - wanted[i]));
    return most;
}

TEST(WindSmooth, IsAGaussianToAThousandthOfTheRange) {
    double worst = 0.0;
    for (const auto& [nx, ny] : {std::pair{128, 128}, {256, 128}, {48, 80}, {33, 20}})
        for (const double sigma : {0.5, 1.0, 3.125, 4.0, 7.9, 8.0, 12.5, 20.0, 41.0, 125.0, 1000.0}) {
            const Plane h = terrain(nx, ny);
            const double error =
                error_of(smoothed(h, nx, ny, true, true, sigma), gaussian_by_fft(h, nx, ny, sigma)) / range(h);
            EXPECT_LT(error, 1e-3) << nx << " x " << ny << ", sigma " << sigma;
            worst = std::max(worst, error);
        }
    std::printf("largest error: %.1e of the range\n", worst);
}

TEST(WindSmooth, SlopesAreThoseOfTheGaussian) {
    const int32_t n = 128;
    const Plane h = terrain(n, n);
    for (const double sigma : {3.125, 12.5, 41.0}) {
        const auto found = smoothed(h, n, n, true, true, sigma);
        const Plane wanted = gaussian_by_fft(h, n, n, sigma);
        double most = 0.0;
        double steepest = 0.0;
        for (int32_t y = 0; y < n; ++y)
            for (int32_t x = 1; x + 1 < n; ++x) {
                const auto i = static_cast<size_t>(y * n + x);
                const double slope = wanted[i + 1] - wanted[i - 1];
                most = std::max(most, std::abs(static_cast<double>(found[i + 1] - found[i - 1]) - slope));
                steepest = std::max(steepest, std::abs(slope));
            }
        EXPECT_LT(most, 1.5e-2 * steepest) << sigma;
        std::printf("sigma %g: slopes to %.1e of the steepest\n", sigma, most / steepest);
    }
}

TEST(WindSmooth, OpenBordersContinueByTheMirrorImage) {
    const int32_t nx = 64;
    const int32_t ny = 48;
    const Plane h = terrain(nx, ny);
    Plane twice; // periodic, twice as wide: the mirror image beside the plane
    for (int32_t y = 0; y < 2 * ny; ++y)
        for (int32_t x = 0; x < 2 * nx; ++x)
            twice.push_back(h[static_cast<size_t>((y < ny ? y : 2 * ny - 1 - y) * nx + (x < nx ? x : 2 * nx - 1 - x))]);
    for (const double sigma : {3.125, 12.5, 60.0}) {
        const Plane wide = gaussian_by_fft(twice, 2 * nx, 2 * ny, sigma);
        Plane wanted;
        for (int32_t y = 0; y < ny; ++y)
            for (int32_t x = 0; x < nx; ++x) wanted.push_back(wide[static_cast<size_t>(y * 2 * nx + x)]);
        EXPECT_LT(error_of(smoothed(h, nx, ny, false, false, sigma), wanted), 1e-3 * range(h)) << sigma;
    }
}

TEST(WindSmooth, APointStaysWhereItIs) { // the published kernel moves it by half a cell
    const int32_t n = 128;
    for (const double sigma : {3.0, 12.5}) {
        Plane h(static_cast<size_t>(n * n), 0.0);
        h[static_cast<size_t>(63 * n + 60)] = 1000.0;
        const auto s = smoothed(h, n, n, true, true, sigma);
        double sum = 0.0;
        double at_x = 0.0;
        double at_y = 0.0;
        for (int32_t y = 0; y < n; ++y)
            for (int32_t x = 0; x < n; ++x) {
                const double v = s[static_cast<size_t>(y * n + x)];
                sum += v;
                at_x += v * x;
                at_y += v * y;
            }
        EXPECT_NEAR(sum, 1000.0, 0.1);
        EXPECT_NEAR(at_x / sum, 60.0, 1e-3);
        EXPECT_NEAR(at_y / sum, 63.0, 1e-3);
    }
}

TEST(WindSmooth, AMirroredPlaneGivesTheMirroredResult) {
    const int32_t nx = 96;
    const int32_t ny = 64;
    const Plane h = terrain(nx, ny);
    Plane mirrored(h.size());
    for (int32_t y = 0; y < ny; ++y)
        for (int32_t x = 0; x < nx; ++x)
            mirrored[static_cast<size_t>(y * nx + x)] = h[static_cast<size_t>((ny - 1 - y) * nx + nx - 1 - x)];
    for (const bool periodic : {true, false})
        for (const double sigma : {3.0, 20.0}) {
            const auto a = smoothed(h, nx, ny, periodic, periodic, sigma);
            const auto b = smoothed(mirrored, nx, ny, periodic, periodic, sigma);
            for (size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a[i], b[a.size() - 1 - i]);
        }
}

TEST(WindSmooth, TheSameBitsOnAnyThreadsAndInstructionSet) {
    const RestoreMachine restore;
    const int32_t nx = 256;
    const int32_t ny = 192;
    const Plane h = terrain(nx, ny);
    std::vector<float> first;
    for (const int threads : {1, 2, 5})
        for (const Isa wanted : {Isa::baseline, Isa::v3}) {
            if (set_isa(wanted) != wanted) continue;
            set_thread_count(threads);
            const auto s = smoothed(h, nx, ny, true, false, 30.0);
            if (first.empty()) first = s;
            EXPECT_EQ(s, first) << threads << ' ' << name_of(wanted);
        }
}

} // namespace
} // namespace sahel::test
