#include "sim/lanes.h"
#include "sim/row_launch.h"
#include "sim/sand_kernels.h"

namespace sahel::SAHEL_ISA_NAMESPACE {

namespace {

// Cells of a row that walk upwind together. Wind changes slowly from cell to cell, so that most often all of them look
// at the same offset: then the four corners of the samples are four contiguous pieces of memory.
constexpr int32_t k_wide = lanes::k_count;

// How high the ground rises around: per strip of columns, over a block's rows and all within reach of them. It bounds
// the slope of samples that were not taken yet.
struct Strips {
    static constexpr int32_t k_most = 256;
    int32_t first = 0; // column of strip 0
    int32_t wide = 0;
    int32_t highest[k_most];

    inline __attribute__((always_inline)) void measure(const SlabView<const int32_t>& surface, int32_t s,
                                                       const LocalRect& r, int32_t reach) {
        first = r.x0 - reach;
        const int32_t columns = r.x1 + reach - first;
        wide = (columns + k_most - 1) / k_most;
        wide = wide < 16 ? 16 : wide;
        for (int32_t i = 0; i * wide < columns; ++i) {
            const int32_t x1 = (i + 1) * wide < columns ? (i + 1) * wide : columns;
            int32_t most = INT32_MIN;
            lanes::Ints lane = lanes::Ints{} + most;
            int32_t x = i * wide;
            for (; x + lanes::k_count <= x1; x += lanes::k_count)
                for (int32_t y = r.y0 - reach; y < r.y1 + reach; ++y)
                    lane = lanes::max(lane, lanes::load(surface.row(s, y) + first + x));
            for (; x < x1; ++x)
                for (int32_t y = r.y0 - reach; y < r.y1 + reach; ++y) {
                    const int32_t h = surface(s, first + x, y);
                    most = h > most ? h : most;
                }
            for (int32_t k = 0; k < lanes::k_count; ++k) most = lane[k] > most ? lane[k] : most;
            highest[i] = most;
        }
    }
    inline __attribute__((always_inline)) int32_t above(int32_t x0, int32_t x1) const {
        int32_t most = INT32_MIN;
        for (int32_t i = (x0 - first) / wide; i <= (x1 - 1 - first) / wide; ++i)
            most = highest[i] > most ? highest[i] : most;
        return most;
    }
};

struct ShadowRows {
    static constexpr int32_t k_table = 128;
    static constexpr int32_t k_chunk = 256;
    WindShadowPass f;
    float per_tick[k_table + 1]; // a division each

    explicit ShadowRows(const WindShadowPass& pass) : f(pass) {
        for (int32_t k = 1; k <= k_table; ++k) per_tick[k] = f.per_tick(k);
    }

    // How far the ground around may rise above a piece's lowest cell, in ticks; a little more than exact, so that no
    // rounding makes a difference to what is left out.
    inline __attribute__((always_inline)) float top(const Strips& strips, const int32_t* surface, int32_t x) const {
        const int32_t reach = WindShadowPass::radius(f.samples);
        int32_t lowest = surface[0];
        for (int32_t j = 0; j < k_wide; ++j) lowest = surface[j] < lowest ? surface[j] : lowest;
        return 1.001f * static_cast<float>(int64_t{strips.above(x - reach, x + k_wide + reach)} - lowest);
    }

    // One piece; (along_x, along_y): the direction of its wind.
    inline __attribute__((always_inline)) void piece(const Strips& strips, int32_t s, int32_t x, int32_t y,
                                                     const float* along_x, const float* along_y) const {
        const int32_t* surface = f.surface.row(s, y) + x;
        const int64_t stride = f.surface.stride;
        const lanes::Reals dx = lanes::load(along_x);
        const lanes::Reals dy = lanes::load(along_y);
        const lanes::Ints here = lanes::load(surface);
        lanes::Reals px{};
        lanes::Reals py{};
        lanes::Reals steepest = lanes::Reals{} + f.least; // less is no shelter
        const float most = top(strips, surface, x);
        const float full = f.least + 1.001f * f.range;
        for (int32_t k = 1; k <= f.samples; ++k) {
            // From here on no sample is steeper than this. Where all lanes are there already, or in full shelter, the
            // rest of the way changes nothing.
            const float slope = per_tick[k];
            if (!lanes::any(steepest < lanes::Reals{} + det::min(most * slope, full))) break;
            px -= dx;
            py -= dy;
            const lanes::Ints ox = lanes::floor(px);
            const lanes::Ints oy = lanes::floor(py);
            const lanes::Reals u = px - lanes::to_real(ox);
            const lanes::Reals v = py - lanes::to_real(oy);
            lanes::Reals rise{};
            if (lanes::uniform(ox, oy)) {
                const int32_t* upper = surface + oy[0] * stride + ox[0];
                const int32_t* lower = upper + stride;
                const lanes::Reals a = lanes::to_real(lanes::load(upper) - here);
                const lanes::Reals b = lanes::to_real(lanes::load(upper + 1) - here);
                const lanes::Reals c = lanes::to_real(lanes::load(lower) - here);
                const lanes::Reals d = lanes::to_real(lanes::load(lower + 1) - here);
                const lanes::Reals ab = a + u * (b - a); // mix_bilinear
                const lanes::Reals cd = c + u * (d - c);
                rise = ab + v * (cd - ab);
            } else {
                for (int32_t j = 0; j < k_wide; ++j)
                    rise[j] = rise_ticks(surface + j + oy[j] * stride + ox[j], stride, here[j], u[j], v[j]);
            }
            steepest = lanes::max(rise * slope, steepest);
        }
        lanes::store(f.shadow.row(s, y) + x, lanes::clamp((steepest - f.least) / f.range, 0.0f, 1.0f));
    }

    void operator()(int32_t s, const LocalRect& r) const {
        Strips strips;
        strips.measure(f.surface, s, r, WindShadowPass::radius(f.samples));
        alignas(64) float along_x[k_chunk];
        alignas(64) float along_y[k_chunk];
        for (int32_t y = r.y0; y < r.y1; ++y)
            for (int32_t x0 = r.x0; x0 < r.x1; x0 += k_chunk) {
                const int32_t w = x0 + k_chunk < r.x1 ? k_chunk : r.x1 - x0;
                const float* wind_x = f.wind_x.row(s, y) + x0;
                const float* wind_y = f.wind_y.row(s, y) + x0;
                SAHEL_VECTORIZE
                for (int32_t j = 0; j < w; ++j) {
                    const WindDirection d = WindDirection::of(wind_x[j], wind_y[j]);
                    along_x[j] = d.x;
                    along_y[j] = d.y;
                }
                int32_t j = 0;
                for (; j + k_wide <= w; j += k_wide) piece(strips, s, x0 + j, y, along_x + j, along_y + j);
                for (; j < w; ++j) f(s, x0 + j, y);
            }
    }
};

// Most ground has no cliff within reach: it is passed over in pieces.
struct EchoRows {
    static constexpr int32_t k_piece = 64;
    static constexpr int32_t k_most = 256;
    EchoPass f;

    void operator()(int32_t s, const LocalRect& r) const {
        const int32_t reach = EchoPass::radius(f.steps);
        const int32_t first = r.x0 - reach;
        const int32_t columns = r.x1 + reach - first;
        int32_t wide = (columns + k_most - 1) / k_most;
        wide = wide < k_piece ? k_piece : wide;
        uint32_t cliffs[k_most]; // of strips: bits of any height in it
        for (int32_t i = 0; i * wide < columns; ++i) {
            const int32_t x1 = (i + 1) * wide < columns ? (i + 1) * wide : columns;
            uint32_t bits = 0;
            for (int32_t y = r.y0 - reach; y < r.y1 + reach; ++y) {
                const float* row = f.cliff.row(s, y) + first;
                for (int32_t x = i * wide; x < x1; ++x) bits |= det::bits_of(row[x]);
            }
            cliffs[i] = bits;
        }
        for (int32_t x0 = r.x0; x0 < r.x1; x0 += k_piece) {
            const int32_t x1 = x0 + k_piece < r.x1 ? x0 + k_piece : r.x1;
            uint32_t bits = 0;
            for (int32_t i = (x0 - reach - first) / wide; i <= (x1 - 1 + reach - first) / wide; ++i) bits |= cliffs[i];
            for (int32_t y = r.y0; y < r.y1; ++y)
                for (int32_t x = x0; x < x1; ++x) {
                    if (bits == 0)
                        f.echo(s, x, y) = 0.0f;
                    else
                        f(s, x, y);
                }
        }
    }
};

} // namespace

void run_wind_shadow(const Launch& l, const WindShadowPass& f) {
    if (f.curved || !f.bilinear_samples || f.samples > ShadowRows::k_table)
        launch(l, f);
    else
        launch_rows(l, 32, ShadowRows(f));
}

void run_echo(const Launch& l, const EchoPass& f) {
    launch_rows(l, 64, EchoRows{f});
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
