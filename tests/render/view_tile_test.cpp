#include "render/view_tile.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace sahel {
namespace {

/// A plain with wind over its western half.
class WindyPlain final : public SurfaceSource {
  public:
    explicit WindyPlain(bool blows) : blows_(blows) {}
    Status read(LayerBlock& block) const override {
        block.clear();
        if (!blows_) return {};
        const auto wx = block.reals(Layer::wind_x), wy = block.reals(Layer::wind_y),
                   shelter = block.reals(Layer::wind_shadow);
        const auto air = block.ints(Layer::airborne_sand);
        for (int32_t y = wx.y0; y < wx.y1; ++y)
            for (int32_t x = wx.x0; x < 256; ++x) {
                wx(x, y) = 10.0f;
                wy(x, y) = -5.0f;
                shelter(x, y) = 0.5f;
                air(x, y) = ticks_of_metres(0.25f);
            }
        return {};
    }
    [[nodiscard]] double cell_m() const override { return 1.0; }

  private:
    bool blows_;
};

TEST(ViewTile, CarriesTheWindWhereItWasSimulated) {
    const auto tile = build_view_tile(WindyPlain(true), {0, 0, 0}, {}, nullptr);
    ASSERT_TRUE(tile.ok());
    constexpr int k_side = k_view_texels / 2;
    for (size_t m = 0; m < k_view_mips; ++m)
        ASSERT_EQ((*tile)->wind[m].size(), static_cast<size_t>((k_side >> m) * (k_side >> m)));
    const auto at = [&](int x, int y) {
        return (*tile)->wind[0][static_cast<size_t>((y + k_view_border) / 2 * k_side + (x + k_view_border) / 2)];
    };
    EXPECT_EQ(at(100, 30).r, 192); // 128 + 10 * 127 / 20 = 191.5
    EXPECT_EQ(at(100, 30).g, 96);  // 128 - 5 * 127 / 20 = 96.25
    EXPECT_EQ(at(100, 30).b, 128);
    EXPECT_EQ(at(100, 30).a, 128); // 0.25 m of 0.5 m
    EXPECT_EQ(at(300, 30).r, 128); // calm
    EXPECT_EQ(at(300, 30).g, 128);
    EXPECT_EQ(at(300, 30).b, 0);
    EXPECT_LE((*tile)->bytes(), view_tile_max_bytes());
}

TEST(ViewTile, HasNoWindWhereNothingWasSimulated) {
    const auto tile = build_view_tile(WindyPlain(false), {0, 0, 0}, {}, nullptr);
    ASSERT_TRUE(tile.ok());
    for (const auto& level : (*tile)->wind) EXPECT_TRUE(level.empty());
}

/// Terraces with walls of 12 m, and a pond on the lowest one or none.
class Terraces final : public SurfaceSource {
  public:
    explicit Terraces(bool pond) : pond_(pond) {}
    Status read(LayerBlock& block) const override {
        block.clear();
        const auto rock = block.ints(Layer::bedrock), soil = block.ints(Layer::soil), water = block.ints(Layer::water);
        for (int32_t y = rock.y0; y < rock.y1; ++y)
            for (int32_t x = rock.x0; x < rock.x1; ++x) {
                const int32_t terrace = std::max(x, 0) / 64;
                rock(x, y) = ticks_of_metres(12.0 * terrace);
                soil(x, y) = ticks_of_metres(0.5);
                water(x, y) = pond_ && x < 40 ? ticks_of_metres(1.0) : 0;
            }
        return {};
    }
    [[nodiscard]] double cell_m() const override { return 1.0; }

  private:
    bool pond_;
};

int shore_at(const ViewTile& tile, int x, int y) {
    return tile.material[0][static_cast<size_t>((y + k_view_border) * k_view_texels + x + k_view_border)].a;
}

TEST(ViewTile, NoWallIsTakenForAShore) {
    const auto tile = build_view_tile(Terraces(false), {0, 0, 0}, {}, nullptr);
    ASSERT_TRUE(tile.ok());
    for (int x = 0; x < k_view_cells; ++x) {
        ASSERT_EQ(shore_at(**tile, x, 100), 255) << x; // 60 m or more from water
        ASSERT_LT((*tile)->water[0][static_cast<size_t>(100 * k_view_texels + x)].x, -256) << x;
    }
}

TEST(ViewTile, TheShoreIsWhereWaterEnds) {
    const auto tile = build_view_tile(Terraces(true), {0, 0, 0}, {}, nullptr);
    ASSERT_TRUE(tile.ok());
    EXPECT_LT(shore_at(**tile, 20, 100), 64); // below 0 m: under water
    EXPECT_EQ(shore_at(**tile, 200, 100), 255);
}

} // namespace
} // namespace sahel
