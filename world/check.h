#pragma once

#include <sstream>
#include <string>
#include <type_traits>

/// Checks for our own bugs. A failed check prints the expression, both values and the place, then aborts.
/// What the outside world can cause (files, disks, arguments, memory) is a Result instead (result.h).
namespace sahel {

[[noreturn]] void check_failed(const char* file, int line, const char* expression, const std::string& values);
[[noreturn]] void check_failed(const char* file, int line, const char* expression);

namespace detail {

// Numbers are printed out of line: kernels that are compiled for several instruction sets must not leave a template
// behind that all of them would share (cpu_features.h).
[[noreturn]] void check_failed_integers(const char* file, int line, const char* expression, unsigned long long a,
                                        bool a_signed, unsigned long long b, bool b_signed);
[[noreturn]] void check_failed_reals(const char* file, int line, const char* expression, double a, double b);

template <class A, class B>
[[noreturn]] inline __attribute__((always_inline)) void
check_failed_op(const char* file, int line, const char* expression, const A& a, const B& b) {
    if constexpr (std::is_integral_v<A> && std::is_integral_v<B>) {
        check_failed_integers(file, line, expression, static_cast<unsigned long long>(a), std::is_signed_v<A>,
                              static_cast<unsigned long long>(b), std::is_signed_v<B>);
    } else if constexpr (std::is_arithmetic_v<A> && std::is_arithmetic_v<B>) {
        check_failed_reals(file, line, expression, static_cast<double>(a), static_cast<double>(b));
    } else {
        std::ostringstream out;
        out << a << " against " << b;
        check_failed(file, line, expression, out.str());
    }
}

} // namespace detail
} // namespace sahel

#if defined(__CUDA_ARCH__)
#define SAHEL_CHECK(condition) ((void)0)
#define SAHEL_CHECK_OP(a, op, b) ((void)0)
#else
#define SAHEL_CHECK(condition)                                                                                         \
    do {                                                                                                               \
        if (!(condition)) ::sahel::check_failed(__FILE__, __LINE__, #condition);                                       \
    } while (false)
#define SAHEL_CHECK_OP(a, op, b)                                                                                       \
    do {                                                                                                               \
        const auto& sahel_a = (a);                                                                                     \
        const auto& sahel_b = (b);                                                                                     \
        if (!(sahel_a op sahel_b))                                                                                     \
            ::sahel::detail::check_failed_op(__FILE__, __LINE__, #a " " #op " " #b, sahel_a, sahel_b);                 \
    } while (false)
#endif

#define SAHEL_CHECK_EQ(a, b) SAHEL_CHECK_OP(a, ==, b)
#define SAHEL_CHECK_LT(a, b) SAHEL_CHECK_OP(a, <, b)
#define SAHEL_CHECK_LE(a, b) SAHEL_CHECK_OP(a, <=, b)

/// Debug-only forms, for inner loops.
#if defined(SAHEL_DEBUG)
#define SAHEL_DCHECK(condition) SAHEL_CHECK(condition)
#define SAHEL_DCHECK_EQ(a, b) SAHEL_CHECK_EQ(a, b)
#define SAHEL_DCHECK_LT(a, b) SAHEL_CHECK_LT(a, b)
#define SAHEL_DCHECK_LE(a, b) SAHEL_CHECK_LE(a, b)
#else
#define SAHEL_DCHECK(condition) ((void)0)
#define SAHEL_DCHECK_EQ(a, b) ((void)0)
#define SAHEL_DCHECK_LT(a, b) ((void)0)
#define SAHEL_DCHECK_LE(a, b) ((void)0)
#endif
