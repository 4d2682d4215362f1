#include "world/base_terrain.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>

namespace sahel {

std::span<const std::string_view> base_terrain_presets() {
    static constexpr std::array<std::string_view, 6> k_names = {"oasis",     "dunes",   "canyon",
                                                                "mountains", "islands", "wetland"};
    return k_names;
}

Result<BaseTerrainParams> base_terrain_preset(std::string_view name) {
    // relief, wetness, canyon bias | sea, continent | base, plain, rise | mountain, gully | dune, mega, supply |
    // canyon, mesa | wadi | lakes: probability, radius, relief, width of streams | wetland | wind
    static constexpr std::array<BaseTerrainParams, 6> k_presets = {{
        {},
        {-0.42f, 0.75f, -0.35f, 0.6f, -1.0f, 0,     0.0f,   1.0f,  180.0f, 14.0f, 90.0f, 420.0f, 1.0f,  15.0f,
         110.0f, 1.3f,  0.0f,   0.0f, 5.0f,  0.15f, 240.0f, -0.6f, 0.1f,   0.0f,  0.0f,  0.95f,  -0.31f},
        {0.02f, 0.55f, -0.15f, 0.5f, 0.55f, 0,    0.0f,   1.0f,  900.0f, 70.0f, 120.0f, 300.0f, 0.9f, 0.0f,
         0.0f,  0.35f, 380.0f, 1.0f, 8.0f,  0.1f, 200.0f, -0.2f, 0.2f,   12.0f, 0.0f,   0.80f,  0.60f},
        {0.30f, 0.95f, 0.25f, 0.7f, -1.0f, 0,    0.0f,   1.0f,  420.0f, 40.0f, 320.0f, 1650.0f, 1.0f, 0.0f,
         0.0f,  0.3f,  0.0f,  0.0f, 6.0f,  0.7f, 520.0f, -0.2f, 0.35f,  16.0f, 0.0f,   0.70f,   0.71f},
        {0.12f, 1.1f,  0.30f, 0.6f, -1.0f, 1,    -0.26f, 1.25f, 6.0f, 14.0f, 60.0f, 760.0f, 0.9f, 0.0f,
         0.0f,  0.35f, 0.0f,  0.0f, 3.0f,  0.3f, 200.0f, -0.2f, 0.3f, 0.0f,  0.0f,  0.90f,  0.44f},
        {-0.25f, 0.60f, 0.75f, 0.4f, -1.0f, 1,    0.25f,  0.45f, 2.2f, 5.0f, 40.0f, 260.0f, 0.7f, 0.0f,
         0.0f,   0.2f,  0.0f,  0.0f, 2.0f,  0.4f, 320.0f, -0.5f, 0.2f, 0.0f, 1.0f,  0.90f,  0.44f},
    }};
    const auto names = base_terrain_presets();
    for (size_t i = 0; i < names.size(); ++i)
        if (names[i] == name) return k_presets[i];
    return Error{ErrorKind::usage,
                 fmt::format("there is no preset '{}'; choose one of {}", name, fmt::join(names, ", "))};
}

} // namespace sahel
