#include "world/ground_sampler.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sahel {
namespace {

/// A plane that rises 1/4 m per cell to the east and 1/2 m per cell to the south, one metre of sand on it.
class Plane final : public SurfaceSource {
  public:
    Status read(LayerBlock& block) const override {
        if (fail) return Error{ErrorKind::io, "asked to fail"};
        block.clear();
        const CellRect owned = block.owned();
        const int64_t scale = int64_t{1} << block.level();
        auto rock = block.ints(Layer::bedrock);
        auto sand = block.ints(Layer::sand);
        for (int y = rock.y0; y < rock.y1; ++y)
            for (int x = rock.x0; x < rock.x1; ++x) {
                const double cx = (static_cast<double>(owned.x0 + x) + 0.5) * static_cast<double>(scale);
                const double cy = (static_cast<double>(owned.y0 + y) + 0.5) * static_cast<double>(scale);
                rock(x, y) = ticks_of_metres(static_cast<float>(0.25 * cx + 0.5 * cy));
                sand(x, y) = ticks_of_metres(1.0f);
            }
        return {};
    }
    [[nodiscard]] double cell_m() const override { return 2.0; }
    bool fail = false;
};

TEST(GroundSampler, InterpolatesAPlaneExactlyAcrossBlocksAndZero) {
    const Plane plane;
    for (const int level : {0, 3}) {
        GroundSampler ground(plane, level);
        for (double y = -700.0; y < 700.0; y += 93.7)
            for (double x = -700.0; x < 700.0; x += 71.3) {
                const GroundSample s = ground.at(x, y);
                EXPECT_NEAR(s.ground_m, 1.0 + 0.125 * x + 0.25 * y, 1e-4) << x << ", " << y << " level " << level;
                EXPECT_NEAR(s.sand_m, 1.0, 1e-6);
                EXPECT_EQ(s.water_m, 0.0);
            }
    }
}

TEST(GroundSampler, KeepsAnsweringFarBeyondItsCacheAndWhenTheSourceFails) {
    Plane plane;
    GroundSampler ground(plane, 0);
    for (int i = 0; i < 1500; ++i) EXPECT_NEAR(ground.surface_m(i * 80.0, 7.0), 1.0 + 0.125 * i * 80.0 + 1.75, 0.01);
    EXPECT_NEAR(ground.surface_m(0.0, 7.0), 2.75, 0.01);
    plane.fail = true;
    EXPECT_TRUE(std::isfinite(ground.surface_m(1e7, 1e7)));
}

} // namespace
} // namespace sahel
