#include "sim/wind_plane.h"
#include "sim/wind_smooth.h"

namespace sahel::SAHEL_ISA_NAMESPACE {

namespace {

// A cell inside: periodic, or mirrored with the edge twice.
int32_t inside(int32_t i, int32_t n, bool periodic) {
    const int32_t period = periodic ? n : 2 * n;
    const int32_t m = (i % period + period) % period;
    return m < n ? m : 2 * n - 1 - m;
}

float halved(float a, float b, float c, float d) {
    return 0.125f * (a + d) + 0.375f * (b + c);
}

void halve_x(const float* in, float* out, int32_t nx, int32_t ny, bool periodic) {
    const int32_t half = nx / 2;
    for_each_row("sim/wind_smooth", nx, ny, [=](int32_t y) {
        const float* r = in + int64_t{y} * nx;
        float* o = out + int64_t{y} * half;
        const float before = r[inside(-1, nx, periodic)];
        const float after = r[inside(nx, nx, periodic)];
        o[0] = halved(before, r[0], r[1], half > 1 ? r[2] : after);
        SAHEL_VECTORIZE
        for (int32_t i = 1; i < half - 1; ++i) o[i] = halved(r[2 * i - 1], r[2 * i], r[2 * i + 1], r[2 * i + 2]);
        if (half > 1) o[half - 1] = halved(r[nx - 3], r[nx - 2], r[nx - 1], after);
    });
}

void halve_y(const float* in, float* out, int32_t nx, int32_t ny, bool periodic) {
    for_each_row("sim/wind_smooth", 2 * nx, ny / 2, [=](int32_t y) {
        const float* a = in + int64_t{inside(2 * y - 1, ny, periodic)} * nx;
        const float* b = in + int64_t{2 * y} * nx;
        const float* c = in + int64_t{2 * y + 1} * nx;
        const float* d = in + int64_t{inside(2 * y + 2, ny, periodic)} * nx;
        float* o = out + int64_t{y} * nx;
        SAHEL_VECTORIZE
        for (int32_t i = 0; i < nx; ++i) o[i] = halved(a[i], b[i], c[i], d[i]);
    });
}

void double_x(const float* in, float* out, int32_t nx, int32_t ny, bool periodic) { // nx: of `in`
    for_each_row("sim/wind_smooth", 2 * nx, ny, [=](int32_t y) {
        const float* r = in + int64_t{y} * nx;
        float* o = out + int64_t{y} * 2 * nx;
        const float before = r[inside(-1, nx, periodic)];
        const float after = r[inside(nx, nx, periodic)];
        for (int32_t i = 0; i < nx; ++i) {
            const float left = i > 0 ? r[i - 1] : before;
            const float right = i + 1 < nx ? r[i + 1] : after;
            o[2 * i] = 0.75f * r[i] + 0.25f * left;
            o[2 * i + 1] = 0.75f * r[i] + 0.25f * right;
        }
    });
}

void double_y(const float* in, float* out, int32_t nx, int32_t ny, bool periodic) { // ny: of `in`
    for_each_row("sim/wind_smooth", nx, 2 * ny, [=](int32_t y) {
        const float* near = in + int64_t{y / 2} * nx;
        const float* far = in + int64_t{inside(y / 2 + (y % 2 == 0 ? -1 : 1), ny, periodic)} * nx;
        float* o = out + int64_t{y} * nx;
        SAHEL_VECTORIZE
        for (int32_t i = 0; i < nx; ++i) o[i] = 0.75f * near[i] + 0.25f * far[i];
    });
}

// Pairs at the same distance are added first: a mirrored plane gives the mirrored result, bit by bit.
void convolve_x(const SmoothAxis& axis, const float* in, float* out, float* rows, int32_t nx, int32_t ny) {
    const int32_t radius = axis.radius;
    const float* w = axis.weights;
    for_each_row("sim/wind_smooth", nx * (1 + radius / 8), ny, [=](int32_t y) {
        const float* r = in + int64_t{y} * nx;
        float* wide = rows + int64_t{y} * (nx + 2 * radius) + radius;
        for (int32_t i = -radius; i < 0; ++i) wide[i] = r[inside(i, nx, axis.periodic)];
        for (int32_t i = 0; i < nx; ++i) wide[i] = r[i];
        for (int32_t i = nx; i < nx + radius; ++i) wide[i] = r[inside(i, nx, axis.periodic)];
        float* o = out + int64_t{y} * nx;
        for (int32_t i = 0; i < nx; ++i) o[i] = w[0] * wide[i];
        for (int32_t k = 1; k <= radius; ++k) {
            const float* left = wide - k;
            const float* right = wide + k;
            const float weight = w[k];
            SAHEL_VECTORIZE
            for (int32_t i = 0; i < nx; ++i) o[i] += weight * (left[i] + right[i]);
        }
    });
}

void convolve_y(const SmoothAxis& axis, const float* in, float* out, int32_t nx, int32_t ny) {
    const int32_t radius = axis.radius;
    const float* w = axis.weights;
    for_each_row("sim/wind_smooth", nx * (1 + radius / 8), ny, [=](int32_t y) {
        const float* here = in + int64_t{y} * nx;
        float* o = out + int64_t{y} * nx;
        for (int32_t i = 0; i < nx; ++i) o[i] = w[0] * here[i];
        for (int32_t k = 1; k <= radius; ++k) {
            const float* above = in + int64_t{inside(y - k, ny, axis.periodic)} * nx;
            const float* below = in + int64_t{inside(y + k, ny, axis.periodic)} * nx;
            const float weight = w[k];
            SAHEL_VECTORIZE
            for (int32_t i = 0; i < nx; ++i) o[i] += weight * (above[i] + below[i]);
        }
    });
}

} // namespace

void run_smooth_wind(const SmoothWork& work) {
    const float* from = work.in;
    float* to = work.a;
    const auto turn = [&] {
        from = to;
        to = to == work.a ? work.b : work.a;
    };
    int32_t nx = work.x.cells;
    int32_t ny = work.y.cells;
    for (int32_t l = 0; l < work.x.levels; ++l, nx /= 2, turn()) halve_x(from, to, nx, ny, work.x.periodic);
    for (int32_t l = 0; l < work.y.levels; ++l, ny /= 2, turn()) halve_y(from, to, nx, ny, work.y.periodic);
    convolve_x(work.x, from, to, work.rows, nx, ny);
    turn();
    if (work.x.levels == 0 && work.y.levels == 0) return convolve_y(work.y, from, work.out, nx, ny);
    convolve_y(work.y, from, to, nx, ny);
    turn();
    for (int32_t l = work.y.levels; l > 0; --l, ny *= 2, turn())
        double_y(from, l == 1 && work.x.levels == 0 ? work.out : to, nx, ny, work.y.periodic);
    for (int32_t l = work.x.levels; l > 0; --l, nx *= 2, turn())
        double_x(from, l == 1 ? work.out : to, nx, ny, work.x.periodic);
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
