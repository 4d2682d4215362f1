#pragma once

#include "sim/directions.h"
#include "sim/pass.h"
#include "sim/slab_view.h"
#include "sim/wet_ground.h"
#include "world/det_math.h"
#include "world/layers.h"

#include <cstdint>

/// Reptation: grains that land push others on. Two forms, which may be combined: smoothing of the sand by flows between
/// neighbours (Desertscapes in CUDA, GRAPP 2024, equations 6 to 8), and a lower angle of repose where much sand moves
/// (the follow-up paper). With B = sand that bounces, m/s, a pair of cells exchanges in a step of dt
///
///     flow = 1/8 min(|slope| c, sand of the donor),     c = 1/2 (B_i + B_j) dt (k_r + k_S (|w_i| + |w_j|) / 2)
///
/// downhill. Both cells work it out from the same operands, so that it is one number of ticks. It is an explicit
/// diffusion: ripples from cell to cell change sign every step above Omega = c / l = 0.83 and grow above 1.66. The step
/// is therefore divided into parts for which the c of a flat bed stays below 0.8 l, and no pair may exceed that.
namespace sahel {

inline constexpr float k_most_smoothing = 0.8f; ///< Omega

struct SmoothPass {
    SlabView<const int32_t> bedrock, soil, sand;
    SlabView<const float> bounce, wind_x, wind_y;
    SlabView<int32_t> change;
    float strength;      ///< 1/2 k_r dt
    float wind_strength; ///< 1/4 k_S dt
    float most;          ///< of c, m
    float cell_m;
    bool by_wind;

    static PassDecl decl(bool by_wind) {
        PassDecl d{"sim/smooth",
                   {{SimLayer::bedrock, 1}, {SimLayer::soil, 1}, {SimLayer::sand, 1}, {SimLayer::bounce, 1}},
                   {SimLayer::surface},
                   20};
        if (by_wind) {
            d.reads.add({SimLayer::wind_x, 1});
            d.reads.add({SimLayer::wind_y, 1});
            d.least_bytes += 8;
        }
        return d;
    }

    SAHEL_HD float speed(int32_t s, int32_t x, int32_t y) const {
        const float wx = wind_x(s, x, y);
        const float wy = wind_y(s, x, y);
        return det::sqrt(wx * wx + wy * wy);
    }
    SAHEL_HD int32_t height(int32_t s, int32_t x, int32_t y) const {
        return (bedrock(s, x, y) + soil(s, x, y)) + sand(s, x, y);
    }
    /// Share of the slope's ticks that flow between two cells, for each tick they differ by. Beyond frozen and open
    /// borders `bounce` is sealed: no ground there gives or takes.
    SAHEL_HD float rate(float bounced, float speeds, float scale) const {
        const float c = bounced * strength + bounced * (wind_strength * speeds);
        return det::max(det::min(c, most), 0.0f) * scale; // below 0: sealed
    }
    /// 1/8 over the distance to a side or a corner.
    SAHEL_HD float scale(int k) const { return 0.125f / (cell_m * ((k & 1) != 0 ? k_sqrt2 : 1.0f)); }
    /// Ticks that a cell gains from one whose ground stands `rise` ticks higher; below 0: gives. A donor gives at most
    /// 1/8 of its sand to each neighbour, so that all can be served.
    SAHEL_HD static int32_t gain(int32_t rise, float rate, int32_t sand_here, int32_t sand_there) {
        const float wish = static_cast<float>(rise < 0 ? -rise : rise) * rate;
        const int32_t donor = (rise < 0 ? sand_here : sand_there) >> 3;
        const auto ticks = static_cast<int32_t>(det::min(wish, 0x1p30f) + 0.5f);
        const int32_t flow = ticks < donor ? ticks : donor;
        return rise < 0 ? -flow : flow;
    }
    /// From neighbour k; `speeds`: of both cells.
    SAHEL_HD int32_t gain_at(int32_t s, int32_t x, int32_t y, int k, float speeds) const {
        const int32_t nx = x + direction_x(k);
        const int32_t ny = y + direction_y(k);
        const float bounced = bounce(s, x, y) + bounce(s, nx, ny);
        return gain(height(s, nx, ny) - height(s, x, y), rate(bounced, speeds, scale(k)), sand(s, x, y),
                    sand(s, nx, ny));
    }
    template <bool k_by_wind> SAHEL_HD int32_t gain_from(int32_t s, int32_t x, int32_t y, int k) const {
        float speeds = 0.0f;
        if constexpr (k_by_wind) speeds = speed(s, x, y) + speed(s, x + direction_x(k), y + direction_y(k));
        return gain_at(s, x, y, k, speeds);
    }
    SAHEL_HD int32_t gain_from(int32_t s, int32_t x, int32_t y, int k) const {
        return by_wind ? gain_from<true>(s, x, y, k) : gain_from<false>(s, x, y, k);
    }
    template <bool k_by_wind> SAHEL_HD int32_t gains(int32_t s, int32_t x, int32_t y) const {
        return ((gain_from<k_by_wind>(s, x, y, 0) + gain_from<k_by_wind>(s, x, y, 1)) +
                (gain_from<k_by_wind>(s, x, y, 2) + gain_from<k_by_wind>(s, x, y, 3))) +
               ((gain_from<k_by_wind>(s, x, y, 4) + gain_from<k_by_wind>(s, x, y, 5)) +
                (gain_from<k_by_wind>(s, x, y, 6) + gain_from<k_by_wind>(s, x, y, 7)));
    }
    SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y) const {
        change(s, x, y) = by_wind ? gains<true>(s, x, y) : gains<false>(s, x, y);
    }
    /// The donor of border_flows.h.
    template <class Sink> SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y, Sink& sink) const {
        for (int k = 0; k < k_direction_count; ++k) {
            const int32_t given = -gain_from(s, x, y, k);
            if (given > 0) sink(x + direction_x(k), y + direction_y(k), given);
        }
    }
};

struct ApplySmoothPass {
    static constexpr PassDecl k_decl{
        "sim/apply_smooth", {{SimLayer::surface, 0}, {SimLayer::sand, 0}}, {SimLayer::sand}, 12};
    SlabView<const int32_t> change;
    SlabView<int32_t> sand;
    SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y) const { sand(s, x, y) += change(s, x, y); }
};

/// The angle of repose of sand for the avalanches that follow, as its tangent: steeper under plants and when damp,
/// flatter when soaked (Oasis A9) and where sand moves.
struct ReposePass {
    SlabView<const int32_t> soil, sand, moisture;
    SlabView<const float> vegetation, bounce, shadow, wind_x, wind_y;
    SlabView<float> repose;
    WetGround wet;
    float bare;     ///< tangent
    float planted;  ///< tangent
    float lowering; ///< s2/m2
    float calm;     ///< 1: shelter keeps sand steep
    bool lowers;

    static PassDecl decl(bool lowers) {
        PassDecl d{"sim/repose",
                   {{SimLayer::soil, 0}, {SimLayer::sand, 0}, {SimLayer::moisture, 0}, {SimLayer::vegetation, 0}},
                   {SimLayer::repose},
                   20};
        if (lowers) {
            for (const SimLayer l : {SimLayer::bounce, SimLayer::wind_shadow, SimLayer::wind_x, SimLayer::wind_y})
                d.reads.add({l, 0});
            d.least_bytes += 16;
        }
        return d;
    }
    SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y) const {
        if (lowers)
            cell<true>(s, x, y);
        else
            cell<false>(s, x, y);
    }
    template <bool k_lowers> SAHEL_HD void cell(int32_t s, int32_t x, int32_t y) const {
        float tangent = bare;
        if constexpr (k_lowers) {
            const float b = bounce(s, x, y);
            const float wx = wind_x(s, x, y);
            const float wy = wind_y(s, x, y);
            const float moved = b * (1.0f - calm * shadow(s, x, y)) * det::sqrt(wx * wx + wy * wy) * lowering;
            // Frozen cells have no shelter of their own: nothing bounces there.
            tangent = bare * det::exp(-det::pick(b > 0.0f, moved, 0.0f));
        }
        const float m = wet.relative(moisture(s, x, y), sand(s, x, y) + soil(s, x, y));
        const float v = plant_cover(vegetation(s, x, y));
        const float open = cohesion(m, 1.35f) * tangent;
        repose(s, x, y) = open + v * (cohesion(m, 1.25f) * planted - open);
    }
};

} // namespace sahel
