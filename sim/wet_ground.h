#pragma once

#include "world/det_math.h"
#include "world/layers.h"
#include "world/macros.h"

#include <cstdint>

/// What water does to sand (Oasis 3.0, A5, A7, A9): how wet the ground is, relative to what it holds, and how that
/// slows wind and steepens or liquefies slopes. Dry ground gives factors of exactly 1.
namespace sahel {

inline constexpr int32_t k_flooded_ticks = 1; ///< water deeper than 1e-5 m (1.3 ticks) covers a cell

struct WetGround {
    float capacity_m;     ///< of deep ground
    float depth_per_tick; ///< of sand and soil: 1 / (thickness that holds as much)

    /// Relative moisture, 0 to 1.
    SAHEL_HD float relative(int32_t moisture, int32_t sand_and_soil) const {
        const float capacity = capacity_m * det::min(static_cast<float>(sand_and_soil) * depth_per_tick, 1.0f);
        return det::min(static_cast<float>(moisture) * k_m_per_tick / (capacity + 1e-6f), 1.0f);
    }
};

/// Below 0: a cell where plants are forbidden.
SAHEL_HD float plant_cover(float density) {
    return det::max(density, 0.0f);
}
/// Share of the wind's grip that is left: none from 10 % moisture on.
SAHEL_HD float grip(float moisture) {
    return det::clamp(1.0f - 10.0f * moisture, 0.0f, 1.0f);
}
/// Share of loose grains: none from 50 % moisture on.
SAHEL_HD float loose(float moisture) {
    return det::clamp(1.0f - 2.0f * moisture, 0.0f, 1.0f);
}
/// Factor on the tangent of repose: 1 dry, 1.5 at 50 % moisture, then down to 1.5 - fall when saturated.
SAHEL_HD float cohesion(float moisture, float fall) {
    const float n = 2.0f * moisture - 1.0f;
    return 1.5f + n * det::pick(n <= 0.0f, 0.5f, -fall);
}

} // namespace sahel
