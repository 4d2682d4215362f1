#pragma once

#include "sim/pass.h"
#include "sim/slab_view.h"
#include "world/cpu_features.h"
#include "world/macros.h"

#include <cstdint>

/// The coarse wind, read by cells: bilinear between the centres of coarse cells.
///
///     coarse cell  |      i = 0      |      i = 1      |         spacing s = 4 cells
///     cells        |  0   1   2   3  |  4   5   6   7  |
///     part                    1/8 3/8  5/8 7/8                   of the way from centre 0 to centre 1: exact in float
///
/// Positions are whole half cells from the region's corner, so that a cell has the same bits wherever it is computed.
/// Beyond the region the wind goes on periodically, or as at the edge; beyond a wall it is the mirror image of the
/// wind inside, with the component across the wall turned round.
namespace sahel {

/// One axis of the region.
struct WindAxis {
    int64_t first = 0; ///< world cell
    int32_t cells = 0;
    int32_t coarse = 0; ///< cells / spacing
    bool periodic = false;
    bool wall_low = false, wall_high = false;

    /// A coarse cell inside, for any index.
    SAHEL_HD int32_t inside(int32_t i) const {
        if (periodic) return (i % coarse + coarse) % coarse;
        return i < 0 ? 0 : (i < coarse ? i : coarse - 1);
    }
};

struct WindField {
    const float* wind_x = nullptr; ///< [row][column] of coarse cells, m/s
    const float* wind_y = nullptr;
    WindAxis x, y;
    int32_t shift = 0; ///< spacing = 2^shift cells
};

struct WindPass {
    static constexpr PassDecl k_decl{"sim/wind", {}, {SimLayer::wind_x, SimLayer::wind_y}, 8};
    WindField field;
    const int64_t* origin = nullptr; ///< world x, y of the first owned cell, two for each slot
    SlabView<float> wind_x;
    SlabView<float> wind_y;

    struct Place {
        int32_t low; ///< coarse cell whose centre lies at or before; may be outside
        float part;  ///< of the way to the next centre
        bool flip;   ///< seen in a wall
    };
    [[nodiscard]] SAHEL_HD Place place(const WindAxis& axis, int64_t world) const {
        auto c = static_cast<int32_t>(world - axis.first);
        const bool low_side = axis.wall_low && c < 0;
        const bool high_side = axis.wall_high && c >= axis.cells;
        if (low_side) c = -1 - c;
        if (high_side) c = 2 * axis.cells - 1 - c;
        const int32_t halves = 2 * c + 1 - (1 << field.shift); // half cells from the centre of coarse cell 0
        const int32_t low = halves >> (field.shift + 1);
        return {low, static_cast<float>(halves - (low << (field.shift + 1))) * unit(), low_side || high_side};
    }
    /// Half a cell, as a share of the spacing.
    [[nodiscard]] SAHEL_HD float unit() const { return 0.5f / static_cast<float>(1 << field.shift); }

    SAHEL_HD static float between(float a, float b, float part) { return a + part * (b - a); }

    SAHEL_HD void operator()(int32_t slot, int32_t x, int32_t y) const {
        const Place px = place(field.x, origin[2 * slot] + x);
        const Place py = place(field.y, origin[2 * slot + 1] + y);
        const int64_t columns = field.x.coarse;
        const int64_t top = field.y.inside(py.low) * columns;
        const int64_t bottom = field.y.inside(py.low + 1) * columns;
        const int32_t left = field.x.inside(px.low);
        const int32_t right = field.x.inside(px.low + 1);
        const float wx = between(between(field.wind_x[top + left], field.wind_x[bottom + left], py.part),
                                 between(field.wind_x[top + right], field.wind_x[bottom + right], py.part), px.part);
        const float wy = between(between(field.wind_y[top + left], field.wind_y[bottom + left], py.part),
                                 between(field.wind_y[top + right], field.wind_y[bottom + right], py.part), px.part);
        wind_x(slot, x, y) = px.flip ? -wx : wx;
        wind_y(slot, x, y) = py.flip ? -wy : wy;
    }
};

/// On the host whole rows at once: of each row of cells the coarse columns are mixed first.
SAHEL_ISA_DECLARE(void run_wind_pass(const Launch& l, const WindPass& f))
Status run_wind_pass_cuda(const Launch& l, const WindPass& f);

} // namespace sahel
