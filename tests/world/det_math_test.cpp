#include "world/det_math.h"

#include "det_math_sweep.h"
#include "world/cpu_features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace sahel {
namespace {

using test::NamedRow;
constexpr float k_huge = std::numeric_limits<float>::max();
constexpr float k_denormal = std::numeric_limits<float>::denorm_min();

bool long_tests() {
    const char* asked = std::getenv("SAHEL_LONG_TESTS");
    return asked && std::string_view(asked) == "1";
}

// Distance of a float from the exact value, in units of the float's last place there.
double error_ulp(float got, double exact) {
    if (std::isnan(exact)) return std::isnan(got) ? 0.0 : 1e9;
    const auto rounded = static_cast<float>(exact); // infinite also where a finite double is too large for a float
    if (std::isinf(exact) || (std::isinf(rounded) && got == rounded)) return got == rounded ? 0.0 : 1e9;
    int exponent = -200;
    if (exact != 0.0) std::frexp(exact, &exponent);
    const double ulp = std::ldexp(1.0, std::clamp(exponent - 24, -149, 104));
    const double value = std::isinf(got) ? std::copysign(0x1p128, got) : static_cast<double>(got);
    return std::fabs(value - exact) / ulp;
}

struct Worst {
    double ulp = 0.0;
    float x = 0.0f;
    float y = 0.0f;
    void see(double e, float at_x, float at_y = 0.0f) {
        if (!(e > ulp)) return;
        ulp = e;
        x = at_x;
        y = at_y;
    }
};

// Every `stride`-th float of all 2^32 (every one in long tests).
template <class F, class G> Worst sweep(F f, G exact, float limit = std::numeric_limits<float>::infinity()) {
    const uint64_t stride = long_tests() ? 1 : 4001;
    Worst worst;
    for (uint64_t i = 0; i < (1ull << 32); i += stride) {
        const float x = det::float_of(static_cast<uint32_t>(i));
        if (!(std::fabs(x) <= limit)) continue;
        worst.see(error_ulp(f(x), exact(static_cast<double>(x))), x);
    }
    return worst;
}

#define EXPECT_WORST_ULP(worst, limit)                                                                                 \
    do {                                                                                                               \
        const Worst w = (worst);                                                                                       \
        EXPECT_LE(w.ulp, limit) << std::hexfloat << "at " << w.x << ", " << w.y;                                       \
        std::printf("%-40s %.3f ulp\n", #worst, w.ulp);                                                                \
    } while (false)

// The bounds are those stated in the header.
TEST(DetMath, ErrorsOfOneArgumentStayWithinTheStatedBounds) {
    const auto d_exp = sweep([](float x) { return det::exp(x); }, [](double x) { return std::exp(x); });
    const auto d_exp2 = sweep([](float x) { return det::exp2(x); }, [](double x) { return std::exp2(x); });
    const auto d_log = sweep([](float x) { return det::log(x); }, [](double x) { return std::log(x); });
    const auto d_log2 = sweep([](float x) { return det::log2(x); }, [](double x) { return std::log2(x); });
    const auto d_sin = sweep([](float x) { return det::sin(x); }, [](double x) { return std::sin(x); }, 8192.0f);
    const auto d_cos = sweep([](float x) { return det::cos(x); }, [](double x) { return std::cos(x); }, 8192.0f);
    const auto d_atan = sweep([](float x) { return det::atan(x); }, [](double x) { return std::atan(x); });
    EXPECT_WORST_ULP(d_exp, 0.99);
    EXPECT_WORST_ULP(d_exp2, 1.05);
    EXPECT_WORST_ULP(d_log, 0.86);
    EXPECT_WORST_ULP(d_log2, 0.91);
    EXPECT_WORST_ULP(d_sin, 0.83);
    EXPECT_WORST_ULP(d_cos, 0.83);
    EXPECT_WORST_ULP(d_atan, 1.62);
    EXPECT_WORST_ULP(sweep([](float x) { return det::sqrt(x); }, [](double x) { return std::sqrt(x); }), 0.5);
    EXPECT_WORST_ULP(sweep([](float x) { return det::floor(x); }, [](double x) { return std::floor(x); }), 0.0);
}

// xorshift64: any stream of bits will do here.
struct Bits {
    uint64_t state = 88172645463325252ull;
    uint32_t next() {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        return static_cast<uint32_t>(state >> 24);
    }
    float signed_unit() { return static_cast<float>(static_cast<int32_t>(next())) * 0x1p-31f; }
};

TEST(DetMath, ErrorsOfPowAndAtan2StayWithinTheStatedBounds) {
    const int64_t count = long_tests() ? 400000000 : 2000000;
    Bits bits;
    Worst pow_worst;
    Worst atan2_worst;
    for (int64_t i = 0; i < count; ++i) {
        // Bases of every size, or close to 1; exponents of every size, or such that the result is finite.
        float x = det::float_of(bits.next() & 0x7FFFFFFFu);
        if (i & 1) x = 1.0f + bits.signed_unit() * std::ldexp(1.0f, -static_cast<int>(bits.next() % 24));
        if (std::isnan(x) || x < 0.0f) continue;
        float y = det::float_of(bits.next());
        if (i & 2)
            y = static_cast<float>(static_cast<double>(bits.signed_unit()) * 150.0 / std::log2(static_cast<double>(x)));
        if (i % 8 == 7) y = bits.signed_unit() * 4.0f;
        pow_worst.see(error_ulp(det::pow(x, y), std::pow(static_cast<double>(x), static_cast<double>(y))), x, y);

        float b = det::float_of(bits.next());
        float a = det::float_of(bits.next());
        if (i & 1) {
            b = bits.signed_unit();
            a = bits.signed_unit() * std::ldexp(1.0f, -static_cast<int>(bits.next() % 30));
        }
        atan2_worst.see(error_ulp(det::atan2(a, b), std::atan2(static_cast<double>(a), static_cast<double>(b))), b, a);
    }
    EXPECT_WORST_ULP(pow_worst, 1.25);
    EXPECT_WORST_ULP(atan2_worst, 1.85);
}

TEST(DetMath, BeyondTheAccurateRangeSineStillMeansTheAngle) {
    Bits bits;
    for (int i = 0; i < 200000; ++i) {
        const float x = bits.signed_unit() * det::k_trig_max;
        const double allowed = 1e-7 + std::fabs(static_cast<double>(x)) * 0x1p-23;
        ASSERT_NEAR(static_cast<double>(det::sin(x)), std::sin(static_cast<double>(x)), allowed) << x;
        ASSERT_NEAR(static_cast<double>(det::cos(x)), std::cos(static_cast<double>(x)), allowed) << x;
    }
    for (const float x : {0x1p22f, 1e10f, k_huge}) {
        EXPECT_EQ(det::sin(x), 0.0f);
        EXPECT_EQ(det::cos(x), 1.0f);
    }
}

// C99 Annex F, through libm's own answers: same class, same sign; exact where the answer is.
TEST(DetMath, SpecialValuesAreThoseOfTheCStandard) {
    const float inf = det::k_inf;
    const std::array special = {0.0f,           1.0f,           0.5f,        2.0f,       3.0f,       0.75f,     1e10f,
                                5.0f,           1e-10f,         k_huge,      0x1p-126f,  k_denormal, inf,       0x1p24f,
                                0x1.fffffep-1f, 0x1.000002p+0f, 16777215.0f, 8388607.5f, 8388608.0f, det::k_nan};
    const auto same = [](float got, float want, const char* what, float a, float b) {
        if (std::isnan(want)) {
            EXPECT_EQ(det::bits_of(got), det::bits_of(det::k_nan)) << what << " of " << a << ", " << b;
            return;
        }
        EXPECT_EQ(std::signbit(got), std::signbit(want)) << what << " of " << a << ", " << b;
        if (want == 0.0f || std::isinf(want))
            EXPECT_EQ(got, want) << what << " of " << a << ", " << b;
        else
            EXPECT_LE(error_ulp(got, static_cast<double>(want)), 2.5) << what << " of " << a << ", " << b;
    };
    for (const float magnitude : special)
        for (const float x : {magnitude, -magnitude}) {
            same(det::exp(x), std::exp(x), "exp", x, 0);
            same(det::exp2(x), std::exp2(x), "exp2", x, 0);
            same(det::log(x), std::log(x), "log", x, 0);
            same(det::log2(x), std::log2(x), "log2", x, 0);
            same(det::atan(x), std::atan(x), "atan", x, 0);
            same(det::sqrt(x), std::sqrt(x), "sqrt", x, 0);
            same(det::floor(x), std::floor(x), "floor", x, 0);
            if (!(std::fabs(x) > det::k_trig_max) || std::isinf(x)) {
                same(det::sin(x), std::sin(x), "sin", x, 0);
                same(det::cos(x), std::cos(x), "cos", x, 0);
            }
            for (const float other : special)
                for (const float y : {other, -other}) {
                    same(det::pow(x, y), std::pow(x, y), "pow", x, y);
                    same(det::atan2(y, x), std::atan2(y, x), "atan2", y, x);
                }
        }
}

TEST(DetMath, ExactWhereTheAnswerIsExact) {
    for (int n = -149; n < 128; ++n) {
        const float power = std::ldexp(1.0f, n);
        EXPECT_EQ(det::exp2(static_cast<float>(n)), power);
        EXPECT_EQ(det::log2(power), static_cast<float>(n));
        EXPECT_EQ(det::pow(2.0f, static_cast<float>(n)), power);
    }
    for (int n = 1; n < 2000; ++n) {
        EXPECT_EQ(det::pow(static_cast<float>(n), 2.0f), static_cast<float>(n * n));
        EXPECT_EQ(det::pow(static_cast<float>(n), 1.0f), static_cast<float>(n));
    }
    EXPECT_EQ(det::exp(0.0f), 1.0f);
    EXPECT_EQ(det::bits_of(det::sin(-0.0f)), 0x80000000u);
    EXPECT_EQ(det::cos(0.0f), 1.0f);
    EXPECT_EQ(det::clamp(5.0f, 0.0f, 1.0f), 1.0f);
    EXPECT_EQ(det::clamp(-5.0f, 0.0f, 1.0f), 0.0f);
    EXPECT_TRUE(std::isnan(det::clamp(det::k_nan, 0.0f, 1.0f)));
}

// --- same bits from every compiler and instruction set
// -------------------------------------------------------------------

constexpr NamedRow k_plain[] = SAHEL_DET_ROWS(test::det_plain);
[[maybe_unused]] constexpr NamedRow k_base[] = SAHEL_DET_ROWS(test::det_base);
[[maybe_unused]] constexpr NamedRow k_v3[] = SAHEL_DET_ROWS(test::det_v3);
#if defined(SAHEL_OTHER_COMPILER)
constexpr NamedRow k_other[] = SAHEL_DET_ROWS(test::det_other);
#endif

struct Arguments {
    std::vector<float> x, y;
};

// Bit patterns of every kind, values around 1, angles, and every pair of special values.
const Arguments& arguments() {
    static const Arguments made = [] {
        Arguments a;
        Bits bits;
        for (int i = 0; i < 300000; ++i) {
            a.x.push_back(det::float_of(bits.next()));
            a.y.push_back(det::float_of(bits.next()));
            a.x.push_back(1.0f + bits.signed_unit() * 0.5f);
            a.y.push_back(bits.signed_unit() * 200.0f);
            a.x.push_back(bits.signed_unit() * 10000.0f);
            a.y.push_back(bits.signed_unit() * 10.0f);
        }
        for (const uint32_t b : {0u, 1u, 0x007FFFFFu, 0x00800000u, 0x3F800000u, 0x7F7FFFFFu, 0x7F800000u, 0x7F800001u,
                                 0x7FC12345u, 0x40000000u, 0x40400000u, 0x4B800000u})
            for (const uint32_t c :
                 {0u, 1u, 0x00800000u, 0x3F800000u, 0x3F000000u, 0x7F7FFFFFu, 0x7F800000u, 0x7FC00000u, 0x40400000u})
                for (const uint32_t sign : {0u, 0x80000000u, 1u}) {
                    a.x.push_back(det::float_of(sign == 1u ? b ^ 0x80000000u : b));
                    a.y.push_back(det::float_of(sign == 0x80000000u ? c ^ sign : c));
                }
        return a;
    }();
    return made;
}

std::vector<float> run(const NamedRow& row) {
    const Arguments& a = arguments();
    std::vector<float> out(a.x.size());
    row.row(a.x.data(), a.y.data(), out.data(), static_cast<int>(out.size()));
    return out;
}

void expect_same_bits(const NamedRow (&rows)[test::k_det_rows], const char* what) {
    for (int i = 0; i < test::k_det_rows; ++i) {
        const std::vector<float> want = run(k_plain[i]);
        const std::vector<float> got = run(rows[i]);
        for (size_t j = 0; j < want.size(); ++j)
            ASSERT_EQ(det::bits_of(got[j]), det::bits_of(want[j]))
                << what << ' ' << rows[i].name << std::hexfloat << " of " << arguments().x[j] << ", "
                << arguments().y[j];
    }
}

uint64_t hash_of(const std::vector<float>& values) { // FNV-1a over the bits
    uint64_t h = 14695981039346656037ull;
    for (const float v : values) h = (h ^ det::bits_of(v)) * 1099511628211ull;
    return h;
}

// A change of any bit of any result changes every world that was ever made: these never change unnoticed.
TEST(DetMath, ResultsAreThoseOfEveryEarlierVersion) {
    const std::map<std::string, uint64_t> golden = {
        {"exp", 0x31bfc3e1f6c131a2},  {"exp2", 0x99703de76f21710c},  {"log", 0x0854dd1b1f6e2715},
        {"log2", 0x8a4d0b9942db9571}, {"pow", 0xcbf0e5852bd16546},   {"sin", 0x6af1f623fccbeba7},
        {"cos", 0x34bec9f22ea7b30f},  {"atan", 0x0006b89c6c2869d3},  {"atan2", 0x341a282df3023069},
        {"sqrt", 0x6da86b3c937338af}, {"floor", 0x6f7bd198fc9f0bd2},
    };
    for (const NamedRow& row : k_plain)
        EXPECT_EQ(hash_of(run(row)), golden.at(row.name)) << row.name << std::hex << " 0x" << hash_of(run(row));
}

TEST(DetMath, SameBitsUnoptimisedAndForTheBaselineInstructionSet) {
#if defined(__x86_64__)
    expect_same_bits(k_base, "baseline");
#else
    GTEST_SKIP() << "not an x86-64 machine";
#endif
}

TEST(DetMath, SameBitsUnoptimisedAndForV3) {
#if defined(__x86_64__)
    if (best_isa() != Isa::v3) GTEST_SKIP() << "this machine has no x86-64-v3";
    expect_same_bits(k_v3, "v3");
#else
    GTEST_SKIP() << "not an x86-64 machine";
#endif
}

TEST(DetMath, SameBitsFromAnotherCompiler) {
#if defined(SAHEL_OTHER_COMPILER)
    if (best_isa() != Isa::v3) GTEST_SKIP() << "this machine has no x86-64-v3";
    expect_same_bits(k_other, SAHEL_OTHER_COMPILER);
#else
    GTEST_SKIP() << "only one of g++ and clang++ is installed";
#endif
}

// --- vectorised
// ----------------------------------------------------------------------------------------------------------

// Instructions of every row function in an object file, by function.
std::map<std::string, std::vector<std::string>> disassembly(const std::string& object) {
    std::map<std::string, std::vector<std::string>> functions;
    FILE* pipe = popen(("objdump -dC --no-show-raw-insn '" + object + "' 2>/dev/null").c_str(), "r");
    if (!pipe) return functions;
    std::string current;
    std::array<char, 4096> line{};
    while (std::fgets(line.data(), line.size(), pipe)) {
        const std::string text = line.data();
        if (const size_t name = text.find("::row_"); text.find(">:") != std::string::npos) {
            current = name == std::string::npos ? "" : text.substr(name + 6, text.find('(', name) - name - 6);
        } else if (!current.empty()) {
            const size_t tab = text.find('\t');
            if (tab != std::string::npos) functions[current].push_back(text.substr(tab + 1));
        }
    }
    pclose(pipe);
    return functions;
}

[[maybe_unused]] void expect_packed(const std::string& object, bool v3) {
    if (std::system("objdump --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "objdump is not installed (binutils)";
    const auto functions = disassembly(object);
    ASSERT_EQ(functions.size(), static_cast<size_t>(test::k_det_rows)) << object;
    for (const auto& [name, instructions] : functions) {
        int packed = 0;
        for (const std::string& i : instructions) {
            EXPECT_NE(i.compare(0, 4, "call"), 0) << name << " calls: " << i;
            // A packed single precision operation: mulps xmm, or vmulps ymm.
            const std::string op = i.substr(0, i.find(' '));
            const bool ps = op.size() > 4 && op.ends_with("ps") && op.find("mov") == std::string::npos;
            const bool arithmetic = ps || op.find("cvttps2dq") != std::string::npos;
            if (arithmetic && i.find(v3 ? "%ymm" : "%xmm") != std::string::npos) ++packed;
        }
        const int least = name == "floor" ? 4 : name == "sqrt" ? 2 : 10;
        EXPECT_GE(packed, least) << name << ": the loop was not vectorised";
    }
}

TEST(DetMath, EveryFunctionVectorisesForTheBaselineInstructionSet) {
#if defined(SAHEL_DET_BASE_OBJECT)
    expect_packed(SAHEL_DET_BASE_OBJECT, false);
#else
    GTEST_SKIP() << "sanitizer build or not an x86-64 machine";
#endif
}

TEST(DetMath, EveryFunctionVectorisesForV3) {
#if defined(SAHEL_DET_V3_OBJECT)
    expect_packed(SAHEL_DET_V3_OBJECT, true);
#else
    GTEST_SKIP() << "sanitizer build or not an x86-64 machine";
#endif
}

} // namespace
} // namespace sahel
