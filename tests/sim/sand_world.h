#pragma once

#include "sim/sand_params.h"
#include "sim/sand_passes.h"
#include "sim/step_plan.h"
#include "sim/tile_domain.h"
#include "world/field.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

/// Small worlds for the passes of the sand: every layer filled, by a constant or a function of the world cell.
namespace sahel::test {

inline const SimLayerSet k_sand_layers{
    SimLayer::bedrock,      SimLayer::soil,        SimLayer::sand,       SimLayer::water,  SimLayer::airborne_sand,
    SimLayer::moisture,     SimLayer::vegetation,  SimLayer::resistance, SimLayer::object, SimLayer::wind_x,
    SimLayer::wind_y,       SimLayer::wind_shadow, SimLayer::cliff,      SimLayer::echo,   SimLayer::hopping,
    SimLayer::hopping_next, SimLayer::bounce,      SimLayer::repose,     SimLayer::surface};

class SandWorld {
  public:
    /// Periodic, of tiles x tiles tiles; all layers 0, wind 5 m/s towards +x.
    explicit SandWorld(int32_t n = 128, int32_t halo = 64, int64_t tiles = 1)
        : SandWorld(TileLayout::rectangle(n, halo, tiles, tiles, Border::periodic)) {}
    explicit SandWorld(TileLayout layout) : domain(TileDomain::create(std::move(layout), k_sand_layers).value()) {
        k_sand_layers.for_each([&](SimLayer l) {
            if (info_of(l).type == LayerType::real)
                real(l, 0.0f);
            else
                ticks(l, 0);
        });
        real(SimLayer::wind_x, 5.0f);
    }

    void real(SimLayer l, const std::function<float(int64_t, int64_t)>& f) { EXPECT_TRUE(domain.fill(l, f).ok()); }
    void real(SimLayer l, float v) {
        real(l, [v](int64_t, int64_t) { return v; });
    }
    void ticks(SimLayer l, const std::function<int32_t(int64_t, int64_t)>& f) { EXPECT_TRUE(domain.fill(l, f).ok()); }
    void ticks(SimLayer l, int32_t v) {
        ticks(l, [v](int64_t, int64_t) { return v; });
    }
    void metres(SimLayer l, float v) { ticks(l, ticks_of_metres(v)); }
    void metres(SimLayer l, const std::function<float(int64_t, int64_t)>& f) {
        ticks(l, [&f](int64_t x, int64_t y) { return ticks_of_metres(f(x, y)); });
    }

    void run(const std::vector<Pass>& passes) {
        const Status ran = run_passes(domain, passes);
        ASSERT_TRUE(ran.ok()) << ran.error().message;
    }
    void run(const Pass& pass) { run(std::vector<Pass>{pass}); }

    [[nodiscard]] float real_at(SimLayer l, int32_t x, int32_t y) const {
        return std::as_const(domain).reals(l)(0, x, y);
    }
    [[nodiscard]] int32_t ticks_at(SimLayer l, int32_t x, int32_t y) const {
        return std::as_const(domain).ints(l)(0, x, y);
    }
    [[nodiscard]] float metres_at(SimLayer l, int32_t x, int32_t y) const { return metres_of_ticks(ticks_at(l, x, y)); }
    [[nodiscard]] int64_t sum(SimLayer l) const {
        int64_t sum = 0;
        for (const int64_t s : domain.sums(l).value()) sum += s;
        return sum;
    }
    /// Bedrock, soil, sand and what is in the air.
    [[nodiscard]] int64_t mass() const {
        return sum(SimLayer::bedrock) + sum(SimLayer::soil) + sum(SimLayer::sand) + sum(SimLayer::airborne_sand);
    }

    TileDomain domain;
};

} // namespace sahel::test
