#include "sim/saltation.h"

#include "pass_check.h"
#include "sand_world.h"
#include "world/cpu_features.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace sahel::test {
namespace {

constexpr SandPart k_second{}; // dt = hop = 1 s

SandParams with_echo() {
    SandParams p;
    p.echo_rate_m_per_s = 1.0f;
    return p;
}

// --- lift
// -------------------------------------------------------------------------------------------------------------

float lifted(float sand_m, float shadow, float echo, float vegetation, float moisture_m = 0.0f, float water_m = 0.0f) {
    SandWorld w(16, 8);
    w.metres(SimLayer::sand, sand_m);
    w.real(SimLayer::wind_shadow, shadow);
    w.real(SimLayer::echo, echo);
    w.real(SimLayer::vegetation, vegetation);
    w.metres(SimLayer::moisture, moisture_m);
    w.metres(SimLayer::water, water_m);
    const int64_t before = w.mass();
    w.run(lift_pass(with_echo(), k_second));
    EXPECT_EQ(w.sum(SimLayer::sand) + w.sum(SimLayer::hopping), before);
    return w.metres_at(SimLayer::hopping, 3, 3);
}

TEST(Lift, PublishedValues) {
    EXPECT_EQ(lifted(5.0f, 0.0f, 0.0f, 0.0f), 1.0f);
    EXPECT_EQ(lifted(5.0f, 0.5f, 0.0f, 0.0f), 0.5f);
    EXPECT_EQ(lifted(5.0f, 0.0f, 0.1f, 0.0f), 0.5f);  // calm
    EXPECT_EQ(lifted(5.0f, 1.0f, -1.0f, 0.0f), 1.0f); // eddy, full shelter
    EXPECT_EQ(lifted(5.0f, 0.0f, -1.0f, 0.0f), 2.0f);
    EXPECT_EQ(lifted(5.0f, 0.0f, 0.0f, 1.0f), 0.0f);
    EXPECT_EQ(lifted(0.3f, 0.0f, 0.0f, 0.0f), metres_of_ticks(ticks_of_metres(0.3f)));
    EXPECT_EQ(lifted(5.0f, 0.0f, 0.0f, -1.0f), 1.0f); // plants forbidden is not an object
}

TEST(Lift, WetAndFloodedCellsKeepTheirSand) {
    EXPECT_NEAR(lifted(5.0f, 0.0f, 0.0f, 0.0f, 0.05f), 0.5f, 1e-4f);
    EXPECT_EQ(lifted(5.0f, 0.0f, 0.0f, 0.0f, 0.101f), 0.0f);
    EXPECT_EQ(lifted(5.0f, 0.0f, -1.0f, 0.0f, 0.2f), 0.0f);
    EXPECT_NEAR(lifted(0.5f, 0.0f, 0.0f, 0.0f, 0.025f), 0.5f, 1e-4f); // half a metre holds half as much: 5 %
    EXPECT_EQ(lifted(5.0f, 0.0f, -1.0f, 0.0f, 0.0f, 0.001f), 0.0f);
    EXPECT_EQ(lifted(5.0f, 0.0f, 0.0f, 0.0f, 0.0f, 1e-5f), 1.0f); // a film is no water
}

TEST(Lift, AmountsBelowATickHappenInTheMean) {
    SandWorld w(128, 16);
    w.metres(SimLayer::sand, 1.0f);
    SandParams p;
    p.lift_rate_m_per_s = 0.3f * k_m_per_tick;
    double sum = 0.0;
    for (int64_t step = 0; step < 20; ++step) {
        w.run(lift_pass(p, {7, step, 0, 1.0f, 1.0f}));
        sum += static_cast<double>(w.sum(SimLayer::hopping));
        w.ticks(SimLayer::airborne_sand, 0);
    }
    EXPECT_NEAR(sum / (20.0 * 128 * 128), 0.3, 0.004); // 5 standard deviations
}

TEST(Lift, OnlyTheShareOfAStepHops) {
    SandWorld w(16, 8);
    w.metres(SimLayer::sand, 5.0f);
    w.metres(SimLayer::airborne_sand, 0.75f);
    w.run(lift_pass({}, {1, 0, 0, 0.25f, 0.25f}));
    EXPECT_EQ(w.metres_at(SimLayer::hopping, 2, 2), 0.25f);
    EXPECT_EQ(w.metres_at(SimLayer::airborne_sand, 2, 2), 0.75f);
    EXPECT_EQ(w.metres_at(SimLayer::sand, 2, 2), 4.75f);
}

// --- legs
// -------------------------------------------------------------------------------------------------------------

SandWorld hop_of_one(float wx, float wy, const SandParams& p, int32_t amount = 1000, int32_t at = 64) {
    SandWorld w(128, 16);
    w.real(SimLayer::wind_x, wx);
    w.real(SimLayer::wind_y, wy);
    w.ticks(SimLayer::hopping, [=](int64_t x, int64_t y) { return x == at && y == at ? amount : 0; });
    w.run(hop_leg_pass(p, HopWay::of(p, 1.0, std::hypot(wx, wy)), 0));
    return w;
}

TEST(HopLeg, SharesOfOneCell) {
    const SandWorld w = hop_of_one(0.25f, 0.5f, {});
    EXPECT_EQ(w.ticks_at(SimLayer::hopping_next, 64, 64), 375);
    EXPECT_EQ(w.ticks_at(SimLayer::hopping_next, 65, 64), 125);
    EXPECT_EQ(w.ticks_at(SimLayer::hopping_next, 64, 65), 375);
    EXPECT_EQ(w.ticks_at(SimLayer::hopping_next, 65, 65), 125);
    EXPECT_EQ(w.sum(SimLayer::hopping_next), 1000);
}

TEST(HopLeg, CrossesTheSeam) {
    const SandWorld w = hop_of_one(-0.25f, -6.5f, {}, 1000, 0);
    EXPECT_EQ(w.ticks_at(SimLayer::hopping_next, 127, 121), 125);
    EXPECT_EQ(w.ticks_at(SimLayer::hopping_next, 127, 122), 125);
    EXPECT_EQ(w.ticks_at(SimLayer::hopping_next, 0, 121), 375);
    EXPECT_EQ(w.ticks_at(SimLayer::hopping_next, 0, 122), 375);
}

TEST(HopLeg, NearestCellMovesAllOrNothing) {
    SandParams p;
    p.bilinear = false;
    EXPECT_EQ(hop_of_one(0.4f, 0.0f, p).ticks_at(SimLayer::hopping_next, 64, 64), 1000);
    EXPECT_EQ(hop_of_one(0.6f, -1.5f, p).ticks_at(SimLayer::hopping_next, 65, 62), 1000);
}

TEST(HopLeg, AFastWindIsCutIntoLegs) {
    for (const auto& [speed, legs] : {std::pair{0.0f, 1}, {5.0f, 1}, {7.0f, 1}, {7.1f, 2}, {20.0f, 3}, {60.0f, 9}}) {
        const HopWay way = HopWay::of({}, 1.0, speed);
        EXPECT_EQ(way.legs, legs) << speed;
        EXPECT_LE(way.longest, 7.0f);
        EXPECT_NEAR(way.cells_per_speed * static_cast<float>(legs), 1.0f, 1e-6f);
        HopLegPass leg;
        leg.longest = way.longest;
        EXPECT_LE(leg.radius(), k_leg_radius);
    }
    SandWorld w(128, 16);
    w.real(SimLayer::wind_x, 20.0f);
    w.ticks(SimLayer::hopping, [](int64_t x, int64_t y) { return x == 64 && y == 64 ? 900000 : 0; });
    const HopWay way = HopWay::of({}, 1.0, 20.0f);
    w.run({hop_leg_pass({}, way, 0), hop_leg_pass({}, way, 1), hop_leg_pass({}, way, 2)});
    double mean = 0.0;
    for (int32_t x = 0; x < 128; ++x) mean += x * static_cast<double>(w.ticks_at(SimLayer::hopping_next, x, 64)) / 9e5;
    EXPECT_NEAR(mean, 84.0, 1e-3);
    EXPECT_EQ(w.sum(SimLayer::hopping_next), 900000);
}

// The scatter in blocks of rows against a plain gather, over wild winds and all amounts.
TEST(HopLeg, EqualsAGatherCellByCell) {
    const RestoreMachine restore;
    const RandomStream random(11, 0, Purpose::test);
    for (const bool bilinear : {true, false})
        for (const int32_t n : {16, 200}) {
            SandParams p;
            p.bilinear = bilinear;
            const auto part = [&](int i) {
                return [&random, i](int64_t x, int64_t y) { return 14.0f * uniform(random.at(x, y).v[i]) - 7.0f; };
            };
            const auto amount = [&](int64_t x, int64_t y) {
                const Random4 r = random.at(x, y);
                return (r.v[2] & 3u) == 0 ? 0 : static_cast<int32_t>(r.v[2] >> (r.v[3] % 28u + 4u));
            };
            SandWorld w(n, 16);
            w.real(SimLayer::wind_x, part(0));
            w.real(SimLayer::wind_y, part(1));
            w.ticks(SimLayer::hopping, amount);
            const HopWay way{1, 1.0f, 7.0f};
            std::vector<int32_t> expected(static_cast<size_t>(n) * static_cast<size_t>(n), 0);
            HopLegPass f;
            f.cells_per_speed = 1.0f;
            f.longest = 7.0f;
            f.bilinear_targets = bilinear;
            for (int32_t y = 0; y < n; ++y)
                for (int32_t x = 0; x < n; ++x) {
                    const auto g = f.target(part(0)(x, y), part(1)(x, y));
                    const auto s = HopLegPass::shares(amount(x, y), g.u, g.v);
                    EXPECT_EQ(s.t[0] + s.t[1] + s.t[2] + s.t[3], amount(x, y));
                    for (int k = 0; k < 4; ++k) {
                        EXPECT_GE(s.t[k], 0);
                        const int32_t tx = (x + g.x + (k & 1) + 2 * n) % n;
                        const int32_t ty = (y + g.y + (k >> 1) + 2 * n) % n;
                        expected[static_cast<size_t>(ty * n + tx)] += s.t[k];
                    }
                }
            for (const Isa isa : {Isa::baseline, Isa::v3}) {
                set_isa(isa);
                w.run(hop_leg_pass(p, way, 0));
                int differ = 0;
                for (int32_t y = 0; y < n; ++y)
                    for (int32_t x = 0; x < n; ++x)
                        differ += w.ticks_at(SimLayer::hopping_next, x, y) != expected[static_cast<size_t>(y * n + x)];
                EXPECT_EQ(differ, 0) << name_of(isa) << bilinear << n;
            }
        }
}

// --- deposit
// ----------------------------------------------------------------------------------------------------------

struct Case {
    float sand_m = 5.0f;
    float vegetation = 0.0f;
    float shadow = 0.0f;
    float echo = 0.0f;
    int32_t object = 0;
    float soil_m = 0.0f;
    float moisture_m = 0.0f;
    float water_m = 0.0f;
};

Case with(void (*change)(Case&)) {
    Case c;
    change(c);
    return c;
}

float settled(const Case& c, const SandParams& p = with_echo()) {
    SandWorld w(16, 8);
    w.metres(SimLayer::hopping, 1.0f);
    w.metres(SimLayer::sand, c.sand_m);
    w.metres(SimLayer::soil, c.soil_m);
    w.metres(SimLayer::moisture, c.moisture_m);
    w.metres(SimLayer::water, c.water_m);
    w.real(SimLayer::vegetation, c.vegetation);
    w.real(SimLayer::wind_shadow, c.shadow);
    w.real(SimLayer::echo, c.echo);
    w.ticks(SimLayer::object, c.object);
    const float before = w.metres_at(SimLayer::sand, 4, 4);
    w.run(deposit_pass(p, 1.0, k_second, 0));
    EXPECT_EQ(w.sum(SimLayer::sand) + w.sum(SimLayer::airborne_sand),
              256 * (int64_t{ticks_of_metres(c.sand_m)} + 131072));
    return w.metres_at(SimLayer::sand, 4, 4) - before;
}

TEST(Deposit, PublishedTable) {
    constexpr float k_tick = 1.1e-5f;
    EXPECT_NEAR(settled({}), 0.6f, k_tick);
    EXPECT_NEAR(settled(with([](Case& c) { c.vegetation = 0.5f; })), 0.8f, k_tick);
    EXPECT_NEAR(settled(with([](Case& c) { c.vegetation = 1.0f; })), 1.0f, k_tick);
    EXPECT_NEAR(settled(with([](Case& c) { c.sand_m = 0.0f; })), 0.4f, k_tick);
    EXPECT_NEAR(settled(with([](Case& c) {
                    c.sand_m = 0.0f;
                    c.vegetation = 0.5f;
                })),
                0.7f, k_tick);
    EXPECT_NEAR(settled(with([](Case& c) {
                    c.sand_m = 0.0f;
                    c.vegetation = 1.0f;
                })),
                1.0f, k_tick);
    EXPECT_NEAR(settled(with([](Case& c) {
                    c.sand_m = 0.0f;
                    c.soil_m = 2.0f;
                })),
                0.5f, k_tick);
    EXPECT_EQ(settled(with([](Case& c) { c.object = 1; })), 0.0f);
    EXPECT_EQ(settled(with([](Case& c) {
                  c.shadow = 1.0f;
                  c.object = 1;
              })),
              0.0f);
    EXPECT_EQ(settled(with([](Case& c) { c.echo = -1.0f; })), 0.0f);
    EXPECT_EQ(settled(with([](Case& c) {
                  c.shadow = 1.0f;
                  c.echo = -1.0f;
              })),
              0.0f);
    EXPECT_NEAR(settled(with([](Case& c) { c.shadow = 0.9f; })), 0.9f, k_tick);
    EXPECT_EQ(settled(with([](Case& c) { c.echo = 1.0f; })), 1.0f);
    EXPECT_NEAR(settled(with([](Case& c) { c.echo = 0.3f; })), 0.6f, k_tick);
}

TEST(Deposit, WetGroundTakesLittle) {
    EXPECT_NEAR(settled(with([](Case& c) { c.moisture_m = 0.05f; })), 0.3f, 2e-5f);
    EXPECT_NEAR(settled(with([](Case& c) { c.moisture_m = 1.0f; })), 0.006f, 2e-5f);
    EXPECT_NEAR(settled(with([](Case& c) { c.water_m = 0.5f; })), 0.01f, 2e-5f);
    EXPECT_NEAR(settled(with([](Case& c) {
                    c.shadow = 1.0f;
                    c.water_m = 0.5f;
                })),
                0.01f, 2e-5f);
}

TEST(Deposit, TheThresholdOfThinSand) {
    SandParams p = with_echo();
    EXPECT_NEAR(settled(with([](Case& c) { c.sand_m = 0.02f; }), p), 0.6f, 2e-5f);
    p.bounce_threshold_m = 0.025f;
    EXPECT_NEAR(settled(with([](Case& c) { c.sand_m = 0.02f; }), p), 0.4f, 2e-5f);
}

// Flat and endless sand: 50 steps of one hop each (check 3), and the same time in other lengths of step.
TEST(Saltation, AFlatSheetTendsToItsSteadyState) {
    for (const float dt : {1.0f, 0.5f, 0.1f}) {
        SandWorld w(16, 16);
        w.metres(SimLayer::sand, 10.0f);
        const SandParams p;
        const HopWay way = HopWay::of(p, 1.0, 5.0f);
        const int steps = static_cast<int>(std::lround(50.0f / dt));
        for (int64_t step = 0; step < steps; ++step) {
            const SandPart part{1, step, 0, dt, dt};
            w.run({ground_pass(), wind_shadow_pass(p, 1.0), lift_pass(p, part), hop_leg_pass(p, way, 0),
                   deposit_pass(p, 1.0, part, 1)});
            if (step + 2 < steps) continue;
            // S before the hop is rate hop / P; what hops of it in this step, by seconds, is the flux per metre of way.
            EXPECT_NEAR(w.real_at(SimLayer::bounce, 5, 5), 1.66667f, 0.002f) << dt;
        }
        const float air = w.metres_at(SimLayer::airborne_sand, 5, 5);
        EXPECT_NEAR(air, 1.66667f - dt, 0.001f) << dt; // dt = 1: 0.6667
        EXPECT_NEAR(10.0f - w.metres_at(SimLayer::sand, 5, 5), air, 1e-5f);
        for (int32_t y = 0; y < 16; ++y)
            for (int32_t x = 0; x < 16; ++x)
                EXPECT_NEAR(w.metres_at(SimLayer::sand, x, y), w.metres_at(SimLayer::sand, 5, 5), 1e-4f);
        EXPECT_EQ(w.mass(), 256 * int64_t{10 * 131072});
    }
}

// --- wear
// -------------------------------------------------------------------------------------------------------------

SandWorld worn(const SandParams& p, float dt, const std::function<float(int64_t, int64_t)>& rock,
               float resistance = 0.0f, float soil_m = 0.0f) {
    SandWorld w(64, 8);
    w.metres(SimLayer::bedrock, rock);
    w.metres(SimLayer::soil, soil_m);
    w.metres(SimLayer::hopping, 0.5f);
    w.real(SimLayer::resistance, resistance);
    const int64_t before = w.mass() + w.sum(SimLayer::hopping);
    w.run({ground_pass(), deposit_pass(p, 1.0, {3, 0, 0, dt, dt}, 0)});
    EXPECT_EQ(w.mass(), before);
    return w;
}

TEST(Abrasion, FollowsTheTwoPublishedForms) {
    SandParams p;
    p.abrasion = 0.01f;
    const auto flat = [](int64_t, int64_t) { return 3.0f; };
    // k |w| (1 - P) S': 0.01 * 5 * 0.6 * 0.5
    EXPECT_NEAR(3.0f - worn(p, 1.0f, flat).metres_at(SimLayer::bedrock, 9, 9), 0.015f, 1e-5f);
    EXPECT_NEAR(3.0f - worn(p, 1.0f, flat, 0.75f).metres_at(SimLayer::bedrock, 9, 9), 0.00375f, 1e-5f);
    // The same sand in half the time wears the same; the form without amounts wears by time.
    EXPECT_NEAR(3.0f - worn(p, 0.5f, flat).metres_at(SimLayer::bedrock, 9, 9), 0.015f, 1e-5f);
    p.abrasion_by_amount = false;
    EXPECT_NEAR(3.0f - worn(p, 1.0f, flat).metres_at(SimLayer::bedrock, 9, 9), 0.03f, 1e-5f);
    EXPECT_NEAR(3.0f - worn(p, 0.5f, flat).metres_at(SimLayer::bedrock, 9, 9), 0.015f, 1e-5f);
    // Soil protects the rock and wears itself, by half its grains' bounce.
    p.soil_abrasion = 0.02f;
    const SandWorld w = worn(p, 1.0f, flat, 0.0f, 1.0f);
    EXPECT_EQ(w.metres_at(SimLayer::bedrock, 9, 9), 3.0f);
    EXPECT_NEAR(1.0f - w.metres_at(SimLayer::soil, 9, 9), 0.05f, 1e-5f);
}

TEST(Abrasion, SlowWearHappensInTheMean) {
    SandParams p;
    p.abrasion = 1e-6f;
    const SandWorld w = worn(p, 1.0f, [](int64_t, int64_t) { return 3.0f; });
    // 1e-6 * 5 * 0.6 * 0.5 m = 0.1966 ticks in the mean of 4096 cells
    const double mean = static_cast<double>(3 * 131072LL * 4096 - w.sum(SimLayer::bedrock)) / 4096.0;
    EXPECT_NEAR(mean, 0.1966, 0.031); // 5 standard deviations
}

TEST(Abrasion, DigsNoHoleDeeperThanACellIsWide) {
    SandParams p;
    p.abrasion = 10.0f;
    const auto pit = [](float depth) {
        return [depth](int64_t x, int64_t y) { return x % 8 == 4 && y % 8 == 4 ? 10.0f - depth : 10.0f; };
    };
    EXPECT_EQ(worn(p, 1.0f, pit(1.5f)).metres_at(SimLayer::bedrock, 4, 4), 8.5f);
    EXPECT_EQ(worn(p, 1.0f, pit(0.75f)).metres_at(SimLayer::bedrock, 4, 4), 9.0f);
    EXPECT_EQ(worn(p, 1.0f, pit(0.0f)).metres_at(SimLayer::bedrock, 4, 4), 9.0f);
}

// --- honesty
// ----------------------------------------------------------------------------------------------------------

TEST(Saltation, LooksNoFurtherThanItDeclares) {
    SandParams wears = with_echo();
    wears.abrasion = 0.01f;
    wears.soil_abrasion = 0.01f;
    const HopWay way{1, 3.0f, 2.5f};
    for (const SandParams& p : {SandParams{}, with_echo(), wears})
        for (const Pass& pass :
             {lift_pass(p, k_second), lift_pass(p, {1, 0, 0, 0.001f, 0.001f}), hop_leg_pass(p, way, 0),
              hop_leg_pass(p, way, 1), deposit_pass(p, 1.0, k_second, 0), deposit_pass(p, 1.0, k_second, 1)})
            EXPECT_EQ(find_dishonest(pass, k_sand_layers, 9), "") << pass.decl.name;
}

TEST(Saltation, ARadiusThatIsTooSmallIsFound) {
    Pass leg = hop_leg_pass({}, {1, 3.0f, 2.5f}, 0);
    leg.decl = HopLegPass::decl(SimLayer::hopping, SimLayer::hopping_next, 1);
    EXPECT_NE(find_dishonest(leg, k_sand_layers, 9), "");
}

// --- flows across borders
// ---------------------------------------------------------------------------------------------

TEST(Saltation, EveryTickThatCrossesABorderIsCounted) {
    SandWorld w(32, 8, 2);
    w.real(SimLayer::wind_x, [](int64_t x, int64_t) { return 4.0f + 0.1f * static_cast<float>(x % 7); });
    w.real(SimLayer::wind_y, -3.3f);
    w.ticks(SimLayer::hopping,
            [](int64_t x, int64_t y) { return static_cast<int32_t>(1000 + (37 * x + 11 * y) % 999); });
    ASSERT_TRUE(w.domain.keep_flows().ok());
    const auto before = w.domain.sums(SimLayer::hopping).value();
    w.run(hop_leg_pass({}, HopWay::of({}, 1.0, 7.0f), 0));
    const auto after = w.domain.sums(SimLayer::hopping_next).value();
    const auto flows = w.domain.flows(SimLayer::airborne_sand).value();
    for (size_t slot = 0; slot < 4; ++slot) {
        int64_t out = 0;
        for (const int64_t f : flows[slot]) out += f;
        EXPECT_EQ(before[slot] - after[slot], out) << slot;
        EXPECT_NE(flows[slot][0], 0);
        EXPECT_NE(flows[slot][6], 0);
    }
}

} // namespace
} // namespace sahel::test
