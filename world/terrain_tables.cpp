#include "world/terrain_tables.h"

#include "world/check.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace sahel {

namespace {

struct Wanted {
    float size_m;
    float amplitude;
};

} // namespace

TerrainTables make_terrain_tables(uint64_t seed, const BaseTerrainParams& params) {
    TerrainTables t;
    t.seed = seed;
    t.p = params;
    t.lake_salt = noise_salt(seed, 900);
    const float length = std::sqrt(params.wind_x * params.wind_x + params.wind_y * params.wind_y);
    t.wind_x = length > 0.0f ? params.wind_x / length : 1.0f;
    t.wind_y = length > 0.0f ? params.wind_y / length : 0.0f;

    // The order is part of the result: each lattice takes its rotation and its salt from its number.
    uint32_t id = 0;
    const auto take = [&](float wanted_m) { return make_lattice(seed, id++, wanted_m); };
    const auto octaves = [&](std::span<Octave> to, std::initializer_list<Wanted> from) {
        SAHEL_CHECK_EQ(to.size(), from.size());
        size_t i = 0;
        for (const Wanted& w : from) to[i++] = Octave{take(w.size_m), w.amplitude};
    };
    octaves(t.warp_x, {{9000.0f, 1700.0f}, {2400.0f, 420.0f}}); // m
    octaves(t.warp_y, {{9000.0f, 1700.0f}, {2400.0f, 420.0f}});
    octaves(t.relief, {{20000.0f, 1.15f}, {9000.0f, 0.55f}, {4200.0f, 0.24f}, {1900.0f, 0.10f}});
    octaves(t.wet, {{17000.0f, 1.1f}, {7000.0f, 0.45f}, {2500.0f, 0.18f}});
    octaves(t.continent, {{60000.0f, 0.55f},
                          {26000.0f, 0.55f},
                          {12000.0f, 0.65f},
                          {5200.0f, 0.50f},
                          {2300.0f, 0.26f},
                          {1000.0f, 0.12f}});
    octaves(t.canyon, {{15000.0f, 1.0f}, {6000.0f, 0.4f}});
    octaves(t.plain, {{5200.0f, 1.0f}, {2300.0f, 0.5f}, {1100.0f, 0.24f}, {520.0f, 0.11f}, {250.0f, 0.05f}});
    octaves(
        t.massif,
        {{5000.0f, 0.60f}, {2600.0f, 0.34f}, {1300.0f, 0.10f}, {650.0f, 0.05f}, {330.0f, 0.025f}, {170.0f, 0.012f}});
    t.massif_base = {take(7000.0f), 0.75f};
    t.canyon_line = take(7500.0f);
    t.channel_line = take(2000.0f);
    t.wind_turn = take(6500.0f);
    t.dune = take(std::max(params.dune_m, 0.5f) * 31.0f);
    t.mega = take(std::max(params.mega_dune_m, 2.0f) * 24.0f);
    t.supply = take(1700.0f);
    t.lake_shape[0] = take(600.0f);
    t.lake_shape[1] = take(220.0f);
    octaves(t.gully, {{2300.0f, 0.12f}, {1200.0f, 0.12f}, {620.0f, 0.11f}, {320.0f, 0.10f}, {165.0f, 0.09f}});
    octaves(t.fine_gully, {{84.0f, 0.13f}, {42.0f, 0.10f}});
    octaves(t.rock, {{72.0f, 0.055f}, {36.0f, 0.055f}, {18.0f, 0.055f}, {9.0f, 0.06f}, {4.5f, 0.06f}, {2.6f, 0.06f}});
    octaves(t.hummock, {{420.0f, 1.5f}, {190.0f, 1.0f}, {90.0f, 0.6f}}); // m
    t.strata = take(900.0f);
    t.tilt = take(7000.0f);
    t.dune_fine = take(38.0f);
    t.dune_warp = take(170.0f);
    t.small = take(62.0f);
    t.lake_shape[2] = take(85.0f);
    return t;
}

} // namespace sahel
