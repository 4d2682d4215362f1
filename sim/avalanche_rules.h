#pragma once

#include "sim/directions.h"
#include "sim/slab_view.h"
#include "world/det_math.h"
#include "world/field.h"
#include "world/macros.h"

#include <cstdint>

/// The arithmetic of avalanching, shared by every kernel on every machine.
///
/// Donor rule (Desertscape method 3.11.1). A cell i of height h looks at its eight neighbours k, at distance delta_k:
///
///     e_k = h_i - h_k - tau_i delta_k l  (0 if negative)      Sum = sum of e_k      M = largest e_k
///     A   = min(kappa M / (1 + M / Sum), what lies there)     k receives e_k A / Sum
///
/// kappa = 1 is exactly the amount after which the worst pair stands at repose. In ticks: excesses, sum and largest are
/// integers, so that neither the order of neighbours nor a turn of the grid shows; A / Sum is one float; each transfer
/// is e_k A / Sum cut to whole ticks.
///
/// No sand is ever negative. Between the real number s / Sum and a product e_k (A / Sum) lie at most six roundings,
/// each of at most one part in 2^24, and one multiplication by 1 - 2^-21; hence the products sum to less than s, and
/// cutting them makes them smaller.
namespace sahel {

enum class AvalancheKind : uint8_t { sand, soil, bedrock };

inline constexpr int32_t k_most_excess = 1 << 27;            ///< 1024 m; eight of them fit
inline constexpr float k_slide_margin = 1.0f - 0x1p-21f;     ///< eight roundings
inline constexpr int32_t k_slides_without_limit = INT32_MAX; ///< rock

/// How one sweep moves.
struct SlideRule {
    float strength = 1.0f;   ///< kappa
    int32_t start_ticks = 0; ///< a cell gives only when its largest excess is above this
};

/// Excess of a drop over what repose allows, in ticks.
SAHEL_HD int32_t slide_excess(int32_t drop, int32_t repose) {
    const int32_t over = drop - repose;
    const int32_t positive = over > 0 ? over : 0;
    return positive < k_most_excess ? positive : k_most_excess;
}

/// A / Sum: the share of each excess that is given.
SAHEL_HD float slide_share(const SlideRule& rule, int32_t sum, int32_t largest, int32_t limit) {
    const auto s = static_cast<float>(sum > 0 ? sum : 1);
    const auto m = static_cast<float>(largest);
    const float wanted = (rule.strength * m) / (s + m);
    const float there = static_cast<float>(limit) / s;
    const float share = k_slide_margin * (wanted < there ? wanted : there);
    return det::pick(largest > rule.start_ticks, share, 0.0f);
}

SAHEL_HD int32_t slide_amount(int32_t excess, float share) {
    return static_cast<int32_t>(static_cast<float>(excess) * share);
}

/// Repose in ticks of height for a neighbour beside, and one across the corner.
SAHEL_HD int32_t repose_ticks(float tangent, float ticks_per_tangent) {
    const float ticks = tangent * ticks_per_tangent;
    return static_cast<int32_t>(det::clamp(ticks, 0.0f, 0x1p28f));
}
SAHEL_HD int32_t repose_across(int32_t beside) {
    return static_cast<int32_t>(static_cast<float>(beside) * k_sqrt2);
}

/// Sliding with inertia, used until quiet. Of every pair of neighbours (i, k) the amount f that slid from i to k in the
/// last sweep is remembered (negative: from k to i). With the excess e = h_i - h_k - tau_i delta l in the direction of
/// f,
///
///     f  <-  m f max(1 - c |f|, 0)  +  g e   where the pair is steeper than repose (e > 0): gravity pulls
///                                   +  b e   where it is not (e < 0): friction brakes, at most to rest
///
/// It is a mass on a slope with Coulomb friction at the angle of repose and a drag that grows with the flow, so that
/// walls of hundreds of metres do not run away when they fall (the law of Voellmy, 1955, for flowing avalanches). For
/// small flows it is the heavy ball method (Polyak, 1964) on the heights: without memory (m = 0) it is diffusion, whose
/// sweeps grow with the square of the length of a slope. g = 0.2 is stable: the largest eigenvalue of the
/// eight-neighbour Laplacian is 12, and the heavy ball is stable while 12 g < 2 (1 + m). A brake as weak as the pull (b
/// = g) lets heaps run out far below repose; b = 1 keeps slopes of 10 to 400 m within a degree of it, nearly all within
/// a quarter.
///
/// An edge takes at most an eighth of what lies in the cell that gives: eight edges never take more than all. A pair at
/// rest starts only when it is steeper than repose by the tolerance, and once it slides it comes to rest at repose: a
/// static and a dynamic angle.
inline constexpr float k_slide_memory = 0.95f;
inline constexpr float k_slide_gain = 0.2f;
inline constexpr float k_slide_brake = 1.0f;
inline constexpr float k_slide_drag_per_cell = 0.004f; ///< c, for a flow that is one cell side high

struct SlideInertia {
    int32_t start_ticks = 0; ///< nothing starts where the excess is not above this,
    int32_t rest_ticks = 0;  ///< and what slides there comes to rest once it is not thicker than this
    float drag_per_tick = 0.0f;
};

/// One side of a pair, as the other sees it.
struct SlideSide {
    int32_t repose; ///< ticks of height towards the other
    int32_t cap;    ///< the most that it gives
};

SAHEL_HD int32_t slide_cap(int32_t limit) {
    return limit >> 3;
}

SAHEL_HD int32_t slide_flow(const SlideInertia& rule, int32_t before, int32_t drop, const SlideSide& i,
                            const SlideSide& k) {
    const auto f = static_cast<float>(before);
    const float left = 1.0f - rule.drag_per_tick * det::abs(f);
    const float kept = (k_slide_memory * f) * det::pick(left > 0.0f, left, 0.0f);
    const int32_t over_i = drop - i.repose;
    const int32_t over_k = -drop - k.repose;
    const float forth = det::pick(over_i > 0, k_slide_gain, k_slide_brake) * static_cast<float>(over_i) + kept;
    const float back = det::pick(over_k > 0, k_slide_gain, k_slide_brake) * static_cast<float>(over_k) - kept;
    // At most one of the two is above 0: kept has one sign, and so has the drop.
    const auto whole = static_cast<int32_t>(det::pick(forth > 0.0f, forth, 0.0f) - det::pick(back > 0.0f, back, 0.0f));
    const bool thin = (before <= rule.rest_ticks) & (before >= -rule.rest_ticks);
    const bool rests = thin & (over_i <= rule.start_ticks) & (over_k <= rule.start_ticks);
    const int32_t free = rests ? 0 : whole;
    const int32_t most = free < i.cap ? free : i.cap;
    return most > -k.cap ? most : -k.cap;
}

/// What slides, what it lies on, and how steep it may stand, of any cell.
struct SlideCell {
    int32_t height; ///< top of the material
    int32_t limit;  ///< how much of it may leave
    int32_t repose; ///< ticks of height for a neighbour beside
};

/// The layers of one kind of avalanche. Null views: the domain has no such layer, which counts as 0 everywhere.
struct SlideGround {
    AvalancheKind kind = AvalancheKind::sand;
    SlabView<const int32_t> bedrock, soil, sand; ///< the one that moves: its present plane
    SlabView<const float> repose, vegetation;
    SlabView<const int32_t> object, moisture;
    const uint8_t* closed = nullptr; ///< [slot]: bit k: the halo in direction k is not simulated and gives nothing
    const uint8_t* walls = nullptr;  ///< [slot]: bit k: the halo in direction k mirrors the own side
    int32_t n = 0;                   ///< owned cells of a side
    float ticks_per_tangent = 0.0f;  ///< cell side in ticks
    float tangent = 0.0f, tangent_plants = 0.0f; ///< soil; rock uses the first
    float moisture_capacity_ticks = 0.0f, moisture_depth_ticks = 1.0f;

    /// The view of what slides.
    [[nodiscard]] SAHEL_HD const SlabView<const int32_t>& sliding() const {
        return kind == AvalancheKind::sand ? sand : kind == AvalancheKind::soil ? soil : bedrock;
    }
    SAHEL_HD void set_sliding(SlabView<const int32_t> plane) {
        (kind == AvalancheKind::sand ? sand : kind == AvalancheKind::soil ? soil : bedrock) = plane;
    }
    SAHEL_HD bool in(const uint8_t* bits, int32_t slot, int32_t x, int32_t y) const {
        const int k =
            direction_of(x < 0 ? -1 : static_cast<int32_t>(x >= n), y < 0 ? -1 : static_cast<int32_t>(y >= n));
        return k >= 0 && (bits[slot] >> k & 1) != 0;
    }
    SAHEL_HD bool gives(int32_t slot, int32_t x, int32_t y) const { return !in(closed, slot, x, y); }
    /// With inertia walls are no mirrors, but edges over which nothing slides; a flow into what is not simulated has
    /// no memory, since only the cell that gives is known to every tile that works it out.
    SAHEL_HD bool moves(int32_t slot, int32_t x, int32_t y) const {
        return !in(closed, slot, x, y) && !in(walls, slot, x, y);
    }
    SAHEL_HD bool sealed(int32_t slot, int32_t x, int32_t y, int32_t x2, int32_t y2) const {
        return in(walls, slot, x, y) || in(walls, slot, x2, y2);
    }
    SAHEL_HD int32_t remembered(int32_t slot, int32_t x, int32_t y, int32_t x2, int32_t y2, int32_t before) const {
        return gives(slot, x, y) && gives(slot, x2, y2) ? before : 0;
    }
    /// Wet soil (Oasis method A9): firm when moist, loose when soaked. Factor 1, 1.5, `soaked` at m = 0, 1/2, 1.
    SAHEL_HD static float wet_factor(float m, float soaked) {
        const float n_wet = 2.0f * m - 1.0f;
        return 1.5f + (n_wet > 0.0f ? soaked - 1.5f : 0.5f) * n_wet;
    }
    SAHEL_HD float soil_tangent(int32_t slot, int32_t x, int32_t y) const {
        const float v = vegetation.origin ? det::clamp(vegetation(slot, x, y), 0.0f, 1.0f) : 0.0f;
        float m = 0.0f;
        if (moisture.origin) {
            const auto deep = static_cast<float>(soil(slot, x, y) + sand(slot, x, y));
            const float holds = moisture_capacity_ticks * det::clamp(deep / moisture_depth_ticks, 0.0f, 1.0f);
            m = det::clamp(static_cast<float>(moisture(slot, x, y)) / (holds + 0.125f), 0.0f, 1.0f);
        }
        const float bare = wet_factor(m, 0.1f) * tangent;
        const float plants = wet_factor(m, 0.2f) * tangent_plants;
        return bare + v * (plants - bare);
    }
    SAHEL_HD SlideCell operator()(int32_t slot, int32_t x, int32_t y) const {
        const int32_t rock = bedrock(slot, x, y);
        if (kind == AvalancheKind::bedrock) {
            const bool stands = object.origin && object(slot, x, y) != 0;
            return {rock, stands ? 0 : k_slides_without_limit, repose_ticks(tangent, ticks_per_tangent)};
        }
        const int32_t earth = soil(slot, x, y);
        if (kind == AvalancheKind::soil)
            return {rock + earth, earth, repose_ticks(soil_tangent(slot, x, y), ticks_per_tangent)};
        const int32_t loose = sand(slot, x, y);
        return {rock + earth + loose, loose, repose_ticks(repose(slot, x, y), ticks_per_tangent)};
    }
};

} // namespace sahel
