#include "pass_check.h"
#include "sand_world.h"
#include "sim/echo.h"
#include "sim/reptation.h"
#include "sim/saltation.h"
#include "sim/wind_shadow.h"
#include "world/cpu_features.h"
#include "world/det_math.h"

#include <gtest/gtest.h>

#include <array>

// On the host some passes work on pieces of rows; CUDA, and passes without such a form, run the functor cell by cell.
// Both must give the same bits, whatever the width of a row and the instruction set.
namespace sahel::test {
namespace {

constexpr int32_t k_width = 77; // no multiple of any piece

float noise(int64_t x, int64_t y, uint32_t which) {
    return uniform(RandomStream(31, which, Purpose::test).at(x, y).v[0]);
}

// Dunes, thin sand, damp and flooded ground, plants, objects, cliffs, gusts: every branch is taken somewhere.
void put_everything(SandWorld& w) {
    w.metres(SimLayer::bedrock,
             [](int64_t x, int64_t y) { return 3.0f * noise(x / 9, y / 7, 1) + (x % 29 < 6 ? 4.0f : 0.0f); });
    w.metres(SimLayer::soil,
             [](int64_t x, int64_t y) { return noise(x / 5, y / 5, 2) < 0.4f ? noise(x, y, 3) : 0.0f; });
    w.ticks(SimLayer::sand, [](int64_t x, int64_t y) {
        const float kind = noise(x / 4, y / 4, 4);
        const float some = noise(x, y, 5);
        return kind < 0.3f ? 0 : kind < 0.5f ? static_cast<int32_t>(some * 2000.0f) : ticks_of_metres(2.0f * some);
    });
    w.ticks(SimLayer::water, [](int64_t x, int64_t y) {
        return noise(x / 6, y / 6, 6) < 0.15f ? static_cast<int32_t>(3.0f * noise(x, y, 7)) : 0;
    });
    w.ticks(SimLayer::moisture, [](int64_t x, int64_t y) {
        return noise(x / 6, y / 6, 8) < 0.3f ? static_cast<int32_t>(20000.0f * noise(x, y, 9)) : 0;
    });
    w.ticks(SimLayer::airborne_sand, [](int64_t x, int64_t y) {
        return noise(x / 8, y / 8, 10) < 0.5f ? static_cast<int32_t>(3000.0f * noise(x, y, 11)) : 90000;
    });
    w.ticks(SimLayer::hopping, [](int64_t x, int64_t y) {
        return noise(x / 8, y / 8, 12) < 0.5f ? static_cast<int32_t>(2000.0f * noise(x, y, 13)) : 140000;
    });
    w.ticks(SimLayer::object, [](int64_t x, int64_t y) { return noise(x / 5, y / 5, 14) < 0.1f ? 1 : 0; });
    w.real(SimLayer::vegetation, [](int64_t x, int64_t y) { return 1.2f * noise(x / 7, y / 7, 15) - 0.2f; });
    w.real(SimLayer::resistance, [](int64_t x, int64_t y) { return noise(x, y, 16); });
    w.real(SimLayer::wind_shadow,
           [](int64_t x, int64_t y) { return det::clamp(3.0f * noise(x, y, 17) - 1.0f, 0.0f, 1.0f); });
    w.real(SimLayer::echo, [](int64_t x, int64_t y) {
        const float v = noise(x / 6, y / 6, 18);
        return v < 0.2f ? -1.0f : v < 0.4f ? noise(x, y, 19) : 0.0f;
    });
    w.real(SimLayer::cliff,
           [](int64_t x, int64_t y) { return noise(x, y, 20) > 0.98f ? 9.0f * noise(x, y, 21) : 0.0f; });
    w.real(SimLayer::bounce, [](int64_t x, int64_t y) { return 2.0f * noise(x, y, 22); });
    // One half is smooth, the other wild; some cells are still.
    const auto wind = [](uint32_t which) {
        return [which](int64_t x, int64_t y) {
            const float smooth =
                4.0f + 2.0f * det::sin(0.05f * static_cast<float>(x + 3 * y) + static_cast<float>(which));
            const float wild = 14.0f * noise(x, y, 23 + which) - 7.0f;
            return x < k_width / 2 ? smooth : noise(x / 3, y / 3, 25) < 0.1f ? 0.0f : wild;
        };
    };
    w.real(SimLayer::wind_x, wind(0));
    w.real(SimLayer::wind_y, wind(1));
}

// A launch of the functor as it is.
template <class F> Pass cell_by_cell(const Pass& pass, F make) {
    return {pass.decl, [make](const PassRun& r) -> Status {
                launch(r.launch, make(r.domain));
                return {};
            }};
}

std::string hash_of(const Pass& pass) {
    SandWorld w(k_width, 24);
    put_everything(w);
    if (pass.decl.read_set().contains(SimLayer::surface)) w.run(ground_pass());
    w.run(pass);
    return w.domain.hash(pass.decl.writes).value();
}

void expect_same(const Pass& rows, const Pass& cells, const std::string& what) {
    const RestoreMachine restore;
    const std::string expected = hash_of(cells);
    for (const Isa isa : {Isa::baseline, Isa::v3}) {
        set_isa(isa);
        EXPECT_EQ(hash_of(rows), expected) << what << ' ' << name_of(isa);
    }
}

TEST(SandRows, WindShadow) {
    for (const float length : {3.0f, 10.0f, 20.0f}) {
        SandParams p;
        p.shadow_length_m = length;
        const Pass pass = wind_shadow_pass(p, 1.0);
        expect_same(pass,
                    cell_by_cell(pass,
                                 [length](TileDomain& d) {
                                     const TileDomain& c = d;
                                     const det::SinCos a = det::sincos(10.0f * (det::k_pi / 180.0f));
                                     const det::SinCos b = det::sincos(15.0f * (det::k_pi / 180.0f));
                                     return WindShadowPass{c.ints(SimLayer::surface),
                                                           c.reals(SimLayer::wind_x),
                                                           c.reals(SimLayer::wind_y),
                                                           d.reals(SimLayer::wind_shadow),
                                                           static_cast<int32_t>(length),
                                                           1.0f,
                                                           a.sin / a.cos,
                                                           b.sin / b.cos - a.sin / a.cos,
                                                           false,
                                                           true};
                                 }),
                    "shadow");
    }
}

TEST(SandRows, Echo) {
    SandParams p;
    p.echo_rate_m_per_s = 0.7f;
    p.echo_max_cliff_m = 8.0f;
    const Pass pass = echo_pass(p, 1.0);
    const auto cells = cell_by_cell(pass, [](TileDomain& d) {
        const TileDomain& c = d;
        return EchoPass{c.reals(SimLayer::cliff),
                        c.reals(SimLayer::wind_x),
                        c.reals(SimLayer::wind_y),
                        d.reals(SimLayer::echo),
                        16,
                        1.0f,
                        0.7f,
                        0.4f,
                        2.0f,
                        8.0f,
                        false,
                        true};
    });
    expect_same(pass, cells, "echo");
}

TEST(SandRows, Lift) {
    for (const float echo_rate : {0.0f, 1.0f})
        for (const float share : {1.0f, 0.01f}) {
            SandParams p;
            p.echo_rate_m_per_s = echo_rate;
            const Pass pass = lift_pass(p, {3, 4, 1, share, share});
            expect_same(pass,
                        cell_by_cell(pass,
                                     [=](TileDomain& d) {
                                         const TileDomain& c = d;
                                         return LiftPass{c.ints(SimLayer::soil),
                                                         c.ints(SimLayer::water),
                                                         c.ints(SimLayer::moisture),
                                                         c.reals(SimLayer::wind_shadow),
                                                         c.reals(SimLayer::vegetation),
                                                         c.reals(SimLayer::echo),
                                                         d.ints(SimLayer::sand),
                                                         d.ints(SimLayer::airborne_sand),
                                                         d.ints(SimLayer::hopping),
                                                         c.places(),
                                                         RandomStream(3, 4, Purpose::saltation, 2),
                                                         {1.0f, k_m_per_tick},
                                                         share * k_ticks_per_m,
                                                         share * k_ticks_per_m,
                                                         share,
                                                         echo_rate > 0.0f};
                                     }),
                        "lift");
        }
}

TEST(SandRows, DepositAndWear) {
    for (const float echo_rate : {0.0f, 1.0f})
        for (const float wear : {0.0f, 0.01f})
            for (const bool by_amount : {true, false}) {
                SandParams p;
                p.echo_rate_m_per_s = echo_rate;
                p.abrasion = wear;
                p.soil_abrasion = 2.0f * wear;
                p.abrasion_by_amount = by_amount;
                const Pass pass = deposit_pass(p, 1.0, {3, 4, 0, 0.5f, 0.5f}, 0);
                expect_same(pass,
                            cell_by_cell(pass,
                                         [=](TileDomain& d) {
                                             const TileDomain& c = d;
                                             DepositPass f;
                                             f.arrived = c.ints(SimLayer::hopping);
                                             f.water = c.ints(SimLayer::water);
                                             f.moisture = c.ints(SimLayer::moisture);
                                             f.object = c.ints(SimLayer::object);
                                             f.surface = c.ints(SimLayer::surface);
                                             f.shadow = c.reals(SimLayer::wind_shadow);
                                             f.vegetation = c.reals(SimLayer::vegetation);
                                             f.echo = c.reals(SimLayer::echo);
                                             f.resistance = c.reals(SimLayer::resistance);
                                             f.wind_x = c.reals(SimLayer::wind_x);
                                             f.wind_y = c.reals(SimLayer::wind_y);
                                             f.bedrock = d.ints(SimLayer::bedrock);
                                             f.soil = d.ints(SimLayer::soil);
                                             f.sand = d.ints(SimLayer::sand);
                                             f.airborne = d.ints(SimLayer::airborne_sand);
                                             f.bounce = d.reals(SimLayer::bounce);
                                             f.places = c.places();
                                             f.random = RandomStream(3, 4, Purpose::saltation, 1);
                                             f.random_wear = RandomStream(3, 4, Purpose::abrasion, 0);
                                             f.wet = {1.0f, k_m_per_tick};
                                             f.bounce_threshold = 0;
                                             f.abrasion_threshold = ticks_of_metres(0.025f);
                                             f.cell_ticks = ticks_of_metres(1.0f);
                                             f.per_second = k_m_per_tick / 0.5f;
                                             f.wear = wear * (by_amount ? 1.0f : 0.5f * k_ticks_per_m);
                                             f.soil_wear = 2.0f * wear * (by_amount ? 1.0f : 0.5f * k_ticks_per_m);
                                             f.by_amount = by_amount;
                                             f.echoes = echo_rate > 0.0f;
                                             f.wears = wear > 0.0f;
                                             return f;
                                         }),
                            "deposit");
            }
}

TEST(SandRows, Smoothing) {
    SandParams p;
    p.reptation_smooth = 0.2f;
    p.reptation_smooth_wind_s_per_m = 0.1f;
    const Pass pass = smooth_pass(p, 1.0, 0.5f);
    const auto cells = cell_by_cell(pass, [](TileDomain& d) {
        const TileDomain& c = d;
        SmoothPass f;
        f.bedrock = c.ints(SimLayer::bedrock);
        f.soil = c.ints(SimLayer::soil);
        f.sand = c.ints(SimLayer::sand);
        f.bounce = c.reals(SimLayer::bounce);
        f.wind_x = c.reals(SimLayer::wind_x);
        f.wind_y = c.reals(SimLayer::wind_y);
        f.change = d.ints(SimLayer::surface);
        f.strength = 0.5f * 0.2f * 0.5f;
        f.wind_strength = 0.25f * 0.1f * 0.5f;
        f.cell_m = 1.0f;
        f.most = k_most_smoothing;
        f.by_wind = true;
        return f;
    });
    expect_same(pass, cells, "smoothing");
}

} // namespace
} // namespace sahel::test
