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
    const uint8_t* closed =
        nullptr;   ///< [slot]: bit k: cells of the halo in direction k are not simulated and give nothing
    int32_t n = 0; ///< owned cells of a side
    float ticks_per_tangent = 0.0f;              ///< cell side in ticks
    float tangent = 0.0f, tangent_plants = 0.0f; ///< soil; rock uses the first
    float moisture_capacity_ticks = 0.0f, moisture_depth_ticks = 1.0f;

    SAHEL_HD bool gives(int32_t slot, int32_t x, int32_t y) const {
        const int k =
            direction_of(x < 0 ? -1 : static_cast<int32_t>(x >= n), y < 0 ? -1 : static_cast<int32_t>(y >= n));
        return k < 0 || (closed[slot] >> k & 1) == 0;
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
