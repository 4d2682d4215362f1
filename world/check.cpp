#include "world/check.h"

#include <cstdio>
#include <cstdlib>

namespace sahel {

void check_failed(const char* file, int line, const char* expression, const std::string& values) {
    std::fprintf(stderr, "%s:%d: check failed: %s%s%s\n", file, line, expression, values.empty() ? "" : "; values ",
                 values.c_str());
    std::fflush(stderr);
    std::abort();
}

void check_failed(const char* file, int line, const char* expression) {
    check_failed(file, line, expression, std::string());
}

void detail::check_failed_integers(const char* file, int line, const char* expression, unsigned long long a,
                                   bool a_signed, unsigned long long b, bool b_signed) {
    const auto text = [](unsigned long long v, bool is_signed) {
        return is_signed ? std::to_string(static_cast<long long>(v)) : std::to_string(v);
    };
    check_failed(file, line, expression, text(a, a_signed) + " against " + text(b, b_signed));
}

void detail::check_failed_reals(const char* file, int line, const char* expression, double a, double b) {
    std::ostringstream out;
    out.precision(17);
    out << a << " against " << b;
    check_failed(file, line, expression, out.str());
}

} // namespace sahel
