#include "spectral.h"

#include <fftw3.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>

namespace sahel::test {

namespace {

using Spectrum = std::vector<std::complex<double>>; // ny rows of nx / 2 + 1

Spectrum forward(Plane in, int32_t nx, int32_t ny) {
    Spectrum out(static_cast<size_t>(nx / 2 + 1) * static_cast<size_t>(ny));
    fftw_plan plan =
        fftw_plan_dft_r2c_2d(ny, nx, in.data(), reinterpret_cast<fftw_complex*>(out.data()), FFTW_ESTIMATE);
    fftw_execute(plan);
    fftw_destroy_plan(plan);
    return out;
}

Plane backward(Spectrum in, int32_t nx, int32_t ny) {
    Plane out(static_cast<size_t>(nx) * static_cast<size_t>(ny));
    fftw_plan plan =
        fftw_plan_dft_c2r_2d(ny, nx, reinterpret_cast<fftw_complex*>(in.data()), out.data(), FFTW_ESTIMATE);
    fftw_execute(plan);
    fftw_destroy_plan(plan);
    for (double& v : out) v /= static_cast<double>(out.size());
    return out;
}

// f(index, kx, ky) in radians for each cell.
template <class F> void for_each_wave(int32_t nx, int32_t ny, F&& f) {
    const int32_t w = nx / 2 + 1;
    for (int32_t c = 0; c < ny; ++c)
        for (int32_t a = 0; a < w; ++a)
            f(static_cast<size_t>(c) * static_cast<size_t>(w) + static_cast<size_t>(a), 2.0 * M_PI * a / nx,
              2.0 * M_PI * (c > ny / 2 ? c - ny : c) / ny);
}

} // namespace

Plane gaussian_by_fft(const Plane& in, int32_t nx, int32_t ny, double sigma_cells) {
    const auto along = [&](int32_t i, int32_t n) {
        double sum = 0.0;
        const int32_t images = 1 + static_cast<int32_t>(8.0 * sigma_cells / n);
        for (int32_t m = -images; m <= images; ++m) sum += std::exp(-0.5 * std::pow((i + m * n) / sigma_cells, 2));
        return sum;
    };
    Plane kernel;
    double sum = 0.0;
    for (int32_t y = 0; y < ny; ++y)
        for (int32_t x = 0; x < nx; ++x) {
            kernel.push_back(along(x, nx) * along(y, ny));
            sum += kernel.back();
        }
    for (double& k : kernel) k /= sum;
    Spectrum a = forward(in, nx, ny);
    const Spectrum b = forward(kernel, nx, ny);
    for (size_t i = 0; i < a.size(); ++i) a[i] *= b[i];
    return backward(a, nx, ny);
}

VectorPlane project_by_fft(const VectorPlane& in, int32_t nx, int32_t ny) {
    Spectrum x = forward(in.x, nx, ny);
    Spectrum y = forward(in.y, nx, ny);
    for_each_wave(nx, ny, [&](size_t i, double kx, double ky) {
        const double k2 = kx * kx + ky * ky;
        if (k2 == 0.0) return;
        const std::complex<double> along = (kx * x[i] + ky * y[i]) / k2;
        x[i] -= kx * along;
        y[i] -= ky * along;
    });
    return {backward(x, nx, ny), backward(y, nx, ny)};
}

Plane divergence_by_fft(const VectorPlane& in, int32_t nx, int32_t ny) {
    Spectrum x = forward(in.x, nx, ny);
    const Spectrum y = forward(in.y, nx, ny);
    for_each_wave(nx, ny, [&](size_t i, double kx, double ky) {
        x[i] = std::complex<double>(0.0, 1.0) * (kx * x[i] + ky * y[i]);
    });
    return backward(x, nx, ny);
}

double rms(const Plane& p) {
    double sum = 0.0;
    for (const double v : p) sum += v * v;
    return std::sqrt(sum / static_cast<double>(p.size()));
}

double largest(const Plane& p) {
    double most = 0.0;
    for (const double v : p) most = std::max(most, std::abs(v));
    return most;
}

double range(const Plane& p) {
    const auto [low, high] = std::minmax_element(p.begin(), p.end());
    return *high - *low;
}

} // namespace sahel::test
