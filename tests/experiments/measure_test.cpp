#include "tools/experiments/measure_crests.h"
#include "tools/experiments/measure_dunes.h"
#include "tools/experiments/measure_relief.h"

#include <gtest/gtest.h>

namespace sahel::experiments {
namespace {

const double k_tan33 = std::tan(33.0 * k_pi / 180.0);

double gauss(double d, double sigma) {
    return std::exp(-0.5 * d * d / (sigma * sigma));
}

TEST(Plane, WrapsOverBothSeams) {
    const Plane p = Plane::made(5, 3, 1.0, [](int x, int y) { return 10 * y + x; });
    EXPECT_EQ(p.at(-1, -1), 24.0f);
    EXPECT_EQ(p.at(5, 3), 0.0f);
    EXPECT_EQ(p.at(-6, 7), 14.0f);
    EXPECT_DOUBLE_EQ(shortest(9.0, 1.0, 10.0), 2.0);
    EXPECT_DOUBLE_EQ(line_angle_between(178.0, 3.0), 5.0);
}

TEST(CrestAngle, OfWavesInAnyDirection) {
    for (const auto& [kx, ky] : {std::array{3, 0}, {0, 2}, {2, 1}, {2, -1}, {-3, 5}, {4, 4}}) {
        const Plane waves = Plane::made(128, 96, 0.5, [kx = kx, ky = ky](int x, int y) {
            return 3.0 * std::sin(2.0 * k_pi * (kx * x / 128.0 + ky * y / 96.0));
        });
        // Differences over two cells see short waves a little too flat, more so along the axis where they are shorter.
        const double normal =
            std::atan2(std::sin(4.0 * k_pi * ky / 96.0), std::sin(4.0 * k_pi * kx / 128.0)) * 180.0 / k_pi;
        const CrestAngle crest = crest_angle(waves);
        EXPECT_LT(line_angle_between(crest.angle_deg, normal + 90.0), 1.0e-3) << kx << ' ' << ky;
        EXPECT_GT(crest.coherence, 0.99);
        EXPECT_GE(crest.angle_deg, 0.0);
        EXPECT_LT(crest.angle_deg, 180.0);
    }
}

TEST(CrestAngle, CrossedWavesHaveNoDirectionAndAMaskChooses) {
    const Plane crossed = Plane::made(128, 128, 1.0, [](int x, int y) {
        return std::sin(2.0 * k_pi * 4 * x / 128.0) + std::sin(2.0 * k_pi * 4 * y / 128.0);
    });
    EXPECT_LT(crest_angle(crossed).coherence, 0.01);
    EXPECT_EQ(crest_angle(Plane(8, 8, 1.0, 7.0f)).coherence, 0.0);
    const Plane halves =
        Plane::made(128, 128, 1.0, [](int x, int y) { return std::sin(2.0 * k_pi * 4 * (y < 64 ? x : y) / 128.0); });
    const auto upper = CellMask::made(128, 128, 1.0, [](int, int y) { return y > 4 && y < 60; });
    const auto lower = CellMask::made(128, 128, 1.0, [](int, int y) { return y > 68 && y < 124; });
    EXPECT_NEAR(crest_angle(halves, &upper).angle_deg, 90.0, 1e-6);
    EXPECT_LT(line_angle_between(crest_angle(halves, &lower).angle_deg, 0.0), 1e-6);
}

TEST(TwoModes, GiveThePublishedAngles) {
    struct Row {
        double angle, resultant, instability, elongation, share;
    };
    for (const Row& r :
         {Row{45.0, 14.6, 103.7, 16.7, 0.93}, {105.0, 29.0, 73.8, 36.5, 0.66}, {150.0, 23.8, 80.4, 35.4, 0.41}}) {
        const TwoModes m = two_modes({{2.0, 0.0}, {1.0, r.angle}});
        EXPECT_NEAR(m.resultant_deg, r.resultant, 0.06) << r.angle;
        EXPECT_NEAR(m.instability_deg, r.instability, 0.06) << r.angle;
        EXPECT_NEAR(m.elongation_deg, r.elongation, 0.06) << r.angle;
        EXPECT_NEAR(m.resultant_share, r.share, 0.006) << r.angle;
    }
    // Most gross transport has a closed form here: tan a = (2 - cos t) / sin t.
    EXPECT_NEAR(two_modes({{2.0, 0.0}, {1.0, 105.0}}, 0.0).instability_deg, 66.85, 0.02);
    const TwoModes one = two_modes({{3.0, 30.0}}); // one wind: across it, and along it
    EXPECT_NEAR(one.instability_deg, 120.0, 0.02);
    EXPECT_NEAR(one.elongation_deg, 30.0, 0.02);
}

/// Heaps of sand on a periodic plane of w x h cells.
Plane heaps(int w, int h, double cell, const std::vector<std::array<double, 4>>& list) {
    return Plane::made(w, h, cell, [&](int x, int y) {
        double s = 0.0;
        for (const auto& [cx, cy, height, sigma] : list) {
            const double d =
                std::hypot(shortest(cx, (x + 0.5) * cell, w * cell), shortest(cy, (y + 0.5) * cell, h * cell));
            s += height * gauss(d, sigma);
        }
        return s;
    });
}

TEST(Dunes, AreFoundWithTheirSizes) {
    const Plane sand = heaps(200, 100, 2.0, {{100.0, 60.0, 8.0, 12.0}, {300.0, 120.0, 4.0, 6.0}});
    const std::vector<Dune> dunes = find_dunes(sand, 0.01);
    ASSERT_EQ(dunes.size(), 2u);
    EXPECT_NEAR(dunes[0].x_m, 100.0, 0.01);
    EXPECT_NEAR(dunes[0].y_m, 60.0, 0.01);
    EXPECT_NEAR(dunes[0].height_m, 8.0, 0.1);
    EXPECT_NEAR(dunes[0].volume_m3, 8.0 * 2.0 * k_pi * 144.0, 40.0);
    EXPECT_NEAR(dunes[1].volume_m3, 4.0 * 2.0 * k_pi * 36.0, 20.0);
    const double radius = 12.0 * std::sqrt(2.0 * std::log(8.0 / 0.01)); // where the threshold is
    const DuneExtent e = extent_of(dunes[0], sand, 30.0);
    EXPECT_NEAR(e.length_m, 2.0 * radius, 2.5);
    EXPECT_NEAR(e.width_m, 2.0 * radius, 2.5);
    EXPECT_NEAR(dunes[0].area_m2, k_pi * radius * radius, 40.0);
    EXPECT_EQ(find_dunes(sand, 0.01, dunes[1].area_m2 + 1.0).size(), 1u);
    EXPECT_FALSE(dunes[0].spans);
}

TEST(Dunes, AcrossTheSeamAreOne) {
    const Plane sand = heaps(64, 64, 1.0, {{1.0, 62.5, 5.0, 4.0}});
    const std::vector<Dune> dunes = find_dunes(sand, 0.05);
    ASSERT_EQ(dunes.size(), 1u);
    EXPECT_NEAR(dunes[0].x_m, 1.0, 0.01);
    EXPECT_NEAR(dunes[0].y_m, 62.5, 0.01);
    EXPECT_FALSE(dunes[0].spans);
    EXPECT_LT(extent_of(dunes[0], sand, 0.0).length_m, 30.0);
    EXPECT_NEAR(dunes[0].volume_m3, 5.0 * 2.0 * k_pi * 16.0, 6.0);
}

TEST(Dunes, ThatCloseAroundThePlaneSaySo) {
    const Plane ridge = Plane::made(64, 48, 1.0, [](int, int y) { return 3.0 * gauss(y - 20.0, 4.0); });
    ASSERT_EQ(find_dunes(ridge, 0.5).size(), 1u);
    EXPECT_TRUE(find_dunes(ridge, 0.5)[0].spans);
    const Plane bar = Plane::made(64, 48, 1.0, [](int x, int y) { return x < 60 ? 3.0 * gauss(y - 20.0, 4.0) : 0.0; });
    EXPECT_FALSE(find_dunes(bar, 0.5)[0].spans);
}

/// A crescent: the outline is a disc without a smaller disc that lies downwind; the back rises gently to a brink before
/// the hollow and falls there at repose.
Plane crescent(double wind_deg, double cell) {
    const Vec2 d = unit_of(wind_deg);
    return Plane::made(128, 128, cell, [&](int x, int y) {
        const double u = ((x - 64) * d.x + (y - 64) * d.y) * cell;
        const double v = (-(x - 64) * d.y + (y - 64) * d.x) * cell;
        const double outer = 40.0 - std::hypot(u, v);         // inside above 0
        const double hollow = std::hypot(u - 28.0, v) - 26.0; // outside above 0
        return std::max(std::min(0.15 * outer, 0.6 * hollow), 0.0);
    });
}

TEST(Barchans, PointTheirHornsDownwind) {
    for (const double wind : {0.0, 37.0, 90.0, 200.0}) {
        const Plane sand = crescent(wind, 1.0);
        const std::vector<Dune> dunes = find_dunes(sand, 0.1);
        ASSERT_EQ(dunes.size(), 1u);
        const BarchanShape shape = barchan_shape(dunes[0], sand, wind);
        EXPECT_GT(shape.left_horn_m, 8.0) << wind;
        EXPECT_GT(shape.right_horn_m, 8.0) << wind;
        EXPECT_NEAR(shape.left_horn_m, shape.right_horn_m, 3.0) << wind;
        EXPECT_NEAR(shape.windward_slope, 0.15, 0.03) << wind;
        EXPECT_GT(shape.lee_slope, 0.4) << wind;
        EXPECT_TRUE(shape.is_barchan()) << wind;
        EXPECT_FALSE(barchan_shape(dunes[0], sand, wind + 180.0).is_barchan()) << wind; // the same, seen backwards
    }
    const Plane heap = heaps(128, 128, 1.0, {{64.0, 64.0, 6.0, 10.0}});
    EXPECT_FALSE(barchan_shape(find_dunes(heap, 0.1)[0], heap, 0.0).is_barchan());
}

TEST(Tracks, FollowDunesThroughTheSeam) {
    const Plane before =
        heaps(200, 200, 1.0, {{190.0, 50.0, 5.0, 6.0}, {60.0, 195.0, 3.0, 5.0}, {100.0, 100.0, 4.0, 7.0}});
    const Plane after = heaps(200, 200, 1.0, {{5.0, 52.0, 5.0, 6.0}, {85.0, 3.0, 3.0, 5.0}, {100.0, 100.0, 9.0, 7.0}});
    const std::vector<Dune> a = find_dunes(before, 0.05);
    const std::vector<Dune> b = find_dunes(after, 0.05);
    ASSERT_EQ(a.size(), 3u);
    ASSERT_EQ(b.size(), 3u);
    const std::vector<DuneTrack> tracks = track_dunes(a, b, before, {.reach_m = 40.0});
    ASSERT_EQ(tracks.size(), 2u); // the third grew beyond what the same dune could
    for (const DuneTrack& t : tracks) {
        const bool first = std::abs(a[t.before].y_m - 50.0) < 5.0;
        EXPECT_NEAR(t.shift_x_m, first ? 15.0 : 25.0, 0.1);
        EXPECT_NEAR(t.shift_y_m, first ? 2.0 : 8.0, 0.1);
    }
    EXPECT_TRUE(track_dunes(a, b, before, {.reach_m = 10.0}).empty());
    // A shift of more than half the plane is found where it is expected.
    const Plane far = heaps(200, 200, 1.0, {{110.0, 50.0, 5.0, 6.0}});
    const auto long_way =
        track_dunes(a, find_dunes(far, 0.05), before, {.reach_m = 150.0, .expect_x_m = 115.0, .expect_y_m = 0.0});
    ASSERT_EQ(long_way.size(), 1u);
    EXPECT_NEAR(long_way[0].shift_x_m, 120.0, 0.1);
}

TEST(Tracks, OfHeapsThatMoveAsBagnoldSaysGiveSlopeMinusOne) {
    std::vector<std::array<double, 4>> from, to;
    for (int i = 0; i < 6; ++i) {
        const double height = 2.0 * std::pow(1.35, i);
        from.push_back({60.0 + 3.0 * i, 40.0 + 80.0 * i, height, 1.2 * height});
        to.push_back({60.0 + 3.0 * i + 90.0 / height, 40.0 + 80.0 * i, height, 1.2 * height});
    }
    const Plane before = heaps(256, 512, 1.0, from);
    const Plane after = heaps(256, 512, 1.0, to);
    const auto a = find_dunes(before, 0.05);
    const auto b = find_dunes(after, 0.05);
    std::vector<Vec2> points;
    for (const DuneTrack& t : track_dunes(a, b, before, {.reach_m = 60.0}))
        points.push_back({a[t.before].height_m, std::hypot(t.shift_x_m, t.shift_y_m)});
    const auto fit = fit_log_log(points);
    ASSERT_TRUE(fit.has_value());
    EXPECT_EQ(fit->count, 6);
    EXPECT_NEAR(fit->slope, -1.0, 0.03);
}

TEST(Crests, TheMeanOfLinesIsTheirDirectionNotOfTheirNumbers) {
    const CrestAngle across_zero = mean_line({{170.0, 1.0}, {10.0, 1.0}});
    EXPECT_NEAR(std::min(across_zero.angle_deg, 180.0 - across_zero.angle_deg), 0.0, 1e-9);
    EXPECT_NEAR(across_zero.coherence, std::cos(20.0 * k_pi / 180.0), 1e-12);
    EXPECT_NEAR(mean_line({{30.0, 0.9}, {60.0, 0.0}}).angle_deg, 30.0, 1e-9);
    EXPECT_NEAR(mean_line({{0.0, 0.5}, {90.0, 0.5}}).coherence, 0.0, 1e-12);
}

TEST(LogFit, IsExactForPowersAndRefusesLess) {
    const auto fit = fit_log_log({{1.0, 3.0}, {2.0, 12.0}, {4.0, 48.0}, {-1.0, 2.0}});
    ASSERT_TRUE(fit.has_value());
    EXPECT_NEAR(fit->slope, 2.0, 1e-12);
    EXPECT_NEAR(std::exp(fit->intercept), 3.0, 1e-12);
    EXPECT_NEAR(fit->slope_error, 0.0, 1e-6);
    EXPECT_EQ(fit->count, 3);
    EXPECT_FALSE(fit_log_log({{1.0, 3.0}, {2.0, 12.0}}).has_value());
    EXPECT_FALSE(fit_log_log({{2.0, 3.0}, {2.0, 12.0}, {2.0, 5.0}}).has_value());
}

TEST(Relief, HeapAtReposeHasNoExcessAndAllSymmetries) {
    const double volume = 100.0 * 100.0 * 400.0;
    const double top = heap_heights(volume, k_tan33).lower_octagon_m;
    EXPECT_NEAR(top, 115.2, 0.06);
    EXPECT_NEAR(heap_heights(199.0 * 199.0 * 400.0, k_tan33).lower_octagon_m, 182.2, 0.06);
    const auto heap = [&](double cx, double cy) {
        return Plane::made(400, 400, 1.0, [=](int x, int y) {
            const double u = std::abs(x - cx);
            const double v = std::abs(y - cy);
            return std::max(top - k_tan33 * std::max({u, v, (u + v) / std::sqrt(2.0)}), 0.0);
        });
    };
    Plane between = heap(199.5, 199.5);
    EXPECT_NEAR(mean_of(between) * 160000.0, volume, volume * 1e-3);
    const SlopeExcess slopes = slope_excess(between, between, k_tan33);
    EXPECT_NEAR(slopes.largest, 0.0, 1e-4);
    EXPECT_NEAR(slopes.median, 0.0, 1e-4);
    EXPECT_NEAR(slopes.steepest_deg, 33.0, 0.01);
    EXPECT_EQ(slopes.above_tenth, 0);
    EXPECT_EQ(asymmetry8(between, 399, 399), 0.0);
    EXPECT_EQ(asymmetry8(heap(200.0, 200.0), 400, 400), 0.0);
    EXPECT_GT(asymmetry8(between, 400, 400), 0.1); // about the wrong point
    between.at(150, 180) += 0.25f;
    EXPECT_NEAR(asymmetry8(between, 399, 399), 0.25, 1e-5);
    EXPECT_GT(slope_excess(between, between, k_tan33).largest, 0.2);
    EXPECT_LT(slope_excess(between, between, Plane(400, 400, 1.0, 2.0f)).largest, 0.0);
}

TEST(Relief, CoverageSpreadAndCorrelation) {
    const Plane a = Plane::made(10, 10, 1.0, [](int x, int) { return x < 3 ? 2.0 : 0.0; });
    EXPECT_DOUBLE_EQ(coverage_of(a, 0.1), 0.3);
    EXPECT_NEAR(mean_of(a), 0.6, 1e-6);
    EXPECT_NEAR(deviation_of(a), std::sqrt(0.3 * 1.96 + 0.7 * 0.36), 1e-6);
    Plane b = a;
    for (float& v : b.values) v = 5.0f - 3.0f * v;
    EXPECT_NEAR(correlation_of(a, a), 1.0, 1e-12);
    EXPECT_NEAR(correlation_of(a, b), -1.0, 1e-12);
    EXPECT_EQ(correlation_of(a, Plane(10, 10, 1.0, 1.0f)), 0.0);
    EXPECT_EQ(largest_of(a), 2.0f);
    EXPECT_EQ(least_of(a), 0.0f);
}

TEST(Relief, SidesTellLeeFromBack) {
    // A sawtooth that rises over 24 cells and falls over 8.
    const Plane teeth = Plane::made(128, 64, 0.5, [](int x, int) {
        const int u = x % 32;
        return 0.25 * (u < 24 ? u : 3 * (32 - u));
    });
    const SidesAlong along = sides_along(teeth, 0.0);
    EXPECT_NEAR(along.rising, 0.5, 1e-6);
    EXPECT_NEAR(along.falling, 1.5, 1e-6);
    EXPECT_NEAR(sides_along(teeth, 180.0).rising, 1.5, 1e-6);
    EXPECT_NEAR(sides_along(teeth, 60.0).falling, 0.75, 1e-6);
}

TEST(Relief, CountsArms) {
    for (const int arms : {1, 3, 4, 5}) {
        const Plane star = Plane::made(128, 128, 1.0, [=](int x, int y) {
            const double r = std::hypot(x - 64.0, y - 64.0);
            return std::max(20.0 - 0.4 * r, 0.0) * (1.0 + 0.3 * std::cos(arms * std::atan2(y - 64.0, x - 64.0)));
        });
        EXPECT_EQ(count_arms(star, 64.5, 64.5, 20.0), arms);
    }
    EXPECT_EQ(count_arms(Plane(64, 64, 1.0, 3.0f), 32.0, 32.0, 10.0), 0);
}

TEST(Relief, BoxMeanKeepsTheSumAndWraps) {
    Plane spike(16, 12, 1.0);
    spike.at(0, 11) = 25.0f;
    const Plane mean = box_mean(spike, 2);
    EXPECT_NEAR(mean.at(-2, 1), 1.0, 1e-6);
    EXPECT_NEAR(mean.at(2, 9), 1.0, 1e-6);
    EXPECT_NEAR(mean.at(3, 11), 0.0, 1e-6);
    EXPECT_NEAR(mean_of(mean), mean_of(spike), 1e-6);
}

TEST(Relief, RoughnessTellsAcrossFromAlong) {
    const Plane ripples = Plane::made(64, 64, 1.0, [](int, int y) { return y & 1 ? 0.1 : -0.1; });
    const CellMask all(64, 64, 1.0, 1);
    const Roughness r = roughness_of(ripples, all);
    EXPECT_NEAR(r.across_m, 0.4, 1e-6);
    EXPECT_NEAR(r.along_m, 0.0, 1e-6);
    EXPECT_EQ(r.cells, 64 * 64);
    EXPECT_NEAR(roughness_of(ripples, all, false).along_m, 0.4, 1e-6);
    Plane flipped = ripples;
    for (float& v : flipped.values) v = -v;
    EXPECT_NEAR(correlation_of(second_difference_across(ripples), second_difference_across(flipped)), -1.0, 1e-9);
}

} // namespace
} // namespace sahel::experiments
