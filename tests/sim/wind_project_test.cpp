#include "sim/wind_project.h"

#include "pass_check.h"
#include "spectral.h"
#include "world/cpu_features.h"
#include "world/executor.h"
#include "world/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace sahel::test {
namespace {

// Two planes with rings, and what projection makes of them.
struct Wind {
    int32_t nx, ny;
    bool periodic_x, periodic_y;
    std::vector<float> memory_x, memory_y;
    WindPlane x, y;
    WindProjection::Outcome outcome;

    Wind(const VectorPlane& in, int32_t nx_in, int32_t ny_in, bool px, bool py)
        : nx(nx_in), ny(ny_in), periodic_x(px), periodic_y(py),
          memory_x(static_cast<size_t>(WindPlane::floats(nx, ny))), memory_y(memory_x.size()),
          x(WindPlane::in(memory_x.data(), nx, ny)), y(WindPlane::in(memory_y.data(), nx, ny)) {
        for (int32_t j = 0; j < ny; ++j)
            for (int32_t i = 0; i < nx; ++i) {
                x.row(j)[i] = static_cast<float>(in.x[static_cast<size_t>(j * nx + i)]);
                y.row(j)[i] = static_cast<float>(in.y[static_cast<size_t>(j * nx + i)]);
            }
        fill();
        outcome = WindProjection(nx, ny, px, py).run(x, y);
        fill();
    }
    void fill() const {
        for (const WindPlane* p : {&x, &y})
            p->fill_ring(periodic_x ? WindRing::wrap : WindRing::edge, periodic_y ? WindRing::wrap : WindRing::edge);
    }
    [[nodiscard]] VectorPlane planes() const {
        VectorPlane out;
        for (int32_t j = 0; j < ny; ++j)
            for (int32_t i = 0; i < nx; ++i) {
                out.x.push_back(x.row(j)[i]);
                out.y.push_back(y.row(j)[i]);
            }
        return out;
    }
    // What flows out of the square between four centres, in double.
    [[nodiscard]] double most_divergence() const {
        double most = 0.0;
        for (int32_t j = 0; j < (periodic_y ? ny : ny - 1); ++j)
            for (int32_t i = 0; i < (periodic_x ? nx : nx - 1); ++i) {
                const auto at = [&](const WindPlane& p, int32_t dx, int32_t dy) {
                    return static_cast<double>(p.row(j + dy)[i + dx]);
                };
                const double out = at(x, 1, 0) + at(x, 1, 1) - at(x, 0, 0) - at(x, 0, 1) + at(y, 0, 1) + at(y, 1, 1) -
                                   at(y, 0, 0) - at(y, 1, 0);
                most = std::max(most, std::abs(0.5 * out));
            }
        return most;
    }
};

// Waves down to `shortest` cells around a mean wind of (4, 2).
VectorPlane waves(int32_t nx, int32_t ny, int shortest) {
    VectorPlane w{Plane(static_cast<size_t>(nx * ny), 4.0), Plane(static_cast<size_t>(nx * ny), 2.0)};
    const RandomStream random(7, 0, Purpose::test);
    for (int32_t c = -ny / shortest; c <= ny / shortest; ++c)
        for (int32_t a = 0; a <= nx / shortest; ++a) {
            if (a == 0 && c == 0) continue;
            const auto r = random.at(a, c);
            const double size = 0.5 / std::sqrt(static_cast<double>(a * a + c * c));
            const double p = 2.0 * M_PI * uniform(r.v[0]);
            const double q = 2.0 * M_PI * uniform(r.v[1]);
            for (int32_t y = 0; y < ny; ++y)
                for (int32_t x = 0; x < nx; ++x) {
                    const double phase =
                        2.0 * M_PI * (static_cast<double>(a * x) / nx + static_cast<double>(c * y) / ny);
                    w.x[static_cast<size_t>(y * nx + x)] += size * std::cos(phase + p);
                    w.y[static_cast<size_t>(y * nx + x)] += size * std::cos(phase + q);
                }
        }
    return w;
}

double mean(const Plane& p) {
    double sum = 0.0;
    for (const double v : p) sum += v;
    return sum / static_cast<double>(p.size());
}

VectorPlane difference(const VectorPlane& a, const VectorPlane& b) {
    VectorPlane d = a;
    for (size_t i = 0; i < d.x.size(); ++i) {
        d.x[i] -= b.x[i];
        d.y[i] -= b.y[i];
    }
    return d;
}

double size_of(const VectorPlane& v) {
    return std::hypot(rms(v.x), rms(v.y));
}

TEST(WindProject, TakesTheDivergenceOutAndKeepsTheMeanWind) {
    for (const auto& [nx, ny] : {std::pair{128, 128}, {48, 80}, {256, 16}, {33, 20}, {112, 7}, {2, 64}})
        for (const auto& [px, py] : {std::pair{true, true}, {false, false}, {true, false}, {false, true}}) {
            const VectorPlane in = waves(nx, ny, 6);
            const Wind w(in, nx, ny, px, py);
            EXPECT_LT(w.most_divergence(), 1e-3 * static_cast<double>(w.outcome.before))
                << nx << " x " << ny << ' ' << px << py;
            EXPECT_LT(w.outcome.iterations, WindProjection::k_most_iterations) << nx << " x " << ny << ' ' << px << py;
            EXPECT_NEAR(mean(w.planes().x), mean(in.x), 1e-5);
            EXPECT_NEAR(mean(w.planes().y), mean(in.y), 1e-5);
        }
}

TEST(WindProject, AgreesWithTheSpectralProjection) {
    // Central differences see a wave of n cells turned by pi^2 / (3 n^2) at most. Second order: four times less for
    // waves twice as long.
    for (const auto& [nx, ny] : {std::pair{128, 128}, {96, 160}, {192, 64}})
        for (const int shortest : {8, 16, 32}) {
            const VectorPlane in = waves(nx, ny, shortest);
            const Wind w(in, nx, ny, true, true);
            const VectorPlane wanted = project_by_fft(in, nx, ny);
            const double taken = size_of(difference(in, wanted));
            const double error = size_of(difference(w.planes(), wanted)) / taken;
            const double left = rms(divergence_by_fft(w.planes(), nx, ny)) / rms(divergence_by_fft(in, nx, ny));
            const double bound = M_PI * M_PI / (3.0 * shortest * shortest);
            EXPECT_LT(error, bound) << nx << " x " << ny << ", waves from " << shortest << " cells";
            EXPECT_LT(left, bound) << nx << " x " << ny << ", waves from " << shortest << " cells";
            std::printf("%d x %d, waves from %d cells: field %.1e, spectral divergence left %.1e, %d iterations\n", nx,
                        ny, shortest, error, left, w.outcome.iterations);
        }
}

TEST(WindProject, ASecondProjectionChangesNothing) {
    const Wind once(waves(64, 96, 6), 64, 96, true, false);
    const Wind twice(once.planes(), 64, 96, true, false);
    EXPECT_LT(size_of(difference(twice.planes(), once.planes())), 1e-3);
}

TEST(WindProject, WindWithoutDivergenceStays) {
    // Shear, and a stream function.
    const int32_t n = 64;
    VectorPlane in;
    const auto psi = [&](double x, double y) {
        return 3.0 * std::sin(2.0 * M_PI * x / n) * std::sin(4.0 * M_PI * y / n);
    };
    for (int32_t y = 0; y < n; ++y)
        for (int32_t x = 0; x < n; ++x) {
            // Rotated central differences at corners: exactly free of divergence for the scheme.
            const auto p = [&](int32_t i, int32_t j) { return psi(i, j); };
            in.x.push_back(4.0 + 0.5 * (p(x, y) + p(x - 1, y) - p(x, y - 1) - p(x - 1, y - 1)));
            in.y.push_back(-0.5 * (p(x, y) + p(x, y - 1) - p(x - 1, y) - p(x - 1, y - 1)));
        }
    const Wind w(in, n, n, true, true);
    EXPECT_LT(largest(difference(w.planes(), in).x), 3e-6);
    EXPECT_LT(largest(difference(w.planes(), in).y), 3e-6);
}

TEST(WindProject, EvenRoughWindCloses) { // noise from cell to cell, which no solver of the wind is given
    VectorPlane in{Plane(128 * 128), Plane(128 * 128)};
    for (int32_t i = 0; i < 128 * 128; ++i) {
        const auto r = RandomStream(3, 0, Purpose::test).at(i, 0);
        in.x[static_cast<size_t>(i)] = uniform(r.v[0]);
        in.y[static_cast<size_t>(i)] = uniform(r.v[1]);
    }
    const Wind w(in, 128, 128, true, true);
    EXPECT_LT(w.most_divergence(), 1e-2 * static_cast<double>(w.outcome.before));
    std::printf("noise: %d iterations, divergence %.1e of before\n", w.outcome.iterations,
                w.most_divergence() / static_cast<double>(w.outcome.before));
}

TEST(WindProject, TurnsAndMirrorsWithItsInput) {
    const int32_t nx = 96;
    const int32_t ny = 64;
    const VectorPlane in = waves(nx, ny, 6);
    for (const bool periodic : {true, false}) {
        const VectorPlane a = Wind(in, nx, ny, periodic, periodic).planes();
        VectorPlane turned{Plane(in.x.size()), Plane(in.x.size())}; // by 90 degrees: (x, y) -> (ny - 1 - y, x)
        VectorPlane seen{Plane(in.x.size()), Plane(in.x.size())};   // in a mirror: (x, y) -> (nx - 1 - x, y)
        const auto from = [&](int32_t x, int32_t y) { return static_cast<size_t>(y * nx + x); };
        const auto to_turned = [&](int32_t x, int32_t y) { return static_cast<size_t>(x * ny + ny - 1 - y); };
        for (int32_t y = 0; y < ny; ++y)
            for (int32_t x = 0; x < nx; ++x) {
                turned.x[to_turned(x, y)] = -in.y[from(x, y)];
                turned.y[to_turned(x, y)] = in.x[from(x, y)];
                seen.x[from(nx - 1 - x, y)] = -in.x[from(x, y)];
                seen.y[from(nx - 1 - x, y)] = in.y[from(x, y)];
            }
        const VectorPlane b = Wind(turned, ny, nx, periodic, periodic).planes();
        const VectorPlane c = Wind(seen, nx, ny, periodic, periodic).planes();
        double most = 0.0;
        for (int32_t y = 0; y < ny; ++y)
            for (int32_t x = 0; x < nx; ++x) {
                most = std::max(most, std::abs(b.x[to_turned(x, y)] + a.y[from(x, y)]));
                most = std::max(most, std::abs(b.y[to_turned(x, y)] - a.x[from(x, y)]));
                most = std::max(most, std::abs(c.x[from(nx - 1 - x, y)] + a.x[from(x, y)]));
                most = std::max(most, std::abs(c.y[from(nx - 1 - x, y)] - a.y[from(x, y)]));
            }
        EXPECT_LT(most, 4e-5) << periodic; // of winds of about 5 m/s: the order of sums
    }
}

TEST(WindProject, TheSameBitsOnAnyThreadsAndInstructionSet) {
    const RestoreMachine restore;
    const VectorPlane in = waves(192, 128, 16);
    VectorPlane first;
    for (const int threads : {1, 2, 5})
        for (const Isa wanted : {Isa::baseline, Isa::v3}) {
            if (set_isa(wanted) != wanted) continue;
            set_thread_count(threads);
            const VectorPlane p = Wind(in, 192, 128, true, false).planes();
            if (first.x.empty()) first = p;
            EXPECT_EQ(p.x, first.x) << threads << ' ' << name_of(wanted);
            EXPECT_EQ(p.y, first.y) << threads << ' ' << name_of(wanted);
        }
}

} // namespace
} // namespace sahel::test
