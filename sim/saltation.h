#pragma once

#include "sim/pass.h"
#include "sim/slab_view.h"
#include "sim/wet_ground.h"
#include "sim/wind_shadow.h"
#include "world/det_math.h"
#include "world/layers.h"
#include "world/random.h"

#include <cstdint>

/// Saltation: sand is lifted, carried by the wind, and settles or bounces on (Desertscapes in CUDA, GRAPP 2024, Section
/// 4.4; Oasis A5 to A7). In ticks: every transfer is rounded once.
///
///     sand --lift--> airborne --share--> hopping ==legs==> hopping --P--> sand
///                       ^  \__ the rest waits                 |
///                       +------------- 1 - P: bounced --------+
///
/// The published rule moves everything that is in the air once in a step, whatever the step's length. Here it is a
/// process in time: a grain hops once in `hop_s` seconds, and then as far as the wind goes in that time. Of a step dt
/// the share dt / hop_s of the airborne sand hops, and lift is a rate. With dt = hop_s = 1 s this is the published rule
/// exactly. Over flat open sand the air then holds rate hop_s / P before the hop, and the flux rate hop_s |w| / P does
/// not depend on dt.
///
/// The way of a hop is cut into equal legs of at most 7 cells, each along the wind where it begins.
namespace sahel {

inline constexpr int32_t k_longest_leg = 7;
inline constexpr int32_t k_leg_radius = 8; ///< the cells around the target too

/// Amounts below this are rounded at random, up or down, so that nothing is too slow to happen; above it the nearest
/// tick is off by less than 1 / 500, this way or that, and no random number need be drawn.
inline constexpr float k_plain_ticks = 256.0f;

SAHEL_HD int32_t rounded_ticks(float ticks, uint32_t bits) { // ticks >= 0; no branch
    const auto whole = static_cast<int32_t>(ticks);
    const float part = ticks - static_cast<float>(whole);
    const auto threshold = static_cast<int32_t>(part * 0x1p31f); // as stochastic_round does
    const bool drawn = static_cast<int32_t>(bits >> 1) < threshold;
    const bool plain = ticks >= k_plain_ticks;
    return whole + static_cast<int32_t>((plain & (part >= 0.5f)) | (!plain & drawn));
}

struct LiftPass {
    SlabView<const int32_t> soil, water, moisture;
    SlabView<const float> shadow, vegetation, echo;
    SlabView<int32_t> sand, airborne, hopping;
    CellPlaces places;
    RandomStream random;
    WetGround wet;
    float lift_ticks;    ///< of open ground in this step
    float erosion_ticks; ///< ticks of 1 m/s
    float share;         ///< dt / hop_s, at most 1
    bool echoes;

    static PassDecl decl(bool echoes) {
        PassDecl d{"sim/lift",
                   {{SimLayer::soil, 0},
                    {SimLayer::water, 0},
                    {SimLayer::moisture, 0},
                    {SimLayer::wind_shadow, 0},
                    {SimLayer::vegetation, 0},
                    {SimLayer::sand, 0},
                    {SimLayer::airborne_sand, 0}},
                   {SimLayer::sand, SimLayer::airborne_sand, SimLayer::hopping},
                   40};
        if (echoes) {
            d.reads.add({SimLayer::echo, 0});
            d.least_bytes += 4;
        }
        return d;
    }

    /// What the wind would lift, in ticks, were there sand enough.
    template <bool k_echoes> SAHEL_HD float wanted(int32_t s, int32_t x, int32_t y) const {
        const float open = (1.0f - shadow(s, x, y)) * (1.0f - plant_cover(vegetation(s, x, y)));
        float ticks = lift_ticks * open;
        if constexpr (k_echoes) {
            const float e = echo(s, x, y);
            ticks = ticks * det::pick(e > 0.0f, 0.5f, 1.0f) + det::max(-e, 0.0f) * erosion_ticks;
        }
        const float m = wet.relative(moisture(s, x, y), sand(s, x, y) + soil(s, x, y));
        return det::pick(water(s, x, y) > k_flooded_ticks, 0.0f, ticks * grip(m));
    }
    /// Whether the outcome depends on the random words.
    SAHEL_HD bool draws(float ticks, int32_t sand_here, int32_t air) const {
        const bool lifts = (ticks > 0.0f) & (ticks < k_plain_ticks) & (sand_here > 0);
        const int32_t lifted = static_cast<int32_t>(ticks);
        const float hops = share * static_cast<float>(air + (lifted < sand_here ? lifted : sand_here));
        return lifts | ((share < 1.0f) & (hops < k_plain_ticks) & (air + sand_here > 0));
    }
    SAHEL_HD void move(int32_t s, int32_t x, int32_t y, float ticks, uint32_t bits_lift, uint32_t bits_hop) const {
        const int32_t here = sand(s, x, y);
        const int32_t wish = rounded_ticks(ticks, bits_lift);
        const int32_t lifted = wish < here ? wish : here;
        const int32_t air = airborne(s, x, y) + lifted;
        const int32_t part = rounded_ticks(share * static_cast<float>(air), bits_hop);
        const int32_t hops = ((share >= 1.0f) | (part > air)) ? air : part;
        sand(s, x, y) = here - lifted;
        airborne(s, x, y) = air - hops;
        hopping(s, x, y) = hops;
    }
    SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y) const {
        const float ticks = echoes ? wanted<true>(s, x, y) : wanted<false>(s, x, y);
        Random4 r{};
        if (draws(ticks, sand(s, x, y), airborne(s, x, y))) r = places.random(random, s, x, y);
        move(s, x, y, ticks, r.v[0], r.v[1]);
    }
};

/// One leg of the hop. Every cell gives all it has to the four cells around its target (or the nearest); a cell's sum
/// of arrivals is one of integers, so that gathering and scattering give the same bits.
struct HopLegPass {
    SlabView<const int32_t> from;
    SlabView<const float> wind_x, wind_y;
    SlabView<int32_t> to;
    float cells_per_speed; ///< cells that a wind of 1 m/s goes in a leg
    float longest;         ///< cells that the fastest wind goes
    bool bilinear_targets;

    SAHEL_HD int32_t radius() const { return static_cast<int32_t>(longest) + 1; }
    static PassDecl decl(SimLayer from, SimLayer to, int32_t radius) {
        return {"sim/hop_leg", {{from, radius}, {SimLayer::wind_x, radius}, {SimLayer::wind_y, radius}}, {to}, 16};
    }

    struct Target {
        int32_t x; ///< from the own cell
        int32_t y;
        float u;
        float v;
    };
    SAHEL_HD Target target(float wx, float wy) const {
        return bilinear_targets ? target<true>(wx, wy) : target<false>(wx, wy);
    }
    template <bool k_bilinear> SAHEL_HD Target target(float wx, float wy) const {
        const float dx = det::clamp(wx * cells_per_speed, -longest, longest);
        const float dy = det::clamp(wy * cells_per_speed, -longest, longest);
        if constexpr (!k_bilinear) return {CellOffset::round(dx), CellOffset::round(dy), 0.0f, 0.0f};
        const CellOffset o = CellOffset::bilinear(dx, dy);
        return {o.x, o.y, o.u, o.v};
    }
    /// The part of an amount that goes to the farther side; the rest stays on the nearer.
    SAHEL_HD static int32_t part(int32_t amount, float share) {
        const auto p = static_cast<int32_t>(static_cast<float>(amount) * share + 0.5f);
        return p < amount ? p : amount;
    }
    /// Shares of (0, 0), (1, 0), (0, 1), (1, 1): they add up to the amount.
    struct Shares {
        int32_t t[4];
    };
    SAHEL_HD static Shares shares(int32_t amount, float u, float v) {
        const int32_t lower = part(amount, v);
        const int32_t upper = amount - lower;
        const int32_t upper_right = part(upper, u);
        const int32_t lower_right = part(lower, u);
        return {{upper - upper_right, upper_right, lower - lower_right, lower_right}};
    }

    /// The donor of border_flows.h.
    template <class Sink> SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y, Sink& sink) const {
        const int32_t amount = from(s, x, y);
        if (amount == 0) return;
        const Target g = target(wind_x(s, x, y), wind_y(s, x, y));
        const Shares part_of = shares(amount, g.u, g.v);
        for (int32_t i = 0; i < 4; ++i) {
            const int32_t dx = g.x + (i & 1);
            const int32_t dy = g.y + (i >> 1);
            if ((dx != 0 || dy != 0) && part_of.t[i] != 0) sink(x + dx, y + dy, part_of.t[i]);
        }
    }
};

/// What arrived settles or bounces; what bounces wears soil and rock away.
struct DepositPass {
    SlabView<const int32_t> arrived, water, moisture, object, surface;
    SlabView<const float> shadow, vegetation, echo, resistance, wind_x, wind_y;
    SlabView<int32_t> bedrock, soil, sand, airborne;
    SlabView<float> bounce;
    CellPlaces places;
    RandomStream random;
    RandomStream random_wear;
    WetGround wet;
    int32_t bounce_threshold;   ///< ticks
    int32_t abrasion_threshold; ///< ticks
    int32_t cell_ticks;         ///< side of a cell
    float per_second;           ///< metres in a second of ticks in this step
    float wear;                 ///< ticks of rock for each metre (by_amount: tick) that bounces, and for each m/s
    float soil_wear;
    bool by_amount;
    bool echoes;
    bool wears;

    static PassDecl decl(SimLayer arrived, bool echoes, bool wears) {
        PassDecl d{"sim/deposit",
                   {{arrived, 0},
                    {SimLayer::soil, 0},
                    {SimLayer::sand, 0},
                    {SimLayer::water, 0},
                    {SimLayer::moisture, 0},
                    {SimLayer::airborne_sand, 0},
                    {SimLayer::wind_shadow, 0},
                    {SimLayer::vegetation, 0},
                    {SimLayer::object, 0}},
                   {SimLayer::sand, SimLayer::airborne_sand, SimLayer::bounce},
                   48};
        if (echoes) {
            d.reads.add({SimLayer::echo, 0});
            d.least_bytes += 4;
        }
        if (wears) {
            for (const SimLayer l : {SimLayer::bedrock, SimLayer::resistance, SimLayer::wind_x, SimLayer::wind_y})
                d.reads.add({l, 0});
            d.reads.add({SimLayer::surface, 1});
            d.writes.insert({SimLayer::bedrock, SimLayer::soil});
            d.least_bytes += 28;
        }
        return d;
    }

    struct Ground {
        int32_t sand;
        int32_t soil;
        float plants;
        float moisture;
        bool flooded;
    };
    SAHEL_HD Ground ground(int32_t s, int32_t x, int32_t y) const {
        Ground g;
        g.sand = sand(s, x, y);
        g.soil = soil(s, x, y);
        g.plants = plant_cover(vegetation(s, x, y));
        g.moisture = wet.relative(moisture(s, x, y), g.sand + g.soil);
        g.flooded = water(s, x, y) > k_flooded_ticks;
        return g;
    }
    /// The share that settles.
    template <bool k_echoes> SAHEL_HD float settling(int32_t s, int32_t x, int32_t y, const Ground& g) const {
        const float off_sand = det::pick(g.sand > bounce_threshold, 0.4f, 0.6f);
        const float off = det::pick((g.sand <= bounce_threshold) & (g.soil > bounce_threshold), 0.5f, off_sand);
        float p = det::max(shadow(s, x, y), (1.0f - off) + off * g.plants);
        if constexpr (k_echoes) {
            const float e = echo(s, x, y);
            p = det::pick(e < 0.0f, 0.0f, det::max(p, e));
        }
        p = p * det::clamp(1.0f - 10.0f * g.moisture, 0.01f, 1.0f);
        p = det::pick(g.flooded, det::min(p, 0.01f), p);
        return det::pick(object(s, x, y) != 0, 0.0f, p);
    }
    SAHEL_HD bool draws(float ticks) const { return (ticks > 0.0f) & (ticks < k_plain_ticks); }
    /// How much deeper than its eight neighbours a cell may yet become: one cell side.
    SAHEL_HD int32_t depth_left(int32_t s, int32_t x, int32_t y) const {
        const auto lower = [](int32_t a, int32_t b) { return a < b ? a : b; };
        const int32_t north = lower(lower(surface(s, x - 1, y - 1), surface(s, x, y - 1)), surface(s, x + 1, y - 1));
        const int32_t south = lower(lower(surface(s, x - 1, y + 1), surface(s, x, y + 1)), surface(s, x + 1, y + 1));
        const int32_t lowest = lower(lower(north, south), lower(surface(s, x - 1, y), surface(s, x + 1, y)));
        const int32_t left = cell_ticks + (surface(s, x, y) - lowest);
        return left > 0 ? left : 0;
    }
    /// `settles`: arrived * settling, in ticks.
    SAHEL_HD void move(int32_t s, int32_t x, int32_t y, const Ground& g, float settles, uint32_t bits) const {
        const int32_t here = arrived(s, x, y);
        const int32_t part = rounded_ticks(settles, bits);
        const int32_t down = part < here ? part : here;
        bounce(s, x, y) =
            det::pick(g.flooded, 0.0f, static_cast<float>(here) * per_second * (1.0f - g.plants) * loose(g.moisture));
        airborne(s, x, y) = airborne(s, x, y) + (here - down);
        sand(s, x, y) = g.sand + down;
    }
    /// Wear, before the move.
    SAHEL_HD float wear_scale(int32_t s, int32_t x, int32_t y, const Ground& g, float settles, int32_t here) const {
        const float bounced = static_cast<float>(here) - settles;
        const float wx = wind_x(s, x, y);
        const float wy = wind_y(s, x, y);
        const float rest = det::pick(by_amount, bounced, det::pick(here > 0, bounced / static_cast<float>(here), 0.0f));
        return det::pick(g.flooded | (object(s, x, y) != 0), 0.0f,
                         rest * det::sqrt(wx * wx + wy * wy) * (1.0f - g.plants));
    }
    SAHEL_HD bool can_wear(const Ground& g, float scale) const {
        return (scale > 0.0f) & (g.sand < abrasion_threshold);
    }
    /// Ticks of rock and soil that become sand; bits are needed where can_wear.
    SAHEL_HD int32_t worn(int32_t s, int32_t x, int32_t y, const Ground& g, float scale, uint32_t bits_rock,
                          uint32_t bits_soil) const {
        const int32_t rock_wish = stochastic_round(wear * (1.0f - resistance(s, x, y)) * scale, bits_rock);
        const int32_t soil_wish = stochastic_round(soil_wear * loose(g.moisture) * scale, bits_soil);
        const int32_t left = depth_left(s, x, y);
        const int32_t bare = -static_cast<int32_t>(g.sand + g.soil < abrasion_threshold); // all bits, or none
        const int32_t thin = -static_cast<int32_t>(g.sand < abrasion_threshold);
        const int32_t rock = bare & (rock_wish < left ? rock_wish : left);
        const int32_t earth = thin & (soil_wish < g.soil ? soil_wish : g.soil);
        bedrock(s, x, y) = bedrock(s, x, y) - rock;
        soil(s, x, y) = g.soil - earth;
        return rock + earth;
    }
    SAHEL_HD void operator()(int32_t s, int32_t x, int32_t y) const {
        Ground g = ground(s, x, y);
        const int32_t here = arrived(s, x, y);
        const float share = echoes ? settling<true>(s, x, y, g) : settling<false>(s, x, y, g);
        const float settles = static_cast<float>(here) * share;
        const uint32_t bits = draws(settles) ? places.random(random, s, x, y).v[0] : 0;
        if (wears) {
            const float scale = wear_scale(s, x, y, g, settles, here);
            Random4 r{};
            if (can_wear(g, scale)) r = places.random(random_wear, s, x, y);
            g.sand += worn(s, x, y, g, scale, r.v[0], r.v[1]);
        }
        move(s, x, y, g, settles, bits);
    }
};

} // namespace sahel
