#pragma once

#include "world/result.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

/// Parameters, declared once: a plain struct with defaults, and one table that gives every member a name, a unit, a
/// range and a line of help. JSON, the command line, the panels and the reference pages are folds over that table
/// (params_json.h, params_cli.h).
///
///     struct TalusParams { float repose_slope = 0.6f; int sweeps = 1; };
///     template <> inline constexpr auto sahel::fields_of<TalusParams> = std::tuple{
///         Field{&TalusParams::repose_slope, "repose_slope", "m/m", 0.1f, 2.0f, "Steepest slope that holds"},
///         Field{&TalusParams::sweeps, "sweeps", "", 1, 16, "Sweeps per step"},
///     };
///     static_assert(sahel::covers_every_member<TalusParams>);
namespace sahel {

template <class Struct, class T>
struct Field {
    using value_type = T;
    T Struct::*member;
    std::string_view name;
    std::string_view unit;
    T min;
    T max;
    std::string_view help;
};
template <class Struct, class T, class Min, class Max>
Field(T Struct::*, const char*, const char*, Min, Max, const char*) -> Field<Struct, T>;

template <class Struct>
inline constexpr auto fields_of = nullptr;

template <class Struct>
inline constexpr bool has_fields = !std::is_same_v<std::remove_cv_t<decltype(fields_of<Struct>)>, std::nullptr_t>;

/// Calls f(field) for every row of the table.
template <class Struct, class F>
constexpr void for_each_field(F&& f) {
    std::apply([&](const auto&... field) { (f(field), ...); }, fields_of<Struct>);
}

namespace detail {
struct AnyValue {
    template <class T>
    constexpr operator T() const; // NOLINT(google-explicit-constructor)
};
template <class T, class... A>
constexpr size_t member_count() {
    if constexpr (requires { T{A{}..., AnyValue{}}; })
        return member_count<T, A..., AnyValue>();
    else
        return sizeof...(A);
}
} // namespace detail

/// The table has as many rows as the struct has members: adding a member without a row does not compile.
template <class Struct>
inline constexpr bool covers_every_member =
    detail::member_count<Struct>() == std::tuple_size_v<std::remove_cv_t<decltype(fields_of<Struct>)>>;

/// First value out of its range, as an error that names `where`, the key, the value and the range.
template <class Struct>
Status check_ranges(const Struct& values, std::string_view where);

} // namespace sahel
