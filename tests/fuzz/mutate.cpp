#include "tests/fuzz/fuzz_target.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <random>
#include <unistd.h>

/// Runs every target over its seeds and a fixed number of mutations of them, always the same ones.
namespace sahel::fuzz {
namespace {

class Mutator {
  public:
    explicit Mutator(std::vector<Bytes> seeds) : seeds_(std::move(seeds)) {}

    Bytes next() {
        Bytes bytes = seeds_[below(seeds_.size())];
        for (size_t n = 1 + below(6); n > 0; --n) mutate(bytes);
        return bytes;
    }

  private:
    size_t below(size_t n) { return n == 0 ? 0 : random_() % n; }
    /// Headers matter most: half of the places lie in the first kilobyte.
    size_t place(const Bytes& bytes) { return below(below(2) ? bytes.size() : std::min<size_t>(bytes.size(), 1024)); }
    static std::ptrdiff_t off(size_t n) { return static_cast<std::ptrdiff_t>(n); }

    void mutate(Bytes& bytes) {
        static constexpr std::array<std::string_view, 18> k_words = {
            "-1",       "1e999", "4294967296", "9223372036854775808",
            "NaN",      "null",  "\"\"",       "[]",
            "{}",       "true",  "[[[[",       "\\u0000",
            "\xC3\x28", "0.1",   ",",          "\"a\":",
            "}",        "0000"};
        static constexpr std::array<uint64_t, 8> k_numbers = {0,          1,          0x7F,       0xFF,
                                                              0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x7FFFFFFFFFFFFFFF};
        if (bytes.empty()) return bytes.push_back(static_cast<uint8_t>(random_()));
        const size_t at = place(bytes);
        const size_t length = std::min(1 + below(below(4) ? 8 : 400), bytes.size() - at);
        switch (below(10)) {
        case 0:
            bytes[at] ^= static_cast<uint8_t>(1u << below(8));
            break;
        case 1:
            bytes[at] = static_cast<uint8_t>(random_());
            break;
        case 2: { // a number where a size or an offset may stand
            uint64_t value = k_numbers[below(k_numbers.size())];
            std::array<uint8_t, 8> raw{};
            std::memcpy(raw.data(), &value, 8);
            if (below(2)) std::reverse(raw.begin(), raw.begin() + 4);
            const size_t width = std::min<size_t>(size_t{1} << below(4), bytes.size() - at);
            std::copy_n(raw.begin(), width, bytes.begin() + off(at));
            break;
        }
        case 3:
            bytes.erase(bytes.begin() + off(at), bytes.begin() + off(at + length));
            break;
        case 4: {
            const Bytes piece(bytes.begin() + off(at), bytes.begin() + off(at + length));
            bytes.insert(bytes.begin() + off(at), piece.begin(), piece.end());
            break;
        }
        case 5:
            bytes.resize(at);
            break;
        case 6: { // the end of another seed
            const Bytes& other = seeds_[below(seeds_.size())];
            bytes.resize(at);
            bytes.insert(bytes.end(), other.begin() + off(std::min(at, other.size())), other.end());
            break;
        }
        case 7:
            std::fill_n(bytes.begin() + off(at), length, static_cast<uint8_t>(below(2) ? 0 : 0xFF));
            break;
        default: { // a word in the place of another, for text
            const std::string_view word = k_words[below(k_words.size())];
            const auto is_word = [](uint8_t c) { return std::isalnum(c) || c == '-' || c == '.' || c == '_'; };
            size_t end = at;
            while (end < bytes.size() && is_word(bytes[end])) ++end;
            bytes.erase(bytes.begin() + off(at), bytes.begin() + off(end));
            bytes.insert(bytes.begin() + off(at), word.begin(), word.end());
        }
        }
    }

    std::vector<Bytes> seeds_;
    std::mt19937_64 random_{20260131};
};

/// Which input it was: mutations are the same in every run.
volatile int current = -1;
void say_which(int) {
    char text[64];
    const int n = std::snprintf(text, sizeof text, "fuzz: mutation %d\n", current);
    if (n > 0 && write(STDERR_FILENO, text, static_cast<size_t>(n)) < 0) _exit(1);
}

class Fuzz : public testing::TestWithParam<Target> {};

TEST_P(Fuzz, MutationsOfTheSeeds) {
    const Target& target = GetParam();
    const std::vector<Bytes> seeds = target.seeds();
    ASSERT_FALSE(seeds.empty());
    for (const Bytes& seed : seeds) target.run(seed);
    target.run({});
    Mutator mutator(seeds);
    std::signal(SIGABRT, say_which);
    const int count = std::getenv("SAHEL_LONG_TESTS") ? 40000 : 600;
    for (int i = 0; i < count; ++i) {
        current = i;
        const Bytes input = mutator.next(); // its own allocation: the sanitizers see a read beyond it
        target.run(input);
    }
    std::signal(SIGABRT, SIG_DFL);
}

INSTANTIATE_TEST_SUITE_P(Targets, Fuzz, testing::ValuesIn(targets()),
                         [](const auto& target) { return std::string(target.param.name); });

} // namespace
} // namespace sahel::fuzz
