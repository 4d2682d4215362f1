#pragma once

#include <sstream>
#include <string>

/// Checks for our own bugs. A failed check prints the expression, both values and the place, then aborts.
/// What the outside world can cause (files, disks, arguments, memory) is a Result instead (result.h).
namespace sahel {

[[noreturn]] void check_failed(const char* file, int line, const char* expression, const std::string& values);

namespace detail {

template <class A, class B>
[[noreturn]] void check_failed_op(const char* file, int line, const char* expression, const A& a, const B& b) {
    std::ostringstream out;
    out << a << " against " << b;
    check_failed(file, line, expression, out.str());
}

} // namespace detail
} // namespace sahel

#if defined(__CUDA_ARCH__)
#define SAHEL_CHECK(condition) ((void)0)
#define SAHEL_CHECK_OP(a, op, b) ((void)0)
#else
#define SAHEL_CHECK(condition)                                                                                         \
    do {                                                                                                               \
        if (!(condition)) ::sahel::check_failed(__FILE__, __LINE__, #condition, "");                                   \
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
