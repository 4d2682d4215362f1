#include "world/noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace sahel {
namespace {

constexpr uint64_t k_long_seed = 0x123456789abcdef0ull;

TEST(NoiseTest, HashVectors) {
    EXPECT_EQ(lowbias32(0u), 0x00000000u);
    EXPECT_EQ(lowbias32(1u), 0x688990c0u);
    EXPECT_EQ(lowbias32(2u), 0xd1132181u);
    EXPECT_EQ(lowbias32(0x3039u), 0x912efcf7u);
    EXPECT_EQ(lowbias32(0x7fffffffu), 0x8d29ffb8u);
    EXPECT_EQ(lowbias32(0x80000000u), 0xcc4b4124u);
    EXPECT_EQ(lowbias32(0xffffffffu), 0x6768824au);
}

TEST(NoiseTest, SaltVectors) {
    EXPECT_EQ(noise_salt(1, 0), 0xa07c7a97u);
    EXPECT_EQ(noise_salt(1, 1), 0x3e7e86f3u);
    EXPECT_EQ(noise_salt(1, 7), 0x3f812d3eu);
    EXPECT_EQ(noise_salt(1, 900), 0x5f19e8a3u);
    EXPECT_EQ(noise_salt(k_long_seed, 0), 0x95381fc8u);
    EXPECT_EQ(noise_salt(k_long_seed, 1), 0xc71c5f60u);
    EXPECT_EQ(noise_salt(k_long_seed, 7), 0x9047ff7cu);
    EXPECT_EQ(noise_salt(k_long_seed, 900), 0x2c995d58u);
}

TEST(NoiseTest, NodeVectors) {
    const auto node = [](int64_t i, int64_t j) {
        return node_hash(column_hash(static_cast<uint32_t>(static_cast<uint64_t>(i)), noise_salt(1, 0)),
                         static_cast<uint32_t>(static_cast<uint64_t>(j)));
    };
    EXPECT_EQ(node(0, 0), 0x13f967ebu);
    EXPECT_EQ(node(1, 0), 0xd105a8a5u);
    EXPECT_EQ(node(0, 1), 0x4278ea6fu);
    EXPECT_EQ(node(-1, -1), 0xfad70768u);
    EXPECT_EQ(node(4'000'000'000, -3'000'000'000), 0x39f9ef63u);
    EXPECT_EQ(node(int64_t{1} << 40, -(int64_t{1} << 40) - 5), 0x0d825881u);
}

// A cell of level 0 is 2 half metres wide and its centre is odd.
SampleRow cell_row(int64_t x, int64_t y) {
    return SampleRow{2 * x + 1, 2 * y + 1, 2, 0};
}

TEST(NoiseTest, GradientNoiseVectors) {
    const Lattice lattice = make_lattice(12, 5, 15, 0x05664305u);
    EXPECT_EQ(lattice.off_u, 4096);
    EXPECT_EQ(lattice.off_v, 8192);
    struct Row {
        int64_t x, y;
        uint32_t value, dx, dy;
    };
    constexpr Row k_rows[] = {
        {0, 0, 0x3e0e5343u, 0x3983e295u, 0x37b0c157u},
        {1, 0, 0x3e0e94f0u, 0x3982d28fu, 0x37a6da7au},
        {-1, -1, 0x3e0e0adcu, 0x39859007u, 0x37d188e7u},
        {1000, -2000, 0x3eec51bfu, 0xba0ba188u, 0xba931680u},
        {8'192'000'000, -6'144'000'000, 0xbe4949a8u, 0xb9d5f517u, 0xb905ca3du},
        {123'456'789'012, 98'765'432'109, 0xbe1b4142u, 0xba0f6cdbu, 0xbaa998d3u},
    };
    for (const Row& r : k_rows) {
        const LatticeRow row = lattice_row(lattice, cell_row(r.x, r.y));
        const NoiseGradient g = noise_gradient(row, lattice_point(row, 0));
        EXPECT_EQ(std::bit_cast<uint32_t>(g.value), r.value) << r.x << ' ' << r.y;
        EXPECT_EQ(std::bit_cast<uint32_t>(g.dx), r.dx) << r.x << ' ' << r.y;
        EXPECT_EQ(std::bit_cast<uint32_t>(g.dy), r.dy) << r.x << ' ' << r.y;
        EXPECT_EQ(std::bit_cast<uint32_t>(noise_value(row, lattice_point(row, 0))), r.value);
    }
}

TEST(NoiseTest, SamplesDoNotDependOnWhereTheRowStarts) {
    for (const int32_t level : {0, 3, 9, 12}) {
        const Lattice lattice = make_lattice(1, 3, 20000.0f);
        const int64_t unit = int64_t{1} << level;
        const auto row_at = [&](int64_t x) {
            return lattice_row(lattice, SampleRow{(2 * x + 1) * unit, (2 * 77 + 1) * unit, 2 * unit, level});
        };
        const LatticeRow whole = row_at(-5'000'000'123);
        for (const int32_t i : {0, 1, 17, 255, 511}) {
            const LatticeRow one = row_at(-5'000'000'123 + i);
            EXPECT_EQ(std::bit_cast<uint32_t>(noise_value(whole, lattice_point(whole, i))),
                      std::bit_cast<uint32_t>(noise_value(one, lattice_point(one, 0))));
        }
    }
}

TEST(NoiseTest, Statistics) {
    const Lattice lattice = make_lattice(7, 2, 40.0f);
    double sum = 0.0, square = 0.0, largest = 0.0;
    int64_t count = 0;
    for (int32_t y = 0; y < 256; ++y) {
        const LatticeRow row = lattice_row(lattice, SampleRow{0, y * 997, 1999, 0});
        for (int32_t x = 0; x < 1024; ++x) {
            const double v = static_cast<double>(noise_value(row, lattice_point(row, x)));
            sum += v;
            square += v * v;
            largest = std::max(largest, std::abs(v));
            ++count;
        }
    }
    EXPECT_NEAR(sum / static_cast<double>(count), 0.0, 0.005);
    EXPECT_NEAR(std::sqrt(square / static_cast<double>(count)), 0.28, 0.01);
    EXPECT_LT(largest, 1.4);
    EXPECT_GT(largest, 0.9);
}

TEST(NoiseTest, DerivativeIsThatOfTheValue) {
    const Lattice lattice = make_lattice(1, 5, 300.0f);
    double worst = 0.0;
    for (int32_t i = 0; i < 200; ++i) {
        const int64_t x = i * 37 - 4000, y = i * 91 + 11;
        const auto at = [&](int64_t px, int64_t py) {
            const LatticeRow row = lattice_row(lattice, cell_row(px, py));
            return noise_gradient(row, lattice_point(row, 0));
        };
        const double dx = (static_cast<double>(at(x + 1, y).value) - static_cast<double>(at(x - 1, y).value)) / 2.0;
        const double dy = (static_cast<double>(at(x, y + 1).value) - static_cast<double>(at(x, y - 1).value)) / 2.0;
        worst = std::max(
            {worst, std::abs(dx - static_cast<double>(at(x, y).dx)), std::abs(dy - static_cast<double>(at(x, y).dy))});
    }
    EXPECT_LT(worst, 2e-6);
}

TEST(NoiseTest, LatticesComeOutAtTheWantedSize) {
    std::vector<int> rotations;
    for (uint32_t id = 0; id < 60; ++id)
        for (const float wanted : {2.6f, 9.0f, 37.0f, 165.0f, 403.0f, 1900.0f, 20000.0f, 60000.0f}) {
            const Lattice lattice = make_lattice(1, id, wanted);
            EXPECT_NEAR(lattice.size_m / wanted, 1.0f, 0.05f) << id << ' ' << wanted;
            EXPECT_LE(lattice.m, 24);
            EXPECT_GE(lattice.m, 4);
            rotations.push_back(lattice.a * 100 + lattice.b);
        }
    std::sort(rotations.begin(), rotations.end());
    rotations.erase(std::unique(rotations.begin(), rotations.end()), rotations.end());
    EXPECT_GE(rotations.size(), 20u); // octaves must not line up
}

TEST(NoiseTest, SmallTrigonometry) {
    double worst_sin = 0.0, worst_angle = 0.0;
    for (int32_t i = -4000; i <= 4000; ++i) {
        const double turns = i / 1000.0;
        const double angle = turns * 6.283185307179586;
        worst_sin =
            std::max(worst_sin, std::abs(static_cast<double>(sin_turns(static_cast<float>(turns))) - std::sin(angle)));
        worst_sin =
            std::max(worst_sin, std::abs(static_cast<double>(cos_turns(static_cast<float>(turns))) - std::cos(angle)));
        const double found =
            static_cast<double>(atan2_turns(static_cast<float>(std::sin(angle)), static_cast<float>(std::cos(angle))));
        double off = found - turns;
        off -= std::floor(off + 0.5);
        worst_angle = std::max(worst_angle, std::abs(off));
    }
    EXPECT_LT(worst_sin, 0.0012);
    EXPECT_LT(worst_angle, 2e-4);
}

TEST(NoiseTest, BandWeightFades) {
    EXPECT_EQ(band_weight(1.0f, 4.0f), 0.0f);
    EXPECT_NEAR(band_weight(1.5f, 1.0f), 0.72f, 0.02f);
    EXPECT_GT(band_weight(16.0f, 1.0f), 0.99f);
    for (float r = 0.1f; r < 20.0f; r += 0.01f) EXPECT_LE(band_weight(r, 1.0f), band_weight(r + 0.01f, 1.0f) + 1e-6f);
}

TEST(NoiseTest, PhasorHasUnitLengthAwayFromDislocations) {
    const Lattice lattice = make_lattice(1, 8, 400.0f);
    const float scale = static_cast<float>(int64_t{1} << lattice.m) /
                        (2.0f * static_cast<float>(lattice.a * lattice.a + lattice.b * lattice.b) * 140.0f);
    int32_t strong = 0;
    constexpr int32_t k_count = 4000;
    for (int32_t i = 0; i < k_count; ++i) {
        const LatticeRow row = lattice_row(lattice, cell_row(i * 131, i * 57));
        const Phasor p = phasor_at(row, lattice_point(row, 0), static_cast<float>(lattice.a),
                                   static_cast<float>(lattice.b), 0.6f, 0.8f, scale, 0.3f);
        const float length = std::sqrt(p.c * p.c + p.s * p.s);
        EXPECT_LT(length, 1.01f);
        strong += length > 0.35f ? 1 : 0;
    }
    EXPECT_GT(strong, k_count / 2);
}

} // namespace
} // namespace sahel
