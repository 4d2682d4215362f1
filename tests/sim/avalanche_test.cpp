#include "sim/avalanche.h"

#include "pass_check.h"
#include "sim/sand_params.h"
#include "world/field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace sahel::test {
namespace {

const SimLayerSet k_layers{SimLayer::bedrock, SimLayer::soil, SimLayer::sand, SimLayer::repose, SimLayer::surface_next};

TEST(Avalanche, ACellAboveAPlaneGivesTheWorkedExample) {
    TileDomain d = TileDomain::create(TileLayout::rectangle(32, 8, 1, 1, Border::periodic), k_layers).value();
    for (const SimLayer l : {SimLayer::bedrock, SimLayer::soil})
        ASSERT_TRUE(d.fill(l, [](int64_t, int64_t) { return 0; }).ok());
    const float tangent = std::tan(33.0f * 3.14159265f / 180.0f);
    ASSERT_TRUE(d.fill(SimLayer::repose, [&](int64_t, int64_t) { return tangent; }).ok());
    ASSERT_TRUE(d.fill(SimLayer::sand, [](int64_t x, int64_t y) {
                     return ticks_of_metres(x == 10 && y == 10 ? 20.0f : 10.0f);
                 }).ok());
    SandParams p;
    p.avalanche_sweeps = 1;
    AvalancheStats stats;
    ASSERT_TRUE(avalanche(d, p, 1.0, AvalancheKind::sand, {}, &stats).ok());
    const auto s = d.ints(SimLayer::sand);
    EXPECT_NEAR(metres_of_ticks(s(0, 10, 10)), 20.0 - 8.298, 1e-3);
    EXPECT_NEAR(metres_of_ticks(s(0, 11, 10)), 10.0 + 1.0524, 1e-4);
    EXPECT_NEAR(metres_of_ticks(s(0, 11, 11)), 10.0 + 1.0221, 1e-4);
    EXPECT_EQ(d.sums(SimLayer::sand).value()[0], int64_t{131072} * (10 * 32 * 32 + 10));
}

} // namespace
} // namespace sahel::test
