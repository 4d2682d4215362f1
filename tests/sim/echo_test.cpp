#include "sim/echo.h"

#include "pass_check.h"
#include "sand_world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>
#include <vector>

namespace sahel::test {
namespace {

SandParams with_echo() {
    SandParams p;
    p.echo_rate_m_per_s = 1.0f;
    return p;
}

TEST(EchoDunes, ClassesBeforeACliffOfAHundredMetres) {
    SandWorld w(256, 64);
    w.metres(SimLayer::bedrock, [](int64_t x, int64_t) { return x >= 200 ? 100.0f : 0.0f; });
    w.run({ground_pass(), cliff_pass(with_echo(), 1.0), echo_pass(with_echo(), 1.0)});
    EXPECT_EQ(w.real_at(SimLayer::cliff, 200, 50), 100.0f);
    EXPECT_EQ(w.real_at(SimLayer::cliff, 199, 50), 0.0f);
    EXPECT_EQ(w.real_at(SimLayer::cliff, 201, 50), 0.0f);
    const auto echo = [&](int32_t d) { return w.real_at(SimLayer::echo, 200 - d, 50); };
    for (int32_t d = 1; d <= 12; ++d) EXPECT_EQ(echo(d), -1.0f) << d;
    for (int32_t d = 13; d <= 16; ++d) EXPECT_EQ(echo(d), 1.0f) << d;
    EXPECT_NEAR(echo(41), 0.496f, 0.0005f);
    EXPECT_NEAR(echo(60), 0.1f, 1e-5f);
    EXPECT_EQ(echo(61), 0.0f);
    EXPECT_EQ(w.real_at(SimLayer::echo, 210, 50), 0.0f); // on top
}

TEST(EchoDunes, ALowCliffHasShortReachesAndErosionGoesFirst) {
    SandWorld w(256, 64);
    w.metres(SimLayer::bedrock, [](int64_t x, int64_t) { return x >= 200 ? 10.0f : 0.0f; });
    w.run({ground_pass(), cliff_pass(with_echo(), 1.0), echo_pass(with_echo(), 1.0)});
    EXPECT_EQ(w.real_at(SimLayer::echo, 196, 9), -1.0f);
    EXPECT_EQ(w.real_at(SimLayer::echo, 195, 9), 1.0f);
    EXPECT_NEAR(w.real_at(SimLayer::echo, 180, 9), 0.1f, 1e-5f);
    EXPECT_EQ(w.real_at(SimLayer::echo, 179, 9), 0.0f);
    // A second cliff nearer by: its eddy lies within the calm strip of the far one.
    SandWorld two(256, 64);
    two.metres(SimLayer::bedrock,
               [](int64_t x, int64_t) { return x >= 200 ? 100.0f : (x >= 180 && x < 190 ? 5.0f : 0.0f); });
    two.run({ground_pass(), cliff_pass(with_echo(), 1.0), echo_pass(with_echo(), 1.0)});
    EXPECT_EQ(two.real_at(SimLayer::echo, 179, 9), -1.0f);
    EXPECT_NEAR(two.real_at(SimLayer::echo, 177, 9), 0.975f, 1e-5f); // calmest of two: the far one says 0.871
}

// The obstacle of the published echo scenes: a half disc of radius 150 and a block behind it.
bool on_obstacle(double x, double y) {
    return std::hypot(x, y) <= 150.0 || (x > 0.0 && x < 400.0 && std::abs(y) <= 150.0);
}

// Cells before the obstacle from which the wind runs into it within three cells and stays in it for six: each must lie
// in the eddy.
int holes(const SandWorld& w, double degrees, double cx, double cy, int32_t n) {
    const double a = degrees * M_PI / 180.0;
    const auto inside = [&](int32_t x, int32_t y, int k) {
        return on_obstacle(static_cast<double>(std::lround(x + k * std::cos(a))) - cx,
                           static_cast<double>(std::lround(y + k * std::sin(a))) - cy);
    };
    int found = 0;
    for (int32_t y = 64; y < n - 64; ++y)
        for (int32_t x = 64; x < n - 64; ++x) {
            if (inside(x, y, 0)) continue;
            int hit = 1;
            while (hit <= 3 && !inside(x, y, hit)) ++hit;
            if (hit > 3) continue;
            bool stays = true;
            for (int k = hit; k < hit + 6; ++k) stays = stays && inside(x, y, k);
            if (stays && !(w.real_at(SimLayer::echo, x, y) < 0.0f)) ++found;
        }
    return found;
}

TEST(EchoDunes, NoHolesBeforeAnObstacleAtAnyWind) {
    constexpr int32_t n = 1024;
    constexpr double cx = 400.0;
    constexpr double cy = 512.0;
    SandWorld w(n, 64);
    w.metres(SimLayer::bedrock, [&](int64_t x, int64_t y) {
        return on_obstacle(static_cast<double>(x) - cx, static_cast<double>(y) - cy) ? 100.0f : 0.0f;
    });
    w.run(ground_pass());
    int nearest_holes = 0;
    for (int degrees = 0; degrees <= 90; degrees += 5) {
        const double a = degrees * M_PI / 180.0;
        w.real(SimLayer::wind_x, static_cast<float>(5.0 * std::cos(a)));
        w.real(SimLayer::wind_y, static_cast<float>(5.0 * std::sin(a)));
        SandParams p = with_echo();
        w.run({cliff_pass(p, 1.0), echo_pass(p, 1.0)});
        EXPECT_EQ(holes(w, degrees, cx, cy, n), 0) << degrees;
        if (degrees % 20 != 10) continue;
        p.bilinear = false;
        w.run({cliff_pass(p, 1.0), echo_pass(p, 1.0)});
        nearest_holes += holes(w, degrees, cx, cy, n);
    }
    EXPECT_GT(nearest_holes, 0); // what the comparison is about: nearest cells miss parts of the wall
    std::printf("holes with nearest cells: %d, bilinear: none\n", nearest_holes);
}

TEST(EchoDunes, AreNowhereWithoutARate) {
    SandWorld w;
    w.real(SimLayer::echo, 1.0f); // as published scene files carry it
    w.run(no_echo_pass());
    for (int32_t x = 0; x < 128; ++x) EXPECT_EQ(w.real_at(SimLayer::echo, x, 7), 0.0f);
}

// Random cells are all cliffs, and the nearest one decides: leaves only the highest, so that far ones matter too.
Pass among_few_cliffs(Pass pass) {
    return {pass.decl, [run = pass.run](const PassRun& r) {
                const auto cliff = r.domain.reals(SimLayer::cliff);
                std::vector<float> kept;
                for (int32_t s = 0; s < r.domain.slots(); ++s)
                    for (int32_t y = cliff.first; y < cliff.last; ++y)
                        for (int32_t x = cliff.first; x < cliff.last; ++x) {
                            kept.push_back(cliff(s, x, y));
                            if (kept.back() < 0.95f) cliff(s, x, y) = 0.0f;
                        }
                const Status ran = run(r);
                size_t i = 0;
                for (int32_t s = 0; s < r.domain.slots(); ++s)
                    for (int32_t y = cliff.first; y < cliff.last; ++y)
                        for (int32_t x = cliff.first; x < cliff.last; ++x) cliff(s, x, y) = kept[i++];
                return ran;
            }};
}

TEST(EchoDunes, LookNoFurtherThanTheyDeclare) {
    SandParams p = with_echo();
    p.echo_max_cliff_m = 1.0f; // six cells, for the random cliffs below 1 m
    p.echo_sticky_range = 6.0f;
    for (const bool curved : {false, true}) {
        p.shadow_curved = curved;
        EXPECT_EQ(find_dishonest(cliff_pass(p, 1.0), k_sand_layers, 5), "");
        EXPECT_EQ(find_dishonest(among_few_cliffs(echo_pass(p, 1.0)), k_sand_layers, 5), "");
    }
    EXPECT_EQ(find_dishonest(no_echo_pass(), k_sand_layers, 5), "");
    p.shadow_curved = false;
    Pass pass = among_few_cliffs(echo_pass(p, 1.0));
    pass.decl = EchoPass::decl(2, false);
    EXPECT_NE(find_dishonest(pass, k_sand_layers, 5), "");
}

} // namespace
} // namespace sahel::test
