#include "sim/wind_warp.h"

namespace sahel::SAHEL_ISA_NAMESPACE {

namespace {

// Adds one scale's deflection of the wind (vx, vy) to (ux, uy), along a row.
void add_scale(const WarpKernel& f, const WarpScale& scale, int32_t y, const float* vx, const float* vy, float* ux,
               float* uy) {
    const float* up = scale.height.row(y - 1);
    const float* here = scale.height.row(y);
    const float* down = scale.height.row(y + 1);
    const float c = f.slope_factor;
    const float a = scale.weight;
    const float k = scale.strength_m_per_s;
    const int32_t nx = f.out_x.nx;
    SAHEL_VECTORIZE
    for (int32_t x = 0; x < nx; ++x) {
        const float gx = c * (here[x + 1] - here[x - 1]);
        const float gy = c * (down[x] - up[x]);
        const float slope = det::sqrt(gx * gx + gy * gy);
        const float alpha = det::min(slope, 1.0f);
        const float size = slope * det::sqrt(vx[x] * vx[x] + vy[x] * vy[x]);
        const float along = vy[x] * gx - vx[x] * gy;
        const float cosine = det::pick(size > 0.0f, along / size, 0.0f);
        const float s = WarpKernel::smooth_sign(cosine);
        const float pull = s * k;
        const float loss = det::abs(s);
        ux[x] += a * (alpha * (-(pull * gy) - loss * vx[x]));
        uy[x] += a * (alpha * (pull * gx - loss * vy[x]));
    }
}

} // namespace

void run_warp_wind(const WarpKernel& kernel) {
    constexpr int32_t k_chunk = 256;
    const int32_t nx = kernel.out_x.nx;
    for_each_row("sim/wind_warp", nx * (1 + 4 * kernel.scales), kernel.out_x.ny, [&](int32_t y) {
        const WarpKernel f = kernel;
        float vx[k_chunk];
        float vy[k_chunk];
        for (int32_t x0 = 0; x0 < nx; x0 += k_chunk) {
            const int32_t n = nx - x0 < k_chunk ? nx - x0 : k_chunk;
            const float* up = f.height.row(y - 1) + x0;
            const float* here = f.height.row(y) + x0;
            const float* down = f.height.row(y + 1) + x0;
            const float* mean = f.absolute ? here : f.mean.row(y) + x0;
            float* ux = f.out_x.row(y) + x0;
            float* uy = f.out_y.row(y) + x0;
            SAHEL_VECTORIZE
            for (int32_t x = 0; x < n; ++x) {
                const float factor = f.factor(WarpKernel::mixed(up, here, down, x), mean[x]);
                vx[x] = ux[x] = factor * f.wind_x;
                vy[x] = uy[x] = factor * f.wind_y;
            }
            if (f.scales == 0) continue;
            WarpKernel part = f; // the same kernel on these columns
            part.out_x.nx = n;
            for (int i = 0; i < f.scales; ++i) {
                WarpScale scale = f.scale[i];
                scale.height.origin += x0;
                add_scale(part, scale, y, vx, vy, ux, uy);
            }
            SAHEL_VECTORIZE
            for (int32_t x = 0; x < n; ++x) { // the speed is restored
                const float speed = det::sqrt(vx[x] * vx[x] + vy[x] * vy[x]);
                const float length = det::sqrt(ux[x] * ux[x] + uy[x] * uy[x]);
                const bool turned = length > 0.0f;
                const float ratio = speed / length;
                ux[x] = det::pick(turned, ratio * ux[x], vx[x]);
                uy[x] = det::pick(turned, ratio * uy[x], vy[x]);
            }
        }
    });
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
