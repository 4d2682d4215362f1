#include "sim/row_launch.h"
#include "sim/sand_kernels.h"

namespace sahel::SAHEL_ISA_NAMESPACE {

namespace {

// A leg as a scatter in blocks of rows: a block takes what the rows within reach give, and adds to its own rows only.
// Blocks never meet, and integers may be added in any order: the bits are those of a gather.
//
//     source rows y0 - reach .. y1 + reach - 1   ->   destination rows y0 .. y1 - 1
//
// Of a source row the targets and shares are worked out first, for all cells alike; then runs of cells that go the same
// way (wind changes slowly) are added as contiguous pieces, two rows of the destination for each.
constexpr int32_t k_chunk = 512;

template <bool k_bilinear> struct HopRows {
    HopLegPass f;

    struct Row {
        alignas(64) int32_t x[k_chunk]; // target, from the own cell
        alignas(64) int32_t y[k_chunk];
        alignas(64) int32_t share[4][k_chunk + 16];
    };

    // Shares of cells [x, x + w) of row y; false where none has anything to give.
    inline __attribute__((always_inline)) bool fill(Row& row, int32_t s, int32_t x, int32_t y, int32_t w) const {
        const HopLegPass p = f;
        const int32_t* from = p.from.row(s, y) + x;
        const float* wind_x = p.wind_x.row(s, y) + x;
        const float* wind_y = p.wind_y.row(s, y) + x;
        int32_t something = 0;
        for (int32_t j = 0; j < w; ++j) something |= from[j];
        if (something == 0) return false;
        SAHEL_VECTORIZE
        for (int32_t j = 0; j < w; ++j) {
            const HopLegPass::Target g = p.template target<k_bilinear>(wind_x[j], wind_y[j]);
            const HopLegPass::Shares shares = HopLegPass::shares(from[j], g.u, g.v);
            row.x[j] = g.x;
            row.y[j] = g.y;
            row.share[0][j] = shares.t[0];
            row.share[1][j] = shares.t[1];
            row.share[2][j] = shares.t[2];
            row.share[3][j] = shares.t[3];
        }
        return true;
    }

    // left[i] to cell tx + i, right[i] to the next one; n of each, the row clipped to [x0, x1).
    static inline __attribute__((always_inline)) void add(int32_t* to, const int32_t* left, const int32_t* right,
                                                          int32_t tx, int32_t n, int32_t x0, int32_t x1) {
        if (tx >= x0 && tx + n + 1 <= x1) {
            to += tx;
            to[0] += left[0];
            SAHEL_VECTORIZE
            for (int32_t i = 1; i < n; ++i) to[i] += left[i] + right[i - 1];
            to[n] += right[n - 1];
            return;
        }
        for (int32_t i = 0; i < n; ++i) {
            if (tx + i >= x0 && tx + i < x1) to[tx + i] += left[i];
            if (tx + i + 1 >= x0 && tx + i + 1 < x1) to[tx + i + 1] += right[i];
        }
    }

    void operator()(int32_t s, const LocalRect& r) const {
        Row row;
        const int32_t reach = f.radius();
        int32_t cleared = r.y0;
        for (int32_t y = r.y0 - reach; y < r.y1 + reach; ++y) {
            for (; cleared < r.y1 && cleared <= y + reach; ++cleared) { // just before rows are needed: still in cache
                int32_t* to = f.to.row(s, cleared);
                for (int32_t x = r.x0; x < r.x1; ++x) to[x] = 0;
            }
            for (int32_t x = r.x0 - reach; x < r.x1 + reach; x += k_chunk) {
                const int32_t w = x + k_chunk < r.x1 + reach ? k_chunk : r.x1 + reach - x;
                if (!fill(row, s, x, y, w)) continue;
                for (int32_t j = 0; j < w;) {
                    const int32_t gx = row.x[j];
                    const int32_t gy = row.y[j];
                    int32_t end = j + 1;
                    while (end < w && ((row.x[end] ^ gx) | (row.y[end] ^ gy)) == 0) ++end;
                    for (int32_t k = 0; k < 2; ++k) {
                        const int32_t ty = y + gy + k;
                        if (ty < r.y0 || ty >= r.y1) continue;
                        add(f.to.row(s, ty), row.share[2 * k] + j, row.share[2 * k + 1] + j, x + j + gx, end - j, r.x0,
                            r.x1);
                    }
                    j = end;
                }
            }
        }
    }
};

} // namespace

void run_hop_leg(const Launch& l, const HopLegPass& f) {
    // Rows at a block's ends are worked out by two blocks: the more rows, the less of that, as long as all threads
    // have something to do.
    const int64_t rows = static_cast<int64_t>(l.count) * (l.bounds.y1 - l.bounds.y0);
    const int64_t share = rows / (4 * static_cast<int64_t>(thread_count()));
    const auto per_block = static_cast<int32_t>(share < 32 ? 32 : (share > 256 ? 256 : share));
    if (f.bilinear_targets)
        launch_rows(l, per_block, HopRows<true>{f});
    else
        launch_rows(l, per_block, HopRows<false>{f});
}

} // namespace sahel::SAHEL_ISA_NAMESPACE
