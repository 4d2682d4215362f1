#include "sim/step_plan.h"

#include "pass_check.h"
#include "toy_passes.h"
#include "world/cuda_runtime.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace sahel::test {
namespace {

HaloState state_of(std::initializer_list<std::pair<SimLayer, int32_t>> valid) {
    HaloState s;
    s.fill(k_nothing_valid);
    for (const auto& [layer, cells] : valid) s[static_cast<size_t>(layer)] = cells;
    return s;
}

constexpr PassDecl k_p{"p", {{SimLayer::sand, 1}}, {SimLayer::surface}, 8};
constexpr PassDecl k_q{"q", {{SimLayer::surface, 2}}, {SimLayer::sand}, 8};

TEST(StepPlan, UsesUpTheHaloBeforeItExchanges) {
    const std::vector<PassDecl> passes{k_p, k_q, k_p, k_q, k_p, k_q, k_p, k_q};
    // Halo 8, three cells a pair: two pairs and a half fit. Before each exchange the halo is owed nothing.
    const StepPlan plan = StepPlan::make(passes, 8, state_of({{SimLayer::sand, 0}})).value();
    EXPECT_EQ(plan.text(passes), "exchange sand\np +6\nq +4\np +3\nq +1\np +0\n"
                                 "exchange surface\nq +3\np +2\nq +0\n");
    EXPECT_EQ(plan.exchanges(), 2);
    // With room for everything one exchange is enough; margins add up from the end.
    const StepPlan wide = StepPlan::make(passes, 16, state_of({{SimLayer::sand, 0}})).value();
    EXPECT_EQ(wide.text(passes), "exchange sand\np +11\nq +9\np +8\nq +6\np +5\nq +3\np +2\nq +0\n");
    // What is valid already needs none.
    EXPECT_EQ(StepPlan::make(passes, 16, state_of({{SimLayer::sand, 12}})).value().exchanges(), 0);
    EXPECT_EQ(StepPlan::make(passes, 16, state_of({{SimLayer::sand, 11}})).value().exchanges(), 1);
}

TEST(StepPlan, RefusesWhatCannotBe) {
    const auto too_far = StepPlan::make(std::vector<PassDecl>{k_q}, 1, state_of({{SimLayer::surface, 0}}));
    ASSERT_FALSE(too_far.ok());
    EXPECT_EQ(too_far.error().kind, ErrorKind::usage);
    EXPECT_NE(too_far.error().message.find("'q' reads surface within 2 cells"), std::string::npos);
    const auto unread = StepPlan::make(std::vector<PassDecl>{k_q}, 8, state_of({}));
    ASSERT_FALSE(unread.ok());
    EXPECT_NE(unread.error().message.find("nothing has written"), std::string::npos);
}

TEST(StepPlan, DeclarationsKnowWhatIsUnsound) {
    constexpr PassDecl in_place{"in place", {{SimLayer::sand, 0}}, {SimLayer::sand}, 8};
    constexpr PassDecl racing{"racing", {{SimLayer::sand, 1}}, {SimLayer::sand}, 8};
    static_assert(in_place.sound() && !racing.sound());
    static_assert(k_q.radius() == 2);
}

// --- honesty
// ------------------------------------------------------------------------------------------------------------

TEST(PassHonesty, ToyPassesReadNoFurtherThanTheyDeclare) {
    for (uint64_t seed = 1; seed <= 5; ++seed)
        for (const Pass& pass : {smooth_pass(), slump_pass(), hop_pass(3, 4)})
            EXPECT_EQ(find_dishonest(pass, k_toy_layers, seed), "") << pass.decl.name << ' ' << seed;
}

TEST(PassHonesty, ADeclarationThatIsTooSmallIsFound) {
    Pass hop = hop_pass(3, 4);
    hop.decl = PassDecl{"test/hop", {{SimLayer::surface, 2}}, {SimLayer::sand}, 8};
    EXPECT_NE(find_dishonest(hop, k_toy_layers, 1).find("does not declare to read"), std::string::npos);
    EXPECT_NE(find_dishonest(slump_pass(2), k_toy_layers, 1).find("does not declare to read"), std::string::npos);
    Pass blind = smooth_pass();
    blind.decl = PassDecl{"test/smooth", {{SimLayer::surface, 1}}, {SimLayer::wind_shadow}, 8};
    EXPECT_NE(find_dishonest(blind, k_toy_layers, 1).find("does not declare to read"), std::string::npos);
    Pass silent = smooth_pass();
    silent.decl = PassDecl{"test/smooth", {{SimLayer::sand, 1}}, {SimLayer::surface}, 8};
    EXPECT_NE(find_dishonest(silent, k_toy_layers, 1).find("was written"), std::string::npos);
}

// --- same bits
// ----------------------------------------------------------------------------------------------------------

int32_t start_sand(int64_t x, int64_t y) {
    return static_cast<int32_t>(RandomStream(21, 0, Purpose::test).at(x, y).v[0] >> 12);
}

// `steps` rounds of all passes; a plan is made for each batch of rounds, so that batches exercise long lists too.
std::string run_toys(int32_t side, const RunWay& way, int rounds, std::vector<Pass> (*passes_of)(int),
                     int64_t* mass = nullptr, MemoryPool& pool = MemoryPool::host()) {
    TileDomain domain = make_periodic(side, way, k_toy_layers, pool);
    EXPECT_TRUE(domain.fill(SimLayer::sand, start_sand).ok());
    std::vector<Pass> list;
    for (int r = 0; r < rounds; ++r) {
        for (Pass& p : passes_of(r)) list.push_back(std::move(p));
        if (r % 3 != 2 && r + 1 < rounds) continue;
        const Status ran = run_passes(domain, list);
        EXPECT_TRUE(ran.ok()) << ran.error().message;
        list.clear();
    }
    if (mass) {
        *mass = 0;
        for (const int64_t s : domain.sums(SimLayer::sand).value()) *mass += s;
    }
    return domain.hash({SimLayer::sand, SimLayer::wind_shadow}).value();
}

std::vector<Pass> honest_passes(int r) {
    return {smooth_pass(), slump_pass(), hop_pass(5, r)};
}

TEST(SameBits, AnyTilingHaloThreadsOrderAndInstructionSet) {
    const RestoreMachine restore;
    const int32_t side = long_tests() ? 1024 : 512;
    const int rounds = long_tests() ? 8 : 4;
    int64_t start = 0;
    for (int64_t y = 0; y < side; ++y)
        for (int64_t x = 0; x < side; ++x) start += start_sand(x, y);
    std::string expected;
    int ways = 0;
    for (const RunWay& way : run_ways(side, !long_tests())) {
        int64_t mass = 0;
        const std::string hash = run_toys(side, way, rounds, honest_passes, &mass);
        if (expected.empty()) expected = hash;
        EXPECT_EQ(hash, expected) << text_of(way);
        EXPECT_EQ(mass, start) << text_of(way);
        ++ways;
    }
    EXPECT_GE(ways, long_tests() ? 36 : 10);
    std::printf("%d ways, hash %s\n", ways, expected.c_str());
}

// The pass looks three cells far and says two: tiles then disagree.
TEST(SameBits, AWrongRadiusChangesTheHash) {
    const RestoreMachine restore;
    const auto wrong = [](int r) {
        std::vector<Pass> list = honest_passes(r);
        list[2].decl = PassDecl{"test/hop", {{SimLayer::surface, 2}}, {SimLayer::sand}, 8};
        return list;
    };
    const std::string small = run_toys(256, {.tile_cells = 128, .halo = 8}, 4, +wrong);
    const std::string large = run_toys(256, {.tile_cells = 256, .halo = 64}, 4, +wrong);
    EXPECT_NE(small, large);
    EXPECT_EQ(run_toys(256, {.tile_cells = 128, .halo = 8}, 4, honest_passes),
              run_toys(256, {.tile_cells = 256, .halo = 64}, 4, honest_passes));
}

TEST(SameBits, CudaGivesTheSameHash) {
#if SAHEL_HAS_CUDA
    if (!cuda::available()) GTEST_SKIP() << "no CUDA device: " << cuda::status().why_not;
    const RestoreMachine restore;
    const std::string expected = run_toys(256, {.tile_cells = 256, .halo = 16}, 6, honest_passes);
    MemoryPool pool("test device", MemoryKind::cuda, 1u << 30);
    for (const int32_t tile : {128, 256})
        for (const int32_t halo : {8, 64}) {
            const RunWay way{.tile_cells = tile, .halo = halo, .device = true};
            int64_t mass = 0;
            EXPECT_EQ(run_toys(256, way, 6, honest_passes, &mass, pool), expected) << text_of(way);
        }
#else
    GTEST_SKIP() << "built without a CUDA compiler";
#endif
}

} // namespace
} // namespace sahel::test
