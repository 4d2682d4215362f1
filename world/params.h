#pragma once

#include "world/result.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

/// Parameters, declared once: a plain struct with defaults, and one table that gives every member a name, a unit, a
/// range and a line of help. JSON, the command line, the panels and the reference pages are folds over that table
/// (params_json.h, params_cli.h, params_markdown below).
///
///     struct TalusParams { float repose_slope = 0.6f; int sweeps = 1; };
///     template <> inline constexpr auto sahel::fields_of<TalusParams> = std::tuple{
///         Field{&TalusParams::repose_slope, "repose_slope", "m/m", 0.1f, 2.0f, "Steepest slope that holds"},
///         Field{&TalusParams::sweeps, "sweeps", "", 1, 16, "Sweeps per step"},
///     };
///     static_assert(sahel::covers_every_member<TalusParams> && sahel::defaults_in_range<TalusParams>);
///
/// Members may be bool, any integer, float, double or std::string; the range of a string is that of its length.
namespace sahel {

template <class T>
concept ParamValue = std::is_arithmetic_v<T> || std::is_same_v<T, std::string>;

template <class Struct, ParamValue T> struct Field {
    using value_type = T;
    using bound_type = std::conditional_t<std::is_same_v<T, std::string>, size_t, T>;
    T Struct::*member;
    std::string_view name;
    std::string_view unit;
    bound_type min;
    bound_type max;
    std::string_view help;
};
template <class Struct, class T, class Min, class Max>
Field(T Struct::*, const char*, const char*, Min, Max, const char*) -> Field<Struct, T>;

template <class Struct> inline constexpr auto fields_of = nullptr;

template <class Struct>
inline constexpr bool has_fields = !std::is_same_v<std::remove_cv_t<decltype(fields_of<Struct>)>, std::nullptr_t>;

/// Calls f(field) for every row of the table.
template <class Struct, class F> constexpr void for_each_field(F&& f) {
    std::apply([&](const auto&... field) { (f(field), ...); }, fields_of<Struct>);
}

/// Not-a-number is in no range.
template <class Struct, class T> constexpr bool in_range(const Field<Struct, T>& field, const T& value) {
    if constexpr (std::is_same_v<T, std::string>)
        return value.size() >= field.min && value.size() <= field.max;
    else
        return value >= field.min && value <= field.max;
}

namespace detail {

struct AnyValue {
    template <class T> constexpr operator T() const; // NOLINT(google-explicit-constructor)
};
template <class T, class... A> constexpr size_t member_count() {
    if constexpr (requires { T{A{}..., AnyValue{}}; })
        return member_count<T, A..., AnyValue>();
    else
        return sizeof...(A);
}

template <class Struct> constexpr bool table_is_sound() {
    bool sound = true;
    size_t i = 0;
    for_each_field<Struct>([&](const auto& a) {
        if (a.name.empty() || a.help.empty() || !(a.min <= a.max)) sound = false;
        size_t j = 0;
        for_each_field<Struct>([&](const auto& b) {
            if (j++ <= i) return;
            if (a.name == b.name) sound = false;
            if constexpr (std::is_same_v<decltype(a), decltype(b)>)
                if (a.member == b.member) sound = false;
        });
        ++i;
    });
    return sound;
}

template <class Struct> constexpr bool default_values_in_range() {
    const Struct defaults{};
    bool inside = true;
    for_each_field<Struct>([&](const auto& field) { inside = inside && in_range(field, defaults.*field.member); });
    return inside;
}

} // namespace detail

/// The table has one sound row for each member: adding a member without a row does not compile. (Counting works by
/// aggregate initialisation: no base classes, no array members.)
template <class Struct>
inline constexpr bool covers_every_member =
    detail::member_count<Struct>() ==
    std::tuple_size_v<std::remove_cv_t<decltype(fields_of<Struct>)>>&& detail::table_is_sound<Struct>();

/// For structs of numbers alone (a std::string member is no constant expression).
template <class Struct> inline constexpr bool defaults_in_range = detail::default_values_in_range<Struct>();

// --- text
// ---------------------------------------------------------------------------------------------------------------

/// Shortest text that reads back as the same value.
std::string param_text(bool value);
std::string param_text(int64_t value);
std::string param_text(uint64_t value);
std::string param_text(float value);
std::string param_text(double value);
std::string param_text(const std::string& value);
template <class T>
requires(std::is_integral_v<T> && !std::is_same_v<T, bool>) std::string param_text(T value) {
    if constexpr (std::is_signed_v<T>)
        return param_text(static_cast<int64_t>(value));
    else
        return param_text(static_cast<uint64_t>(value));
}

/// One row of a table as text, for help and reference pages.
struct FieldText {
    std::string name;
    std::string type; ///< "number", "integer", "true or false", "text"
    std::string unit;
    std::string default_value;
    std::string min, max; ///< empty for true or false
    std::string help;

    /// "0.1 to 2 m/m", "0 to 64 characters", or empty.
    [[nodiscard]] std::string range() const;
};

template <class T> constexpr std::string_view param_type_name() {
    if constexpr (std::is_same_v<T, bool>)
        return "true or false";
    else if constexpr (std::is_integral_v<T>)
        return "integer";
    else if constexpr (std::is_floating_point_v<T>)
        return "number";
    else
        return "text";
}

template <class Struct, class T> FieldText field_text(const Field<Struct, T>& field, const Struct& defaults = {}) {
    FieldText text{.name = std::string(field.name),
                   .type = std::string(param_type_name<T>()),
                   .unit = std::string(field.unit),
                   .default_value = param_text(defaults.*field.member),
                   .min = {},
                   .max = {},
                   .help = std::string(field.help)};
    if constexpr (!std::is_same_v<T, bool>) {
        text.min = param_text(field.min);
        text.max = param_text(field.max);
    }
    return text;
}

template <class Struct> std::vector<FieldText> field_texts(const Struct& defaults = {}) {
    std::vector<FieldText> rows;
    for_each_field<Struct>([&](const auto& field) { rows.push_back(field_text(field, defaults)); });
    return rows;
}

template <class Struct> std::vector<std::string_view> field_names() {
    std::vector<std::string_view> names;
    for_each_field<Struct>([&](const auto& field) { names.push_back(field.name); });
    return names;
}

/// The rows as a Markdown table (name, default, unit, range, meaning); names are prefixed with "group." if not empty.
std::string markdown_table(std::span<const FieldText> rows, std::string_view group = {});

template <class Struct> std::string params_markdown(std::string_view group = {}) {
    return markdown_table(field_texts<Struct>(), group);
}

// --- errors
// -------------------------------------------------------------------------------------------------------------

/// `where` names the file or the command line; `key` is the full key, for example "terrain.canyon_m". All are usage.
Error range_error(std::string_view where, std::string_view key, std::string_view value, const FieldText& field);
Error type_error(std::string_view where, std::string_view key, std::string_view found, const FieldText& field);
/// Names the nearest known key, or lists the known ones where none is near.
Error unknown_key_error(std::string_view where, std::string_view key, std::span<const std::string_view> known);

/// "group.name", or the name alone without a group.
std::string param_key(std::string_view group, std::string_view name);

/// The nearest of the known names within about a third of its letters (Damerau-Levenshtein distance); empty if none.
std::string_view nearest_name(std::string_view name, std::span<const std::string_view> known);

/// First value out of its range, as a usage error that names `where`, the key, the value and the range.
template <class Struct> Status check_ranges(const Struct& values, std::string_view where, std::string_view group = {}) {
    Status status;
    for_each_field<Struct>([&](const auto& field) {
        if (status.ok() && !in_range(field, values.*field.member))
            status =
                range_error(where, param_key(group, field.name), param_text(values.*field.member), field_text(field));
    });
    return status;
}

} // namespace sahel
