#include "world/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace sahel {
namespace {

// The kat_vectors file of Random123, philox4x32 with 10 rounds.
TEST(Random, PhiloxGivesTheKnownAnswers) {
    const auto expect = [](Random4 got, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
        EXPECT_EQ(got.v[0], a);
        EXPECT_EQ(got.v[1], b);
        EXPECT_EQ(got.v[2], c);
        EXPECT_EQ(got.v[3], d);
    };
    expect(philox(0, 0, 0, 0, 0, 0), 0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8);
    expect(philox(~0u, ~0u, ~0u, ~0u, ~0u, ~0u), 0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd);
    expect(philox(0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344, 0xa4093822, 0x299f31d0), 0xd16cfe09, 0x94fdcceb,
           0x5001e420, 0x24126ea1);
}

// A world's bits hang on these: the layout of counter and key never changes.
TEST(Random, StreamsKeepTheirLayout) {
    const RandomStream s(0x0123456789abcdefull, 42, Purpose::rain, 3);
    const Random4 key = philox(42, 0, 8, 3, 0x89abcdef, 0x01234567);
    EXPECT_EQ(s.k0, key.v[0]);
    EXPECT_EQ(s.k1, key.v[1]);
    const Random4 at = s.at(-1, 4'000'000'000'000);
    const Random4 bare = philox(~0u, ~0u, static_cast<uint32_t>(4'000'000'000'000), 931, key.v[0], key.v[1]);
    for (int i = 0; i < 4; ++i) EXPECT_EQ(at.v[i], bare.v[i]);
}

// Chi-squared of `counts`, all equally likely, as a distance from its mean in standard deviations.
double chi2_sigmas(const std::vector<int>& counts) {
    double total = 0.0;
    for (const int c : counts) total += c;
    const double expected = total / static_cast<double>(counts.size());
    double chi2 = 0.0;
    for (const int c : counts) chi2 += (c - expected) * (c - expected) / expected;
    const double freedom = static_cast<double>(counts.size()) - 1.0;
    return (chi2 - freedom) / std::sqrt(2.0 * freedom);
}

struct Place {
    int64_t x, y;
};
constexpr int64_t k_far = 4'000'000'000'000;
constexpr Place k_places[] = {{0, 0}, {-512, -512}, {k_far, k_far}, {-k_far, k_far}, {INT64_MAX - 600, INT64_MIN}};

TEST(Random, EveryWordIsUniformNearAndFar) {
    for (const Place p : k_places)
        for (int word = 0; word < 4; ++word) {
            const RandomStream s(7, 3, Purpose::test);
            std::vector<int> high(256);
            std::vector<int> low(256);
            for (int y = 0; y < 512; ++y)
                for (int x = 0; x < 512; ++x) {
                    const uint32_t u = s.at(p.x + x, p.y + y).v[word];
                    ++high[u >> 24];
                    ++low[u & 255];
                }
            EXPECT_LT(std::fabs(chi2_sigmas(high)), 4.5) << p.x << ' ' << word;
            EXPECT_LT(std::fabs(chi2_sigmas(low)), 4.5) << p.x << ' ' << word;
        }
}

// Joint distribution (16 x 16) of a cell's number and that of its neighbour, next step, other purpose or seed.
TEST(Random, NeighboursStepsPurposesAndSeedsAreIndependent) {
    const RandomStream s(7, 3, Purpose::test);
    const RandomStream others[] = {RandomStream(7, 4, Purpose::test), RandomStream(7, 3, Purpose::rain),
                                   RandomStream(8, 3, Purpose::test), RandomStream(7, 3, Purpose::test, 1)};
    for (const Place p : k_places) {
        std::vector<std::vector<int>> joint(7, std::vector<int>(256));
        for (int y = 0; y < 400; ++y)
            for (int x = 0; x < 400; ++x) {
                const uint32_t a = s.at(p.x + x, p.y + y).v[0] >> 28;
                const auto see = [&](size_t i, uint32_t b) { ++joint[i][a * 16 + (b >> 28)]; };
                see(0, s.at(p.x + x + 1, p.y + y).v[0]);
                see(1, s.at(p.x + x, p.y + y + 1).v[0]);
                see(2, s.at(p.x + x, p.y + y).v[1]);
                for (size_t i = 0; i < 4; ++i) see(3 + i, others[i].at(p.x + x, p.y + y).v[0]);
            }
        for (size_t i = 0; i < joint.size(); ++i) EXPECT_LT(std::fabs(chi2_sigmas(joint[i])), 4.5) << p.x << ' ' << i;
    }
}

TEST(Random, FarCellsDoNotRepeatNearOnes) {
    const RandomStream s(1, 0, Purpose::test);
    std::set<std::pair<uint32_t, uint32_t>> seen;
    for (const int64_t period :
         {int64_t{0}, int64_t{1} << 16, int64_t{1} << 31, int64_t{1} << 32, int64_t{1} << 40, k_far})
        for (int64_t y = 0; y < 16; ++y)
            for (int64_t x = 0; x < 16; ++x) {
                const Random4 r = s.at(period + x, y);
                EXPECT_TRUE(seen.insert({r.v[0], r.v[1]}).second);
                if (period != 0) {
                    const Random4 q = s.at(x, period + y);
                    EXPECT_TRUE(seen.insert({q.v[0], q.v[1]}).second);
                }
            }
}

TEST(Random, ThreadsAndOrderDoNotMatter) {
    const RandomStream s(5, 9, Purpose::test);
    constexpr int n = 1000;
    std::vector<uint32_t> forward(n);
    std::vector<uint32_t> threaded(n);
    for (int i = 0; i < n; ++i) forward[static_cast<size_t>(i)] = s.at(i, -i).v[2];
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            const RandomStream own(5, 9, Purpose::test);
            for (int i = n - 1 - t; i >= 0; i -= 4) threaded[static_cast<size_t>(i)] = own.at(i, -i).v[2];
        });
    for (auto& t : threads) t.join();
    EXPECT_EQ(forward, threaded);
}

TEST(Random, UniformStaysBelowOne) {
    EXPECT_EQ(uniform(0u), 0.0f);
    EXPECT_EQ(uniform(~0u), 1.0f - 0x1p-24f);
    EXPECT_EQ(uniform(0x80000000u), 0.5f);
}

TEST(Random, StochasticRoundingKeepsTheMean) {
    const RandomStream s(5, 9, Purpose::test);
    for (const float ticks : {0.0f, 0.001f, 0.25f, 0.999f, 1.0f, 7.3f, -0.4f, -12.75f, 100000.5f}) {
        constexpr int n = 400000;
        double sum = 0.0;
        for (int i = 0; i < n; ++i) {
            const int32_t r = stochastic_round(ticks, s.at(i, 0).v[0]);
            ASSERT_LT(std::fabs(static_cast<double>(r) - static_cast<double>(ticks)), 1.0);
            sum += r;
        }
        const double part = std::fabs(static_cast<double>(ticks)) - std::floor(std::fabs(static_cast<double>(ticks)));
        const double sigma = std::sqrt(part * (1.0 - part) / n);
        EXPECT_NEAR(sum / n, static_cast<double>(ticks), 4.5 * sigma + 1e-9) << ticks;
    }
    for (int i = 0; i < 1000; ++i) {
        const uint32_t bits = s.at(0, i).v[0];
        EXPECT_EQ(stochastic_round(-3.7f, bits), -stochastic_round(3.7f, bits));
    }
    EXPECT_EQ(stochastic_round(0x1.fffffep+30f, 0), 2147483520);
    EXPECT_EQ(stochastic_round(std::nextafter(1.0f, 0.0f), ~0u), 0);
    EXPECT_EQ(stochastic_round(1e-30f, 0), 0);
}

} // namespace
} // namespace sahel
