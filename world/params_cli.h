#pragma once

#include "world/param_overrides.h"
#include "world/params.h"

#include <CLI/CLI.hpp>

#include <charconv>
#include <string>
#include <string_view>

/// Parameter structs on the command line: `--terrain.canyon_m=80`, one option per row of the field table.
namespace sahel {

namespace detail {

template <class T> bool parse_param(std::string_view text, T& out) {
    if constexpr (std::is_same_v<T, std::string>) {
        out = text;
        return true;
    } else if constexpr (std::is_same_v<T, bool>) {
        out = text == "true" || text == "1" || text == "on" || text == "yes";
        return out || text == "false" || text == "0" || text == "off" || text == "no";
    } else {
        if (text.starts_with('+')) text.remove_prefix(1);
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
        // An integer too large for the type, and a number too large or too small for it, are refused here.
        return error == std::errc{} && end == text.data() + text.size();
    }
}

} // namespace detail

/// Adds `--group.name=VALUE` to `app` for every field; help shows meaning, range and default (of `defaults`). A wrong
/// value ends parsing with a CLI::ValidationError that names the option and its range. `overrides` must outlive
/// parsing.
template <class Struct>
void add_params_options(CLI::App& app, std::string group, ParamOverrides<Struct>& overrides,
                        const Struct& defaults = {}) {
    for_each_field<Struct>([&](const auto& field) {
        using T = typename std::remove_cvref_t<decltype(field)>::value_type;
        const std::string option_name = "--" + param_key(group, field.name);
        const FieldText text = field_text(field, defaults);
        const auto take = [&overrides, field, option_name, text](const CLI::results_t& given) {
            T value{};
            if (!detail::parse_param(given.back(), value))
                throw CLI::ValidationError(
                    type_error("command line", option_name, "\"" + given.back() + "\"", text).message);
            if (!in_range(field, value))
                throw CLI::ValidationError(range_error("command line", option_name, given.back(), text).message);
            overrides.add(field.member, value);
            return true;
        };
        const std::string range = text.range();
        CLI::Option* option = app.add_option(option_name, take, text.help + (range.empty() ? "" : "; " + range));
        option->type_name(std::is_same_v<T, std::string> ? "TEXT"
                          : std::is_same_v<T, bool>      ? "BOOL"
                          : std::is_integral_v<T>        ? "INT"
                                                         : "NUMBER");
        option->default_str(text.default_value.empty() ? "\"\"" : text.default_value);
        option->group(group.empty() ? std::string("Parameters") : "Parameters of " + group);
        option->expected(1);
    });
}

} // namespace sahel
