#include "world/params_json.h"

#include <fmt/format.h>

#include <cstdlib>
#include <set>
#include <vector>

namespace sahel {

Result<Json> parse_json(std::string_view text, std::string_view where) {
    std::vector<std::set<std::string>> open_objects;
    std::string repeated;
    const auto watch = [&](int, Json::parse_event_t event, Json& value) {
        if (event == Json::parse_event_t::object_start) open_objects.emplace_back();
        if (event == Json::parse_event_t::object_end) open_objects.pop_back();
        if (event == Json::parse_event_t::key && !open_objects.back().insert(value.get<std::string>()).second &&
            repeated.empty())
            repeated = value.get<std::string>();
        return true;
    };
    try {
        Json parsed = Json::parse(text.begin(), text.end(), watch);
        if (!repeated.empty())
            return Error{ErrorKind::usage,
                         fmt::format("{}: the key '{}' is given twice in one object", where, repeated)};
        return parsed;
    } catch (const Json::exception& e) {
        // "[json.exception.parse_error.101] parse error at line 3, column 5: ...": what follows the bracket is for
        // people.
        std::string_view what = e.what();
        if (const size_t end = what.find("] "); end != std::string_view::npos) what.remove_prefix(end + 2);
        return Error{ErrorKind::corrupt, fmt::format("{}: not valid JSON: {}", where, what)};
    }
}

std::string json_description(const Json& value) {
    switch (value.type()) {
    case Json::value_t::null:
        return "null";
    case Json::value_t::object:
        return "an object";
    case Json::value_t::array:
        return "an array";
    case Json::value_t::string: {
        const auto text = value.get<std::string>();
        return fmt::format("the text \"{}\"", text.size() > 40 ? text.substr(0, 40) + "..." : text);
    }
    default:
        return value.dump();
    }
}

double json_double(float value) {
    const double pretty = std::strtod(param_text(value).c_str(), nullptr);
    return static_cast<float>(pretty) == value ? pretty : static_cast<double>(value);
}

} // namespace sahel
