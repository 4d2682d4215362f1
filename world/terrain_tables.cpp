#include "world/terrain_tables.h"

#include <cmath>

namespace sahel {

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
    t.warp_x[0] = take(9000.0f);
    t.warp_y[0] = take(9000.0f);
    t.warp_x[1] = take(2400.0f);
    t.warp_y[1] = take(2400.0f);
    int i = 0;
    for (const float m : {20000.0f, 9000.0f, 4200.0f, 1900.0f}) t.relief[i++] = take(m);
    i = 0;
    for (const float m : {17000.0f, 7000.0f, 2500.0f}) t.wet[i++] = take(m);
    i = 0;
    for (const float m : {60000.0f, 26000.0f, 12000.0f, 5200.0f, 2300.0f, 1000.0f}) t.continent[i++] = take(m);
    i = 0;
    for (const float m : {15000.0f, 6000.0f}) t.canyon[i++] = take(m);
    i = 0;
    for (const float m : {5200.0f, 2300.0f, 1100.0f, 520.0f, 250.0f}) t.plain[i++] = take(m);
    i = 0;
    for (const float m : {5000.0f, 2600.0f, 1300.0f, 650.0f, 330.0f, 170.0f, 7000.0f}) t.massif[i++] = take(m);
    t.line[0] = take(7500.0f);
    t.line[1] = take(2000.0f);
    t.wind_turn = take(6500.0f);
    t.dune = take(params.dune_m * 31.0f);
    ++id; // a number kept free, so that the ones after it stay what they are
    t.mega = take(max2(params.mega_dune_m, 20.0f) * 24.0f);
    t.supply = take(1700.0f);
    t.lake_shape[0] = take(600.0f);
    t.lake_shape[1] = take(220.0f);
    i = 0;
    for (const float m : {2300.0f, 1200.0f, 620.0f, 320.0f, 165.0f}) t.gully[i++] = take(m);
    i = 0;
    for (const float m : {84.0f, 42.0f}) t.fine_gully[i++] = take(m);
    i = 0;
    for (const float m : {72.0f, 36.0f, 18.0f, 9.0f, 4.5f, 2.6f}) t.rock[i++] = take(m);
    t.strata = take(900.0f);
    t.dune_fine = take(38.0f);
    i = 0;
    for (const float m : {420.0f, 190.0f, 90.0f}) t.hummock[i++] = take(m);
    t.dune_warp = take(170.0f);
    ++id;
    t.small = take(62.0f);
    return t;
}

} // namespace sahel
