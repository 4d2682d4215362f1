#pragma once

#include "world/result.h"

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <ostream>
#include <span>
#include <string>
#include <vector>

/// Hostile input. A target takes any bytes where a program of ours takes a file of the outside world, and promises: no
/// crash, no leak, no read beyond the bytes; an answer, or an error of one line. One file a target:
///
///     SAHEL_FUZZ_TARGET(exr_tile, seeds_of_exr_tile) {     // std::span<const uint8_t> bytes
///         ...
///     }
///
/// It is driven in two ways: mutate.cpp runs a fixed number of mutations of the seeds as a test (SAHEL_LONG_TESTS=1:
/// many more), and a build with SAHEL_FUZZ=ON (clang) makes fuzz_exr_tile, a libFuzzer program:
///
///     cmake --preset asan -DCMAKE_CXX_COMPILER=clang++ -DSAHEL_FUZZ=ON && cmake --build build/asan --target
///     fuzz_exr_tile build/asan/tests/fuzz/fuzz_exr_tile -max_total_time=600 corpus/
namespace sahel::fuzz {

using Bytes = std::vector<uint8_t>;

struct Target {
    const char* name;
    void (*run)(std::span<const uint8_t> bytes);
    std::vector<Bytes> (*seeds)();
};
/// Names of tests hold the target's, not its addresses.
inline void PrintTo(const Target& target, std::ostream* out) {
    *out << target.name;
}
/// Every target of this program, by name.
std::vector<Target>& targets();
struct Registered {
    explicit Registered(const Target& target) { targets().push_back(target); }
};

inline Bytes bytes_of(std::string_view text) {
    return {text.begin(), text.end()};
}
inline std::string_view text_of(std::span<const uint8_t> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// What does not hold ends the process, so that libFuzzer and the test both see it.
inline void expect(bool holds, const char* what) {
    if (holds) return;
    std::fprintf(stderr, "fuzz: does not hold: %s\n", what);
    std::abort();
}
inline void expect_one_line(const Error& error) {
    expect(!error.message.empty(), "an error has a message");
    expect(error.message.find('\n') == std::string::npos, "an error is one line");
}

/// A folder for targets that read files; removed when the program ends.
const std::filesystem::path& scratch_folder();

} // namespace sahel::fuzz

#if defined(SAHEL_LIBFUZZER)
#define SAHEL_FUZZ_ENTRY(target)                                                                                       \
    extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {                                          \
        ::sahel::fuzz::run_##target({data, size});                                                                     \
        return 0;                                                                                                      \
    }
#else
#define SAHEL_FUZZ_ENTRY(target)
#endif
#define SAHEL_FUZZ_TARGET(target, seed_function)                                                                       \
    namespace sahel::fuzz {                                                                                            \
    static void run_##target(std::span<const uint8_t> bytes);                                                          \
    static const Registered registered_##target{{#target, run_##target, seed_function}};                               \
    }                                                                                                                  \
    SAHEL_FUZZ_ENTRY(target)                                                                                           \
    static void sahel::fuzz::run_##target(std::span<const uint8_t> bytes)
