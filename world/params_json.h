#pragma once

#include "world/json_fwd.h"
#include "world/params.h"

#include <nlohmann/json.hpp>

#include <limits>
#include <string_view>

/// Parameter structs to and from JSON objects, by their field table. Reading is strict: an unknown key, a wrong type or
/// a value out of range is a usage error that names `where` (the file), the key and the range; a missing key keeps its
/// default. Objects keep the order of the table, because people read them.
namespace sahel {

/// Parses a whole text. Errors: corrupt, with line and column; a key given twice in one object.
Result<Json> parse_json(std::string_view text, std::string_view where);

/// "a number", "an object", "the text \"abc\"": what a wrong value is, for messages.
std::string json_description(const Json& value);

/// A float as the double whose shortest text is the float's own ("0.05", not "0.05000000074505806") and which rounds
/// back to the very same float.
double json_double(float value);

template <class Struct> Json params_to_json(const Struct& values) {
    Json object = Json::object();
    for_each_field<Struct>([&](const auto& field) {
        using T = typename std::remove_cvref_t<decltype(field)>::value_type;
        if constexpr (std::is_same_v<T, float>)
            object[std::string(field.name)] = json_double(values.*field.member);
        else
            object[std::string(field.name)] = values.*field.member;
    });
    return object;
}

namespace detail {

/// Reads one value into `out`; the range is checked before the value is narrowed to the member's type.
template <class Struct, class T>
Status read_param(const Field<Struct, T>& field, const Json& value, std::string_view where, std::string_view key,
                  T& out) {
    const auto wrong_type = [&] { return type_error(where, key, json_description(value), field_text(field)); };
    const auto out_of_range = [&] { return range_error(where, key, value.dump(), field_text(field)); };
    if constexpr (std::is_same_v<T, bool>) {
        if (!value.is_boolean()) return wrong_type();
        out = value.template get<bool>();
        if (!in_range(field, out)) return out_of_range();
    } else if constexpr (std::is_integral_v<T>) {
        if (!value.is_number_integer()) return wrong_type();
        const bool fits = value.is_number_unsigned() ? std::in_range<T>(value.template get<uint64_t>())
                                                     : std::in_range<T>(value.template get<int64_t>());
        if (!fits || !in_range(field, value.template get<T>())) return out_of_range();
        out = value.template get<T>();
    } else if constexpr (std::is_floating_point_v<T>) {
        if (!value.is_number()) return wrong_type();
        const auto wide = value.template get<double>();
        const auto narrow = static_cast<T>(wide);
        // The bounds are T: 0.1 in a file is in a range that starts at 0.1f. A double too large for T becomes infinite.
        if (!in_range(field, narrow)) return out_of_range();
        out = narrow;
    } else {
        if (!value.is_string()) return wrong_type();
        out = value.template get<std::string>();
        if (!in_range(field, out)) return out_of_range();
    }
    return {};
}

} // namespace detail

/// The struct with the values of `object` over `defaults`. `group` prefixes the keys in messages.
template <class Struct>
Result<Struct> params_from_json(const Json& object, std::string_view where, std::string_view group = {},
                                Struct defaults = {}) {
    if (!object.is_object())
        return Error{ErrorKind::usage, std::string(where) + ": '" + std::string(group.empty() ? "the file" : group) +
                                           "' must be an object, not " + json_description(object)};
    for (const auto& item : object.items()) {
        const std::string key = param_key(group, item.key());
        bool known = false;
        Status status;
        for_each_field<Struct>([&](const auto& field) {
            if (known || field.name != item.key()) return;
            known = true;
            status = detail::read_param(field, item.value(), where, key, defaults.*field.member);
        });
        if (!known) return unknown_key_error(where, key, field_names<Struct>());
        SAHEL_TRY(status);
    }
    return defaults;
}

} // namespace sahel
