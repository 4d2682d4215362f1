#include "render/view_score.h"
#include "world/base_terrain.h"
#include "world/executor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace sahel {
namespace {

using Metres = std::function<double(double x_m, double y_m)>;

/// Sand on rock, and water on it, as functions of world metres.
class Land final : public SurfaceSource {
  public:
    explicit Land(Metres ground_m, Metres water_m = {})
        : ground_m_(std::move(ground_m)), water_m_(std::move(water_m)) {}

    Status read(LayerBlock& block) const override {
        block.clear();
        const auto rock = block.ints(Layer::bedrock), sand = block.ints(Layer::sand), water = block.ints(Layer::water);
        const double side = std::ldexp(1.0, block.level());
        for (int32_t y = rock.y0; y < rock.y1; ++y)
            for (int32_t x = rock.x0; x < rock.x1; ++x) {
                const double x_m = (static_cast<double>(block.rect().x0 + (x - rock.x0)) + 0.5) * side;
                const double y_m = (static_cast<double>(block.rect().y0 + (y - rock.y0)) + 0.5) * side;
                rock(x, y) = ticks_of_metres(ground_m_(x_m, y_m));
                sand(x, y) = ticks_of_metres(1.0);
                water(x, y) = water_m_ ? ticks_of_metres(water_m_(x_m, y_m)) : 0;
            }
        return {};
    }
    [[nodiscard]] double cell_m() const override { return 1.0; }

  private:
    Metres ground_m_, water_m_;
};

double plain(double, double) {
    return 0.0;
}

/// Ridges across the view to the east, so many, 600 m apart, each higher than the one before.
Metres ridges(int count) {
    return [count](double x, double) {
        const double k = std::round((x - 400.0) / 600.0);
        if (k < 0.0 || k >= count) return 0.0;
        return std::max(0.0, 20.0 + 30.0 * k - 0.3 * std::abs(x - 400.0 - 600.0 * k));
    };
}

/// A lake of the radius, so far to the east and aside to the south.
Metres lake(double x_m, double y_m, double radius_m) {
    return [=](double x, double y) { return std::hypot(x - x_m, y - y_m) < radius_m ? 3.0 : 0.0; };
}

ViewMeasures look_east(const Land& land, double sun_azimuth_deg = 90.0, double eye_m = 91.0, double pitch_deg = -8.0) {
    ViewTerrain terrain(land);
    const CameraPose pose{.eye_m = {0.0, 0.0, eye_m}, .yaw_deg = 0.0, .pitch_deg = pitch_deg};
    return measure_view(cast_panorama(terrain, pose.eye_m, 8000.0), pose, sun_azimuth_deg, 12.0);
}

TEST(ViewScore, CountsLandsThatStandBehindEachOther) {
    EXPECT_LT(look_east(Land(plain)).layers, 0.1);
    // The ground behind the first ridge lies hidden behind it: one edge; and so on.
    EXPECT_NEAR(look_east(Land(ridges(1))).layers, 1.0, 0.3);
    EXPECT_NEAR(look_east(Land(ridges(2))).layers, 2.0, 0.4);
}

TEST(ViewScore, TellsALakeThatThePictureCuts) {
    const ViewMeasures whole = look_east(Land(plain, lake(500.0, 0.0, 150.0)));
    const ViewMeasures cut = look_east(Land(plain, lake(500.0, 400.0, 150.0)));
    EXPECT_GT(whole.water, 0.01);
    EXPECT_EQ(whole.water_cut, 0.0);
    EXPECT_GT(cut.water_cut, 0.005);
    ViewMeasures same = whole;
    same.water_cut = 0.3;
    EXPECT_LT(score_view(ViewKind::high, same), score_view(ViewKind::high, whole));
}

TEST(ViewScore, AShoreLeadsIntoThePictureAndIsThatOfALake) {
    const auto water_where = [](bool (*wet)(double x, double y)) {
        return [wet](double x, double y) { return wet(x, y) ? 3.0 : 0.0; };
    };
    const auto seen = [](const Land& land) { return look_east(land, 90.0, 6.0, -4.0); };
    const ViewMeasures across = seen(Land(plain, water_where([](double x, double) { return x > 30.0; })));
    const ViewMeasures aside = seen(Land(plain, water_where([](double, double y) { return y > 8.0; })));
    const ViewMeasures stream = seen(Land(plain, water_where([](double, double y) { return y > 8.0 && y < 22.0; })));
    EXPECT_LT(across.water_lean, 0.1);
    EXPECT_GT(aside.water_lean, 0.9);
    ViewMeasures leaning = across;
    leaning.water_lean = 0.6;
    EXPECT_GT(score_view(ViewKind::shore, leaning), score_view(ViewKind::shore, across));
    EXPECT_GT(aside.water - aside.near_water, 2.0 * (stream.water - stream.near_water));
    EXPECT_GT(score_view(ViewKind::shore, aside), score_view(ViewKind::shore, stream));
}

TEST(ViewScore, TellsWhetherTheFarSlopesFaceTheSun) {
    const Land wall([](double x, double) { return std::clamp(0.5 * (x - 2000.0), 0.0, 400.0); });
    EXPECT_GT(look_east(wall, 180.0).far_lit, 0.9); // the sun behind the eye
    EXPECT_LT(look_east(wall, 0.0).far_lit, 0.1);   // and behind the wall
}

TEST(ViewScore, MoreToSeeIsWorthMoreFromHighUp) {
    ViewMeasures m = look_east(Land(ridges(2), lake(500.0, 0.0, 150.0)), 180.0);
    const double score = score_view(ViewKind::high, m);
    m.layers = 0.0;
    EXPECT_LT(score_view(ViewKind::high, m), score);
    m = look_east(Land(ridges(2), lake(500.0, 0.0, 150.0)), 180.0);
    m.middle_contrast = 0.0;
    EXPECT_LT(score_view(ViewKind::high, m), score);
}

TEST(CameraSearch, FindsTheSameViewsOnAnyNumberOfThreads) {
    const BaseTerrain terrain(23, base_terrain_preset("oasis").value());
    CameraSearchOptions options;
    options.radius_m = 1500.0;
    options.standpoints = 3;
    options.least_score = 0.0;
    options.kinds = {ViewKind::dunes, ViewKind::high};
    const auto views = [&](int threads) {
        set_thread_count(threads);
        auto found = find_views(terrain, options);
        set_thread_count(0);
        EXPECT_TRUE(found.ok());
        return std::move(*found);
    };
    const auto one = views(1), two = views(2);
    ASSERT_FALSE(one.empty());
    ASSERT_EQ(one.size(), two.size());
    for (size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].kind, two[i].kind);
        EXPECT_EQ(one[i].pose.eye_m, two[i].pose.eye_m);
        EXPECT_EQ(one[i].pose.yaw_deg, two[i].pose.yaw_deg);
        EXPECT_EQ(one[i].score, two[i].score);
    }
}

} // namespace
} // namespace sahel
