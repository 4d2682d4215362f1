#include "sim/reptation.h"

#include "pass_check.h"
#include "sand_world.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sahel::test {
namespace {

SandParams smoothing(float k) {
    SandParams p;
    p.reptation_smooth = k;
    return p;
}

void smooth(SandWorld& w, const SandParams& p, float dt) {
    const int32_t parts = smoothing_parts(p, 1.0, dt, 5.0f);
    for (int32_t i = 0; i < parts; ++i)
        w.run({smooth_pass(p, 1.0, dt / static_cast<float>(parts)), apply_smooth_pass()});
}

SandWorld ripples(int32_t amplitude, int wavelength, bool checkerboard = false) {
    SandWorld w(64, 16);
    w.real(SimLayer::bounce, 1.0f);
    w.ticks(SimLayer::sand, [=](int64_t x, int64_t y) {
        return 500000 + ((x + (checkerboard ? y : 0)) % wavelength < wavelength / 2 ? amplitude : -amplitude);
    });
    return w;
}

// Omega = k B dt / l: a ripple from cell to cell along an axis is multiplied by 1 - 1.207 Omega, a checkerboard by
// 1 - Omega (method 3.10.4).
TEST(Smoothing, DampsAsTheAnalysisSays) {
    for (const float omega : {0.1f, 0.4f, 0.8f})
        for (const bool checkerboard : {false, true}) {
            SandWorld w = ripples(10000, 2, checkerboard);
            w.run({smooth_pass(smoothing(omega), 1.0, 1.0f), apply_smooth_pass()});
            const float left = static_cast<float>(w.ticks_at(SimLayer::sand, 0, 0) - 500000) / 10000.0f;
            EXPECT_NEAR(left, checkerboard ? 1.0f - omega : 1.0f - 1.207f * omega, 0.001f) << omega << checkerboard;
        }
}

TEST(Smoothing, NeverBlowsUpHoweverStrong) {
    for (const float k : {1.0f, 5.0f, 100.0f}) {
        SandWorld w = ripples(400000, 2);
        w.real(SimLayer::bounce, 50.0f);
        const int64_t before = w.mass();
        int32_t last = 400000;
        for (int i = 0; i < 20; ++i) {
            smooth(w, smoothing(k), 1.0f);
            const int32_t now = std::abs(w.ticks_at(SimLayer::sand, 0, 0) - 500000);
            EXPECT_LE(now, last);
            last = now;
        }
        EXPECT_LT(last, 40000);
        EXPECT_EQ(w.mass(), before);
    }
}

TEST(Smoothing, ThinSandNeverGoesBelowNothing) {
    SandWorld w(64, 16);
    w.real(SimLayer::bounce, 1.7f);
    w.real(SimLayer::wind_x, [](int64_t x, int64_t) { return 3.0f + static_cast<float>(x % 5); });
    w.metres(SimLayer::bedrock, [](int64_t x, int64_t y) { return static_cast<float>((x * 7 + y * 13) % 17); });
    w.ticks(SimLayer::sand, [](int64_t x, int64_t y) { return static_cast<int32_t>((x * 31 + y * 17) % 23); });
    SandParams p = smoothing(1.0f);
    p.reptation_smooth_wind_s_per_m = 0.5f;
    const int64_t before = w.mass();
    for (int i = 0; i < 30; ++i) {
        smooth(w, p, 1.0f);
        EXPECT_EQ(w.mass(), before); // wind varies, and still: what one gives the other takes
    }
    for (int32_t y = 0; y < 64; ++y)
        for (int32_t x = 0; x < 64; ++x) ASSERT_GE(w.ticks_at(SimLayer::sand, x, y), 0);
}

TEST(Smoothing, IsDividedWhereAFlatBedWouldOscillate) {
    EXPECT_EQ(smoothing_parts({}, 1.0, 1.0f, 5.0f), 0);
    EXPECT_EQ(smoothing_parts(smoothing(0.4f), 1.0, 1.0f, 5.0f), 1); // Omega 0.67
    EXPECT_EQ(smoothing_parts(smoothing(1.0f), 1.0, 1.0f, 5.0f), 3); // 1.67
    EXPECT_EQ(smoothing_parts(smoothing(1.0f), 0.5, 1.0f, 5.0f), 5); // 3.33
    EXPECT_EQ(smoothing_parts(smoothing(1.0f), 1.0, 0.25f, 5.0f), 1);
    SandParams p;
    p.reptation_smooth_wind_s_per_m = 0.5f;
    EXPECT_EQ(smoothing_parts(p, 1.0, 1.0f, 5.0f), 6); // 4.2
}

TEST(Smoothing, HalvingTheStepChangesLittle) {
    SandWorld whole = ripples(100000, 16);
    SandWorld half = ripples(100000, 16);
    for (int i = 0; i < 20; ++i) smooth(whole, smoothing(0.4f), 1.0f);
    for (int i = 0; i < 40; ++i) smooth(half, smoothing(0.4f), 0.5f);
    EXPECT_NEAR(whole.ticks_at(SimLayer::sand, 3, 3), half.ticks_at(SimLayer::sand, 3, 3), 2000);
    EXPECT_LT(whole.ticks_at(SimLayer::sand, 3, 3), 590000);
}

float repose_of(const SandParams& p, float bounce, float shadow, float vegetation, float moisture_m) {
    SandWorld w(16, 8);
    w.metres(SimLayer::sand, 5.0f);
    w.real(SimLayer::bounce, bounce);
    w.real(SimLayer::wind_shadow, shadow);
    w.real(SimLayer::vegetation, vegetation);
    w.metres(SimLayer::moisture, moisture_m);
    w.run(repose_pass(p));
    return w.real_at(SimLayer::repose, 3, 3);
}

TEST(Repose, PublishedValues) {
    SandParams p;
    EXPECT_NEAR(repose_of(p, 1.67f, 0.0f, 0.0f, 0.0f), 0.64941f, 1e-5f);
    EXPECT_NEAR(repose_of(p, 0.0f, 0.0f, 1.0f, 0.0f), 1.0f, 1e-6f);
    EXPECT_NEAR(repose_of(p, 0.0f, 0.0f, 0.5f, 0.0f), 0.824704f, 1e-5f);
    // half wet, saturated (Oasis A9)
    EXPECT_NEAR(repose_of(p, 0.0f, 0.0f, 0.0f, 0.5f), 0.974f, 0.0005f);
    EXPECT_NEAR(repose_of(p, 0.0f, 0.0f, 0.0f, 1.0f), 0.0974f, 0.0005f);
    EXPECT_NEAR(repose_of(p, 0.0f, 0.0f, 1.0f, 1.0f), 0.25f, 1e-4f);
    p.reptation_repose_s2_per_m2 = 0.05f;
    EXPECT_NEAR(repose_of(p, 1.67f, 0.0f, 0.0f, 0.0f), 0.428f, 0.0005f);
    EXPECT_NEAR(repose_of(p, 1.67f, 1.0f, 0.0f, 0.0f), 0.428f, 0.0005f);
    EXPECT_NEAR(repose_of(p, 1.67f, 0.0f, 1.0f, 0.0f), 1.0f, 1e-6f); // plants hold it
    p.reptation_shadowed = true;
    EXPECT_NEAR(repose_of(p, 1.67f, 1.0f, 0.0f, 0.0f), 0.64941f, 1e-5f);
    EXPECT_NEAR(repose_of(p, 1.67f, 0.5f, 0.0f, 0.0f), 0.64941f * std::exp(-0.208750f), 1e-4f);
}

TEST(Reptation, LooksNoFurtherThanItDeclares) {
    SandParams p = smoothing(1.0f);
    EXPECT_EQ(find_dishonest(smooth_pass(p, 1.0, 1.0f), k_sand_layers, 4), "");
    EXPECT_EQ(find_dishonest(repose_pass(p), k_sand_layers, 4), "");
    EXPECT_EQ(find_dishonest(apply_smooth_pass(), k_sand_layers, 4), "");
    p.reptation_smooth_wind_s_per_m = 0.5f;
    p.reptation_repose_s2_per_m2 = 0.05f;
    EXPECT_EQ(find_dishonest(smooth_pass(p, 1.0, 1.0f), k_sand_layers, 4), "");
    EXPECT_EQ(find_dishonest(repose_pass(p), k_sand_layers, 4), "");
    Pass blind = smooth_pass(p, 1.0, 1.0f);
    blind.decl = SmoothPass::decl(false); // says nothing of the wind
    EXPECT_NE(find_dishonest(blind, k_sand_layers, 4), "");
}

TEST(Reptation, EveryTickThatCrossesABorderIsCounted) {
    SandWorld w(32, 8, 2);
    w.real(SimLayer::bounce, 1.0f);
    w.metres(SimLayer::sand, [](int64_t x, int64_t y) { return static_cast<float>((x * 7 + y * 13) % 17); });
    ASSERT_TRUE(w.domain.keep_flows().ok());
    const auto before = w.domain.sums(SimLayer::sand).value();
    w.run({smooth_pass(smoothing(0.5f), 1.0, 1.0f), apply_smooth_pass()});
    const auto after = w.domain.sums(SimLayer::sand).value();
    const auto flows = w.domain.flows(SimLayer::sand).value();
    for (size_t slot = 0; slot < 4; ++slot) {
        int64_t out = 0;
        for (const int64_t f : flows[slot]) out += f;
        EXPECT_EQ(before[slot] - after[slot], out) << slot;
    }
}

} // namespace
} // namespace sahel::test
