#include "sim/wind_shadow.h"

#include "pass_check.h"
#include "sand_world.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sahel::test {
namespace {

// A wall 1 m high and one cell wide, wind towards +x.
SandWorld wall_at(int64_t wall_x) {
    SandWorld w;
    w.metres(SimLayer::bedrock, [=](int64_t x, int64_t) { return x == wall_x ? 1.0f : 0.0f; });
    w.run({ground_pass(), wind_shadow_pass({}, 1.0)});
    return w;
}

TEST(WindShadow, AWallOfOneMetre) {
    const SandWorld w = wall_at(20);
    for (int32_t d = 1; d <= 12; ++d) {
        const double m = 1.0 / d;
        const double t0 = std::tan(10.0 * M_PI / 180.0);
        const double t1 = std::tan(15.0 * M_PI / 180.0);
        const double expected = std::clamp((m - t0) / (t1 - t0), 0.0, 1.0);
        EXPECT_NEAR(w.real_at(SimLayer::wind_shadow, 20 + d, 64), expected, 2e-5) << d;
    }
    EXPECT_EQ(w.real_at(SimLayer::wind_shadow, 23, 64), 1.0f);
    EXPECT_NEAR(w.real_at(SimLayer::wind_shadow, 24, 64), 0.804f, 0.0005f);
    EXPECT_NEAR(w.real_at(SimLayer::wind_shadow, 25, 64), 0.258f, 0.0005f);
    EXPECT_EQ(w.real_at(SimLayer::wind_shadow, 26, 64), 0.0f);
    EXPECT_EQ(w.real_at(SimLayer::wind_shadow, 19, 64), 0.0f); // before the wall
}

TEST(WindShadow, GoesAcrossTheSeamOfAPeriodicWorld) {
    const SandWorld w = wall_at(126);
    EXPECT_EQ(w.real_at(SimLayer::wind_shadow, 1, 64), 1.0f);
    EXPECT_NEAR(w.real_at(SimLayer::wind_shadow, 2, 64), 0.804f, 0.0005f);
}

TEST(WindShadow, FullPrecisionOnAHighPlateau) {
    SandWorld low;
    SandWorld high;
    const auto dunes = [](int64_t x, int64_t y) {
        return static_cast<int32_t>(200000.0 * (1.0 + std::sin(2.0 * M_PI * static_cast<double>(x) / 32.0)) +
                                    static_cast<double>((x * 31 + y * 17) % 1000));
    };
    low.ticks(SimLayer::sand, dunes);
    high.ticks(SimLayer::sand, dunes);
    high.metres(SimLayer::bedrock, 4000.0f);
    for (SandWorld* w : {&low, &high}) w->run({ground_pass(), wind_shadow_pass({}, 1.0)});
    EXPECT_EQ(low.domain.hash({SimLayer::wind_shadow}).value(), high.domain.hash({SimLayer::wind_shadow}).value());
}

TEST(WindShadow, ObliqueRaysAreInterpolatedExactlyOnAPlane) {
    // On a plane the rise over the way is the slope against the wind, whatever the direction.
    for (int degrees = 0; degrees < 360; degrees += 15) {
        SandWorld w;
        const double a = degrees * M_PI / 180.0;
        w.real(SimLayer::wind_x, static_cast<float>(7.0 * std::cos(a)));
        w.real(SimLayer::wind_y, static_cast<float>(7.0 * std::sin(a)));
        const double slope = 0.22; // between tan 10 and tan 15 degrees, falling along the wind
        w.metres(SimLayer::bedrock, [&](int64_t x, int64_t y) {
            return static_cast<float>(
                -slope * (std::cos(a) * static_cast<double>(x - 64) + std::sin(a) * static_cast<double>(y - 64)));
        });
        w.run({ground_pass(), wind_shadow_pass({}, 1.0)});
        const double expected =
            (slope - std::tan(10.0 * M_PI / 180.0)) / (std::tan(15.0 * M_PI / 180.0) - std::tan(10.0 * M_PI / 180.0));
        EXPECT_NEAR(w.real_at(SimLayer::wind_shadow, 64, 64), expected, 2e-4) << degrees;
    }
}

TEST(WindShadow, CurvedIsLinearInAUniformWindAndFollowsABend) {
    SandWorld w;
    w.metres(SimLayer::bedrock, [](int64_t x, int64_t y) { return (x / 3 + y / 5) % 4 == 0 ? 1.5f : 0.0f; });
    w.real(SimLayer::wind_x, 4.0f);
    w.real(SimLayer::wind_y, 3.0f);
    SandParams curved;
    curved.shadow_curved = true;
    w.run({ground_pass(), wind_shadow_pass({}, 1.0)});
    const std::string linear = w.domain.hash({SimLayer::wind_shadow}).value();
    w.run(wind_shadow_pass(curved, 1.0));
    EXPECT_EQ(w.domain.hash({SimLayer::wind_shadow}).value(), linear);

    // The wind comes from the south west at first, then blows east: the wall lies upwind only along the curve.
    SandWorld bend;
    bend.metres(SimLayer::bedrock, [](int64_t x, int64_t y) { return y >= 66 && x < 62 ? 3.0f : 0.0f; });
    bend.real(SimLayer::wind_x, [](int64_t x, int64_t) { return x < 63 ? 3.0f : 5.0f; });
    bend.real(SimLayer::wind_y, [](int64_t x, int64_t) { return x < 63 ? -4.0f : 0.0f; });
    bend.run({ground_pass(), wind_shadow_pass({}, 1.0)});
    EXPECT_EQ(bend.real_at(SimLayer::wind_shadow, 64, 64), 0.0f);
    bend.run(wind_shadow_pass(curved, 1.0));
    EXPECT_EQ(bend.real_at(SimLayer::wind_shadow, 64, 64), 1.0f);
}

TEST(WindShadow, NoWindNoShadowAndAShortReachNone) {
    SandWorld w;
    w.metres(SimLayer::bedrock, [](int64_t x, int64_t) { return x % 7 == 0 ? 5.0f : 0.0f; });
    w.real(SimLayer::wind_x, 0.0f);
    w.run({ground_pass(), wind_shadow_pass({}, 1.0)});
    for (int32_t x = 0; x < 14; ++x) EXPECT_EQ(w.real_at(SimLayer::wind_shadow, x, 3), 0.0f);
    w.real(SimLayer::wind_x, 5.0f);
    w.run({ground_pass(), wind_shadow_pass({}, 20.0)}); // reach 10 m, cells of 20 m
    for (int32_t x = 0; x < 14; ++x) EXPECT_EQ(w.real_at(SimLayer::wind_shadow, x, 3), 0.0f);
}

// Wind over random cells in find_dishonest lies in (0, 1): directions of one quadrant; the others are turned by hand.
Pass turned(Pass pass, float sx, float sy) {
    return {pass.decl, [run = pass.run, sx, sy](const PassRun& r) {
                const auto flip = [&](SimLayer l, float sign) {
                    const auto v = r.domain.reals(l);
                    for (int32_t s = 0; s < r.domain.slots(); ++s)
                        for (int32_t y = v.first; y < v.last; ++y)
                            for (int32_t x = v.first; x < v.last; ++x) v(s, x, y) *= sign;
                };
                flip(SimLayer::wind_x, sx);
                flip(SimLayer::wind_y, sy);
                const Status ran = run(r);
                flip(SimLayer::wind_x, sx);
                flip(SimLayer::wind_y, sy);
                return ran;
            }};
}

TEST(WindShadow, LooksNoFurtherThanItDeclares) {
    SandParams p;
    p.shadow_length_m = 5.0f;
    for (const bool curved : {false, true})
        for (const bool bilinear : {false, true})
            for (const float sx : {-1.0f, 1.0f})
                for (const float sy : {-1.0f, 1.0f}) {
                    p.shadow_curved = curved;
                    p.bilinear = bilinear;
                    EXPECT_EQ(find_dishonest(turned(wind_shadow_pass(p, 1.0), sx, sy), k_sand_layers, 3), "")
                        << curved << bilinear << sx << sy;
                }
    EXPECT_EQ(find_dishonest(ground_pass(), k_sand_layers, 3), "");
}

TEST(WindShadow, ARadiusThatIsTooSmallIsFound) {
    SandParams p;
    p.shadow_length_m = 5.0f;
    p.shadow_min_deg = 0.0f;
    p.shadow_max_deg = 89.0f;
    Pass pass = wind_shadow_pass(p, 1.0);
    pass.decl = WindShadowPass::decl(2, false);
    EXPECT_NE(find_dishonest(turned(pass, -1.0f, -1.0f), k_sand_layers, 3), "");
    p.shadow_curved = true;
    pass = wind_shadow_pass(p, 1.0);
    pass.decl = WindShadowPass::decl(5, false);
    EXPECT_NE(find_dishonest(turned(pass, -1.0f, -1.0f), k_sand_layers, 3), "");
}

} // namespace
} // namespace sahel::test
