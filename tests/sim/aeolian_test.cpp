#include "sim/aeolian.h"

#include "pass_check.h"
#include "world/cuda_runtime.h"
#include "world/det_math.h"
#include "world/field.h"
#include "world/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace sahel::test {
namespace {

// A landscape with everything in it, of side x side cells: sand on humps of rock and a plateau, soil, a pond, damp
// ground, plants, a solid object. A function of the world cell alone.
struct Landscape {
    int32_t side;
    float sand_m = 0.5f;
    bool wet = true;

    [[nodiscard]] float wave(int64_t c, int64_t waves, float phase = 0.0f) const {
        return det::sin(6.2831853f * static_cast<float>(c * waves % side) / static_cast<float>(side) + phase);
    }
    [[nodiscard]] bool object(int64_t x, int64_t y) const {
        return x > side / 2 && x < side / 2 + 12 && y > side / 4 && y < side / 4 + 30;
    }
    [[nodiscard]] int32_t ticks(SimLayer l, int64_t x, int64_t y) const {
        const Random4 r = RandomStream(77, static_cast<int64_t>(l), Purpose::test).at(x, y);
        switch (l) {
        case SimLayer::bedrock:
            return ticks_of_metres(20.0f + 4.0f * wave(x, 3) * wave(y, 2) + (object(x, y) ? 9.0f : 0.0f) +
                                   (wave(x, 2, 1.0f) > 0.9f ? 6.0f : 0.0f));
        case SimLayer::soil:
            return wet && wave(x + y, 2) > 0.6f ? ticks_of_metres(0.7f) : 0;
        case SimLayer::sand:
            return object(x, y) ? 0 : ticks_of_metres(sand_m * (1.0f + 2.0f * uniform(r.v[0])));
        case SimLayer::water:
            return wet && wave(x, 2) + wave(y, 2) < -1.6f ? ticks_of_metres(0.8f) : 0;
        case SimLayer::moisture:
            return wet && wave(x, 2) + wave(y, 2) < -1.0f ? ticks_of_metres(0.08f * uniform(r.v[0])) : 0;
        case SimLayer::object:
            return object(x, y);
        default:
            return 0;
        }
    }
    [[nodiscard]] float real(SimLayer l, int64_t x, int64_t y) const {
        const float w = wave(x, 5) * wave(y, 4);
        return l == SimLayer::vegetation && w > 0.5f ? w : l == SimLayer::resistance ? 0.5f + 0.5f * w : 0.0f;
    }
    void put(TileDomain& d) const {
        for (const SimLayer l : {SimLayer::bedrock, SimLayer::soil, SimLayer::sand, SimLayer::water, SimLayer::moisture,
                                 SimLayer::airborne_sand, SimLayer::object})
            EXPECT_TRUE(d.fill(l, [&](int64_t x, int64_t y) { return ticks(l, x, y); }).ok());
        for (const SimLayer l : {SimLayer::vegetation, SimLayer::resistance})
            EXPECT_TRUE(d.fill(l, [&](int64_t x, int64_t y) { return real(l, x, y); }).ok());
    }
};

const SimLayerSet k_moved{SimLayer::bedrock, SimLayer::soil, SimLayer::sand, SimLayer::airborne_sand};
const SimLayerSet k_hashed{SimLayer::bedrock, SimLayer::soil,   SimLayer::sand, SimLayer::airborne_sand,
                           SimLayer::wind_x,  SimLayer::wind_y, SimLayer::echo, SimLayer::wind_shadow,
                           SimLayer::bounce,  SimLayer::repose};

int64_t mass_of(const TileDomain& d) {
    int64_t sum = 0;
    k_moved.for_each([&](SimLayer l) {
        for (const int64_t s : d.sums(l).value()) sum += s;
    });
    return sum;
}

// Every pass at work, within halos of 8 cells: cells of 2 m, shelter within 10 m, cliffs up to 6 m.
Aeolian::Desc everything() {
    Aeolian::Desc d;
    d.cell_m = 2.0;
    d.seed = 5;
    d.wind.speed_m_per_s = 9.0f;
    d.wind.angle_deg = 25.0f;
    d.wind.epoch_steps = 4;
    d.wind.bidirectional = true;
    d.wind.period_s = 3.0f;
    d.sand.echo_rate_m_per_s = 0.5f;
    d.sand.echo_max_cliff_m = 6.0f;
    d.sand.abrasion = 0.005f;
    d.sand.soil_abrasion = 0.01f;
    d.sand.reptation_smooth = 0.3f;
    d.sand.reptation_smooth_wind_s_per_m = 0.1f;
    d.sand.reptation_repose_s2_per_m2 = 0.05f;
    d.sand.reptation_shadowed = true;
    d.sand.avalanche_sweeps = 6;
    d.sand.supply = true;
    d.sand.supply_target = 0.995f;
    d.sand.supply_radius_cells = 40;
    d.sand.supply_every_steps = 3;
    d.sand.step_s = 0.75f;
    return d;
}

struct Outcome {
    std::string hash;
    int64_t mass = 0;
    std::vector<SupplyAccount> supplied;
};

Outcome run(const Aeolian::Desc& desc, const Landscape& land, const RunWay& way, int64_t steps,
            MemoryPool& pool = MemoryPool::host()) {
    TileDomain d = make_periodic(land.side, way, Aeolian::layers(desc), pool);
    land.put(d);
    auto aeolian = Aeolian::create(desc, d);
    EXPECT_TRUE(aeolian.ok()) << aeolian.error().message;
    for (int64_t step = 0; step < steps; ++step) {
        const Status ran = aeolian->step(d, step);
        EXPECT_TRUE(ran.ok()) << ran.error().message;
    }
    return {d.hash(k_hashed).value(), mass_of(d), aeolian->supplied()};
}

TEST(Aeolian, SameBitsForAnyTilingHaloThreadsOrderAndInstructionSet) {
    const RestoreMachine restore;
    const Landscape land{long_tests() ? 1024 : 512};
    const int64_t steps = long_tests() ? 8 : 5;
    std::string expected;
    int64_t mass = 0;
    int ways = 0;
    for (const RunWay& way : run_ways(land.side, !long_tests())) {
        if (!long_tests() && ways > 0 && (way.tile_cells == 256 || (way.tile_cells == 512 && way.halo == 16)))
            continue; // the smallest tiles and the whole, each with narrow and wide halos
        const Outcome r = run(everything(), land, way, steps);
        if (ways++ == 0) {
            expected = r.hash;
            mass = r.mass;
        }
        EXPECT_EQ(r.hash, expected) << text_of(way);
        EXPECT_EQ(r.mass, mass) << text_of(way);
    }
    EXPECT_GE(ways, long_tests() ? 36 : 6);
    // The same from every compiler: g++ 12 and clang++ 14 gave it. A change of the model changes it, on purpose.
    if (!long_tests()) {
        EXPECT_EQ(expected, "ac3b71790b66cb96398cf4db5780bae2");
    }
    std::printf("%d ways, hash %s\n", ways, expected.c_str());
}

TEST(Aeolian, CudaGivesTheSameHash) {
#if SAHEL_HAS_CUDA
    if (!cuda::available()) GTEST_SKIP() << "no CUDA device: " << cuda::status().why_not;
    const RestoreMachine restore;
    const Landscape land{512};
    const Outcome host = run(everything(), land, {.tile_cells = 256, .halo = 16}, 8);
    MemoryPool pool("test device", MemoryKind::cuda, uint64_t{2} << 30);
    for (const RunWay& way :
         {RunWay{.tile_cells = 512, .halo = 16, .device = true}, RunWay{.tile_cells = 128, .halo = 8, .device = true}})
        EXPECT_EQ(run(everything(), land, way, 8, pool).hash, host.hash) << text_of(way);
#else
    GTEST_SKIP() << "built without a CUDA compiler";
#endif
}

Aeolian::Desc scene_a() {
    Aeolian::Desc d;
    d.sand.avalanche_sweeps = 8;
    return d;
}

std::vector<std::pair<std::string, Aeolian::Desc>> parameter_sets() {
    std::vector<std::pair<std::string, Aeolian::Desc>> sets;
    sets.emplace_back("scene A", scene_a());
    sets.back().second.sand.reptation_smooth = 1.0f;
    sets.emplace_back("everything", everything());
    sets.back().second.sand.supply = false;
    sets.emplace_back("storm", scene_a());
    sets.back().second.wind.speed_m_per_s = 40.0f;
    sets.back().second.sand.abrasion = 0.1f;
    sets.back().second.sand.reptation_smooth_wind_s_per_m = 5.0f;
    sets.emplace_back("short steps", scene_a());
    sets.back().second.sand.step_s = 0.1f;
    sets.emplace_back("long steps", scene_a());
    sets.back().second.sand.step_s = 3.5f;
    return sets;
}

TEST(Aeolian, NoTickIsLostNoSandNegativeNoNumberMissing) {
    for (const auto& [name, desc] : parameter_sets()) {
        const Landscape land{64};
        TileDomain d = make_periodic(64, {.tile_cells = 64, .halo = 16, .v3 = true}, Aeolian::layers(desc));
        land.put(d);
        const int64_t start = mass_of(d);
        Aeolian aeolian = Aeolian::create(desc, d).value();
        for (int64_t step = 0; step < 200; ++step) {
            const Status ran = aeolian.step(d, step);
            ASSERT_TRUE(ran.ok()) << name << ": " << ran.error().message;
        }
        EXPECT_EQ(mass_of(d), start) << name;
        int bad = 0;
        for (int32_t y = 0; y < 64; ++y)
            for (int32_t x = 0; x < 64; ++x) {
                bad += std::as_const(d).ints(SimLayer::sand)(0, x, y) < 0;
                bad += std::as_const(d).ints(SimLayer::soil)(0, x, y) < 0;
                bad += std::as_const(d).ints(SimLayer::airborne_sand)(0, x, y) < 0;
                for (const SimLayer l :
                     {SimLayer::wind_x, SimLayer::wind_y, SimLayer::wind_shadow, SimLayer::bounce, SimLayer::repose})
                    bad += !std::isfinite(std::as_const(d).reals(l)(0, x, y));
            }
        EXPECT_EQ(bad, 0) << name;
        std::printf("%-12s %d parts, %d legs, %d sweeps, wind up to %.1f m/s\n", name.c_str(), aeolian.stats().parts,
                    aeolian.stats().legs, aeolian.stats().sand.sweeps,
                    static_cast<double>(aeolian.stats().max_wind_m_per_s));
    }
}

TEST(Aeolian, SupplyIsAccountedForToTheTick) {
    for (const bool removes : {false, true}) {
        Aeolian::Desc desc = everything();
        desc.sand.supply_removes = removes;
        desc.sand.supply_uniform = true;
        desc.sand.supply_target = removes ? 0.2f : 1.0f;
        desc.sand.supply_remove_m = 0.2f;
        const Landscape land{256};
        TileDomain d = make_periodic(256, {.tile_cells = 128, .halo = 16}, Aeolian::layers(desc));
        land.put(d);
        std::vector<int64_t> start(4, 0);
        const int64_t before = mass_of(d);
        Aeolian aeolian = Aeolian::create(desc, d).value();
        for (int64_t step = 0; step < 10; ++step) ASSERT_TRUE(aeolian.step(d, step).ok());
        int64_t added = 0;
        int64_t removed = 0;
        for (const SupplyAccount& a : aeolian.supplied()) {
            added += a.added_ticks;
            removed += a.removed_ticks;
        }
        EXPECT_EQ(mass_of(d), before + added - removed);
        EXPECT_GT(removes ? removed : added, 0);
        EXPECT_EQ(removes ? added : removed, 0);
        EXPECT_GT(aeolian.stats().coverage, 0.2);
    }
}

// What each tile gains is what came in over its borders.
TEST(Aeolian, FlowsOfEveryTileCloseToZero) {
    Aeolian::Desc desc = everything();
    desc.sand.supply = false;
    const Landscape land{256};
    TileDomain d = make_periodic(256, {.tile_cells = 128, .halo = 16}, Aeolian::layers(desc));
    land.put(d);
    ASSERT_TRUE(d.keep_flows().ok());
    const auto masses = [&] {
        std::vector<int64_t> m(4, 0);
        k_moved.for_each([&](SimLayer l) {
            const auto sums = d.sums(l).value();
            for (size_t i = 0; i < 4; ++i) m[i] += sums[i];
        });
        return m;
    };
    const std::vector<int64_t> before = masses();
    Aeolian aeolian = Aeolian::create(desc, d).value();
    for (int64_t step = 0; step < 6; ++step) ASSERT_TRUE(aeolian.step(d, step).ok());
    const std::vector<int64_t> after = masses();
    for (size_t i = 0; i < 4; ++i) {
        int64_t out = 0;
        k_moved.for_each([&](SimLayer l) {
            const auto flows = d.flows(l).value();
            for (const int64_t f : flows[i]) out += f;
        });
        EXPECT_EQ(before[i] - after[i], out) << i;
    }
}

TEST(Aeolian, ARunThatStopsWithinAnEpochGoesOnAsIfItHadNot) {
    const Aeolian::Desc desc = everything();
    const Landscape land{256};
    const RunWay way{.tile_cells = 128, .halo = 16};
    const std::string whole = run(desc, land, way, 9).hash;
    TileDomain d = make_periodic(256, way, Aeolian::layers(desc));
    land.put(d);
    std::vector<uint8_t> wind;
    {
        Aeolian first = Aeolian::create(desc, d).value();
        for (int64_t step = 0; step < 6; ++step) ASSERT_TRUE(first.step(d, step).ok());
        wind = first.wind().save();
    }
    // The conserved layers alone go to another domain, cut otherwise.
    TileDomain e = make_periodic(256, {.tile_cells = 128, .halo = 8, .reversed_slots = true}, Aeolian::layers(desc));
    land.put(e);
    std::vector<int32_t> cells(128 * 128);
    for (int32_t from = 0; from < 4; ++from)
        k_conserved_layers.for_each([&](SimLayer l) {
            if (!d.layers().contains(l)) return;
            ASSERT_TRUE(d.store(from, l, cells.data()).ok());
            ASSERT_TRUE(e.load(3 - from, l, cells.data()).ok());
        });
    Aeolian second = Aeolian::create(desc, e).value();
    ASSERT_TRUE(second.wind().restore(wind).ok());
    for (int64_t step = 6; step < 9; ++step) ASSERT_TRUE(second.step(e, step).ok());
    EXPECT_EQ(e.hash(k_hashed).value(), whole);
}

TEST(Aeolian, SandLeavesOverAnOpenBorderAndIsCounted) {
    Aeolian::Desc desc = everything();
    desc.sand.supply = false;
    desc.wind.bidirectional = false;
    TileDomain d =
        TileDomain::create(TileLayout::rectangle(128, 16, 1, 1, Border::open), Aeolian::layers(desc)).value();
    const Landscape land{128};
    land.put(d);
    ASSERT_TRUE(d.keep_flows().ok());
    const int64_t before = mass_of(d);
    Aeolian aeolian = Aeolian::create(desc, d).value();
    for (int64_t step = 0; step < 20; ++step) ASSERT_TRUE(aeolian.step(d, step).ok());
    int64_t out = 0;
    k_moved.for_each([&](SimLayer l) {
        const auto flows = d.flows(l).value();
        for (const int64_t f : flows[0]) out += f;
    });
    EXPECT_EQ(mass_of(d) + out, before);
    EXPECT_GT(out, before / 10000);
}

// The same 100 s in steps of other lengths.
TEST(Aeolian, HalvingTheStepChangesLittle) {
    constexpr int32_t k_side = 64;
    struct Figures {
        double flux = 0.0;
        double deviation = 0.0;
        std::vector<float> sand;
    };
    const auto run_for = [](float lift, float dt) {
        Aeolian::Desc desc = scene_a();
        desc.sand.lift_rate_m_per_s = lift;
        desc.sand.step_s = dt;
        desc.sand.avalanche_sweeps = 0;
        const Landscape land{k_side, 1.0f, false};
        TileDomain d = make_periodic(k_side, {.tile_cells = k_side, .halo = 16, .v3 = true}, Aeolian::layers(desc));
        land.put(d);
        Aeolian aeolian = Aeolian::create(desc, d).value();
        const auto steps = static_cast<int64_t>(std::lround(100.0f / dt));
        Figures f;
        for (int64_t step = 0; step < steps; ++step) {
            EXPECT_TRUE(aeolian.step(d, step).ok());
            const auto b = std::as_const(d).reals(SimLayer::bounce);
            const auto wx = std::as_const(d).reals(SimLayer::wind_x);
            for (int32_t y = 0; y < k_side; ++y)
                for (int32_t x = 0; x < k_side; ++x)
                    f.flux += static_cast<double>(b(0, x, y)) * static_cast<double>(wx(0, x, y));
        }
        f.flux /= double{k_side} * k_side * static_cast<double>(steps);
        double mean = 0.0;
        for (int32_t y = 0; y < k_side; ++y)
            for (int32_t x = 0; x < k_side; ++x) {
                f.sand.push_back(metres_of_ticks(std::as_const(d).ints(SimLayer::sand)(0, x, y)));
                mean += static_cast<double>(f.sand.back()) / (double{k_side} * k_side);
            }
        for (const float s : f.sand) f.deviation += (static_cast<double>(s) - mean) * (static_cast<double>(s) - mean);
        f.deviation = std::sqrt(f.deviation / (double{k_side} * k_side));
        return f;
    };
    const RestoreMachine restore;
    const auto apart = [](const Figures& a, const Figures& b) {
        double sum = 0.0;
        for (size_t i = 0; i < a.sand.size(); ++i)
            sum += std::abs(static_cast<double>(a.sand[i]) - static_cast<double>(b.sand[i]));
        return sum / static_cast<double>(a.sand.size());
    };
    const auto print = [](float lift, float dt, const Figures& f) {
        std::printf("100 s, lift %.1f m/s, dt %.2f s: flux %.4f m2/s, deviation of sand %.4f m\n",
                    static_cast<double>(lift), static_cast<double>(dt), f.flux, f.deviation);
    };
    // The ground changes by 0.1 m in a second: the step is fine, and halving it again halves what is wrong.
    const Figures whole = run_for(0.1f, 1.0f);
    const Figures half = run_for(0.1f, 0.5f);
    const Figures quarter = run_for(0.1f, 0.25f);
    print(0.1f, 1.0f, whole);
    print(0.1f, 0.5f, half);
    print(0.1f, 0.25f, quarter);
    std::printf("mean difference of sand: %.4f m, then %.4f m\n", apart(whole, half), apart(half, quarter));
    EXPECT_NEAR(whole.flux / half.flux, 1.0, 0.02);
    EXPECT_NEAR(half.flux / quarter.flux, 1.0, 0.01);
    EXPECT_NEAR(whole.deviation / half.deviation, 1.0, 0.02);
    EXPECT_LT(apart(whole, half), 0.1);
    EXPECT_LT(apart(half, quarter), 0.7 * apart(whole, half));
    // The published rate moves 1 m in a step of 1 s: cells shelter each other at random, which shorter steps do not do.
    const Figures published = run_for(1.0f, 1.0f);
    const Figures shorter = run_for(1.0f, 0.5f);
    print(1.0f, 1.0f, published);
    print(1.0f, 0.5f, shorter);
    EXPECT_NEAR(published.flux / shorter.flux, 1.0, 0.3);
    EXPECT_NEAR(published.deviation / shorter.deviation, 1.0, 0.1);
}

TEST(Aeolian, RefusesWhatCannotBe) {
    const Landscape land{128};
    const auto error_of = [&](const Aeolian::Desc& desc, int32_t halo) -> std::string {
        TileDomain d = make_periodic(128, {.tile_cells = 128, .halo = halo}, Aeolian::layers(desc));
        land.put(d);
        auto made = Aeolian::create(desc, d);
        if (!made.ok()) {
            EXPECT_EQ(made.error().kind, ErrorKind::usage);
            return made.error().message;
        }
        const Status ran = made->step(d, 0);
        return ran.ok() ? "" : ran.error().message;
    };
    EXPECT_EQ(error_of({}, 16), "");
    EXPECT_NE(error_of({}, 8).find("halos of at least 12 cells"), std::string::npos);
    EXPECT_EQ(Aeolian::least_halo({}), 12);
    Aeolian::Desc d;
    d.sand.echo_rate_m_per_s = 1.0f;
    EXPECT_EQ(Aeolian::least_halo(d), 61);
    d.sand.echo_sticky_range = 0.4f;
    EXPECT_NE(error_of(d, 64).find("sand.echo_sticky_range"), std::string::npos);
    d = {};
    d.sand.shadow_min_deg = 20.0f;
    EXPECT_NE(error_of(d, 16).find("sand.shadow_max"), std::string::npos);
    d = {};
    d.sand.step_s = 100.0f;
    d.sand.hop_s = 0.01f;
    EXPECT_NE(error_of(d, 16).find("sand.step"), std::string::npos);
    d = {};
    d.sand.hop_s = 100.0f;
    d.wind.speed_m_per_s = 50.0f;
    EXPECT_NE(error_of(d, 16).find("sand.hop"), std::string::npos);
    d = {};
    d.sand.repose_deg = 89.0f;
    EXPECT_NE(error_of(d, 16).find("repose"), std::string::npos);
    TileDomain bare =
        TileDomain::create(TileLayout::rectangle(128, 16, 1, 1, Border::periodic), {SimLayer::sand}).value();
    const auto missing = Aeolian::create({}, bare);
    ASSERT_FALSE(missing.ok());
    EXPECT_NE(missing.error().message.find("need the layer bedrock"), std::string::npos);
}

} // namespace
} // namespace sahel::test
