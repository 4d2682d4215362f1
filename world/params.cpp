#include "world/params.h"

#include <fmt/format.h>

#include <algorithm>

namespace sahel {

std::string param_text(bool value) {
    return value ? "true" : "false";
}
std::string param_text(int64_t value) {
    return fmt::format("{}", value);
}
std::string param_text(uint64_t value) {
    return fmt::format("{}", value);
}
std::string param_text(float value) {
    return fmt::format("{}", value);
}
std::string param_text(double value) {
    return fmt::format("{}", value);
}
std::string param_text(const std::string& value) {
    return value;
}

std::string FieldText::range() const {
    if (min.empty()) return {};
    if (type == "text") return fmt::format("{} to {} characters", min, max);
    return unit.empty() ? fmt::format("{} to {}", min, max) : fmt::format("{} to {} {}", min, max, unit);
}

std::string param_key(std::string_view group, std::string_view name) {
    return group.empty() ? std::string(name) : fmt::format("{}.{}", group, name);
}

std::string markdown_table(std::span<const FieldText> rows, std::string_view group) {
    // A "|" inside a cell would end it.
    const auto cell = [](std::string_view text) {
        std::string out;
        for (const char c : text) {
            if (c == '|') out += '\\';
            out += c;
        }
        return out;
    };
    std::string out = "| Name | Default | Unit | Range | Meaning |\n|---|---|---|---|---|\n";
    for (const FieldText& row : rows) {
        const std::string range = row.min.empty() ? row.type : row.min + " to " + row.max;
        out += fmt::format("| `{}` | {} | {} | {} | {} |\n", param_key(group, row.name), cell(row.default_value),
                           cell(row.unit), range, cell(row.help));
    }
    return out;
}

namespace {
// Optimal string alignment distance: insert, delete, replace, swap two neighbours. Names are short.
size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<size_t> before(b.size() + 1);
    std::vector<size_t> last(b.size() + 1);
    std::vector<size_t> row(b.size() + 1);
    for (size_t j = 0; j <= b.size(); ++j) last[j] = j;
    for (size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (size_t j = 1; j <= b.size(); ++j) {
            const size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = std::min(row[j], before[j - 2] + 1);
        }
        std::swap(before, last);
        std::swap(last, row);
    }
    return last[b.size()];
}
} // namespace

std::string_view nearest_name(std::string_view name, std::span<const std::string_view> known) {
    std::string_view best;
    size_t best_distance = 0;
    for (const std::string_view candidate : known) {
        const size_t longer = std::max(name.size(), candidate.size());
        const size_t shorter = std::min(name.size(), candidate.size());
        const size_t allowed = std::max<size_t>(1, (longer + 1) / 3);
        if (longer > 200 || longer - shorter > allowed) continue;
        const size_t distance = edit_distance(name, candidate);
        if (distance <= allowed && (best.empty() || distance < best_distance)) {
            best = candidate;
            best_distance = distance;
        }
    }
    return best;
}

Error range_error(std::string_view where, std::string_view key, std::string_view value, const FieldText& field) {
    return {ErrorKind::usage, fmt::format("{}: '{}' is {}, outside its range {}", where, key, value, field.range())};
}

Error type_error(std::string_view where, std::string_view key, std::string_view found, const FieldText& field) {
    const std::string range = field.range();
    return {ErrorKind::usage, fmt::format("{}: '{}' must be {}{}{}{}, not {}", where, key,
                                          field.type == "true or false" || field.type == "text" ? ""
                                          : field.type == "integer"                             ? "an "
                                                                                                : "a ",
                                          field.type, range.empty() ? "" : ", ", range, found)};
}

Error unknown_key_error(std::string_view where, std::string_view key, std::span<const std::string_view> known) {
    const size_t dot = key.rfind('.');
    const std::string_view name = dot == std::string_view::npos ? key : key.substr(dot + 1);
    if (const std::string_view near = nearest_name(name, known); !near.empty())
        return {ErrorKind::usage, fmt::format("{}: unknown key '{}'; did you mean '{}'?", where, key, near)};
    return {ErrorKind::usage, fmt::format("{}: unknown key '{}'; known keys: {}", where, key, fmt::join(known, ", "))};
}

} // namespace sahel
