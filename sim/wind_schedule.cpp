#include "sim/wind_schedule.h"

#include "world/det_math.h"
#include "world/params.h"
#include "world/params_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace sahel {

namespace {

constexpr double k_rounding = 1e-12; // what a few operations in double may lose, as a share
constexpr std::array<std::string_view, 3> k_columns{"time_s", "speed_m_per_s", "angle_deg"};

struct Range {
    double min, max;
    [[nodiscard]] bool contains(double v) const { return v >= min && v <= max; }
    [[nodiscard]] std::string text() const {
        return std::isinf(max) ? fmt::format("at least {}", min) : fmt::format("{} to {}", min, max);
    }
};

Range range_of(size_t column) {
    Range range{0.0, std::numeric_limits<double>::infinity()};
    for_each_field<WindParams>([&](const auto& field) {
        if constexpr (std::is_same_v<typename std::remove_cvref_t<decltype(field)>::value_type, float>) {
            if ((column == 1 && field.member == &WindParams::speed_m_per_s) ||
                (column == 2 && field.member == &WindParams::angle_deg))
                range = {static_cast<double>(field.min), static_cast<double>(field.max)};
        }
    });
    return range;
}

Error usage(std::string message) {
    return {ErrorKind::usage, std::move(message)};
}

std::string_view trimmed(std::string_view s) {
    const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!s.empty() && blank(s.front())) s.remove_prefix(1);
    while (!s.empty() && blank(s.back())) s.remove_suffix(1);
    return s;
}

std::vector<std::string_view> split(std::string_view line) {
    std::vector<std::string_view> cells;
    for (size_t from = 0; from <= line.size();) {
        const size_t comma = std::min(line.find(',', from), line.size());
        cells.push_back(trimmed(line.substr(from, comma - from)));
        from = comma + 1;
    }
    return cells;
}

// What a series lasts when nobody says so.
double natural_length(const std::vector<WindSchedule::Row>& rows) {
    if (rows.size() < 2) return 1.0;
    return rows.back().start_s + (rows.back().start_s - rows[rows.size() - 2].start_s);
}

Status check_next_time(const std::vector<WindSchedule::Row>& rows, double time_s, const std::string& at) {
    if (rows.empty() && time_s != 0.0) return usage(fmt::format("{}: the first time_s is {}, not 0", at, time_s));
    if (!rows.empty() && !(time_s > rows.back().start_s))
        return usage(fmt::format("{}: time_s {} is not after {}", at, time_s, rows.back().start_s));
    return {};
}

// t modulo length, where a time that is short of a whole number of lengths by rounding alone counts as that number.
double phase_of(double time_s, double length_s) {
    const double turns = time_s / length_s;
    const double whole = std::floor(turns + k_rounding * (1.0 + std::abs(turns)));
    return std::max(time_s - whole * length_s, 0.0);
}

} // namespace

WindVector vector_of(const WindNow& now) {
    const float quarter = det::floor(now.angle_deg / 90.0f + 0.5f);
    const float rest = (now.angle_deg - 90.0f * quarter) * (det::k_pi / 180.0f);
    const float c = now.speed_m_per_s * det::cos(rest);
    const float s = rest == 0.0f ? 0.0f : now.speed_m_per_s * det::sin(rest);
    switch (static_cast<int>(quarter) & 3) {
    case 0:
        return {c, s};
    case 1:
        return {0.0f - s, c};
    case 2:
        return {0.0f - c, 0.0f - s};
    default:
        return {s, 0.0f - c};
    }
}

Result<WindSchedule> WindSchedule::from_rows(std::vector<Row> rows, double length_s) {
    if (rows.empty()) return usage("a wind series has no rows");
    std::vector<Row> before;
    for (size_t i = 0; i < rows.size(); ++i) {
        const std::string at = fmt::format("row {} of a wind series", i);
        if (!std::isfinite(rows[i].start_s)) return usage(fmt::format("{}: time_s is not a finite number", at));
        SAHEL_TRY(check_next_time(before, rows[i].start_s, at));
        const std::array<double, 2> values{rows[i].wind.speed_m_per_s, rows[i].wind.angle_deg};
        for (size_t k = 0; k < 2; ++k)
            if (!range_of(k + 1).contains(values[k]))
                return usage(fmt::format("{}: {} is {}, which is not {}", at, k_columns[k + 1], values[k],
                                         range_of(k + 1).text()));
        before.push_back(rows[i]);
    }
    if (!std::isfinite(length_s) || !(length_s > rows.back().start_s))
        return usage(fmt::format("a wind series of {} s ends before its last row begins, at {} s", length_s,
                                 rows.back().start_s));
    WindSchedule schedule{WindParams{}};
    schedule.rows_ = std::move(rows);
    schedule.length_s_ = length_s;
    return schedule;
}

Result<WindSchedule> WindSchedule::from_csv(std::string_view text, std::string_view where) {
    std::array<size_t, 3> place{}; // of each column in a line
    bool headed = false;
    std::vector<Row> rows;
    double length_s = 0.0;
    int number = 0;
    for (size_t from = 0; from < text.size();) {
        const size_t end = std::min(text.find('\n', from), text.size());
        const std::string_view line = trimmed(text.substr(from, end - from));
        from = end + 1;
        ++number;
        if (line.empty() || line.front() == '#') continue;
        const std::string at = fmt::format("{}: line {}", where, number);
        const std::vector<std::string_view> cells = split(line);
        if (cells.size() != 3)
            return usage(fmt::format("{}: {} columns instead of 3 (time_s,speed_m_per_s,angle_deg)", at, cells.size()));
        if (!headed) {
            for (size_t c = 0; c < 3; ++c) {
                const auto found = std::find(cells.begin(), cells.end(), k_columns[c]);
                if (found == cells.end())
                    return usage(fmt::format("{}: the header has no column '{}'", at, k_columns[c]));
                place[c] = static_cast<size_t>(found - cells.begin());
            }
            headed = true;
            continue;
        }
        if (length_s > 0.0) return usage(fmt::format("{}: a line after the one that ends the series", at));
        std::array<double, 3> values{};
        const bool ends = cells[place[1]].empty() && cells[place[2]].empty();
        for (size_t c = 0; c < (ends ? 1u : 3u); ++c) {
            const std::string_view cell = cells[place[c]];
            const auto [stop, fault] = std::from_chars(cell.data(), cell.data() + cell.size(), values[c]);
            if (fault != std::errc() || stop != cell.data() + cell.size() || !std::isfinite(values[c]))
                return usage(fmt::format("{}: {} is '{}', which is not a number", at, k_columns[c], cell));
            if (!range_of(c).contains(values[c]))
                return usage(
                    fmt::format("{}: {} is {}, which is not {}", at, k_columns[c], values[c], range_of(c).text()));
        }
        SAHEL_TRY(check_next_time(rows, values[0], at));
        if (ends && rows.empty()) return usage(fmt::format("{}: speed_m_per_s and angle_deg are missing", at));
        if (ends)
            length_s = values[0];
        else
            rows.push_back({values[0], {static_cast<float>(values[1]), static_cast<float>(values[2])}});
    }
    if (rows.empty()) return usage(fmt::format("{}: no rows of wind", where));
    if (!(length_s > 0.0)) length_s = natural_length(rows);
    return from_rows(std::move(rows), length_s);
}

Result<WindSchedule> WindSchedule::from_json(std::string_view text, std::string_view where) {
    SAHEL_ASSIGN(const Json json, parse_json(text, where));
    const auto number = [&](const Json& object, const std::string& at, size_t column) -> Result<double> {
        const std::string key(k_columns[column]);
        if (!object.contains(key)) return usage(fmt::format("{}: {}.{} is missing", where, at, key));
        const Json& value = object.at(key);
        if (!value.is_number())
            return usage(fmt::format("{}: {}.{} must be a number, not {}", where, at, key, json_description(value)));
        const auto v = value.get<double>();
        if (!range_of(column).contains(v))
            return usage(fmt::format("{}: {}.{} is {}, which is not {}", where, at, key, v, range_of(column).text()));
        return v;
    };
    const Json* list = &json;
    double length_s = 0.0;
    if (json.is_object()) {
        constexpr std::array<std::string_view, 2> keys{"length_s", "rows"};
        for (const auto& item : json.items())
            if (std::find(keys.begin(), keys.end(), item.key()) == keys.end())
                return unknown_key_error(where, item.key(), keys);
        if (!json.contains("rows")) return usage(fmt::format("{}: rows is missing", where));
        list = &json.at("rows");
        if (json.contains("length_s")) {
            const Json& value = json.at("length_s");
            if (!value.is_number() || !(value.get<double>() > 0.0))
                return usage(fmt::format("{}: length_s must be a number above 0, not {}", where, value.dump()));
            length_s = value.get<double>();
        }
    }
    if (!list->is_array())
        return usage(fmt::format("{}: rows must be an array, not {}", where, json_description(*list)));
    std::vector<Row> rows;
    for (const Json& object : *list) {
        const std::string at = fmt::format("rows[{}]", rows.size());
        if (!object.is_object())
            return usage(fmt::format("{}: {} must be an object, not {}", where, at, json_description(object)));
        for (const auto& item : object.items())
            if (std::find(k_columns.begin(), k_columns.end(), item.key()) == k_columns.end())
                return unknown_key_error(where, at + "." + item.key(), k_columns);
        SAHEL_ASSIGN(const double time_s, number(object, at, 0));
        SAHEL_ASSIGN(const double speed, number(object, at, 1));
        SAHEL_ASSIGN(const double angle, number(object, at, 2));
        SAHEL_TRY(check_next_time(rows, time_s, fmt::format("{}: {}", where, at)));
        rows.push_back({time_s, {static_cast<float>(speed), static_cast<float>(angle)}});
    }
    if (rows.empty()) return usage(fmt::format("{}: no rows of wind", where));
    if (length_s > 0.0 && !(length_s > rows.back().start_s))
        return usage(
            fmt::format("{}: length_s {} is not after the last row, at {} s", where, length_s, rows.back().start_s));
    if (!(length_s > 0.0)) length_s = natural_length(rows);
    return from_rows(std::move(rows), length_s);
}

double WindSchedule::time_of(int64_t step, float step_s) {
    return static_cast<double>(step) * json_double(step_s); // 0.1f means a tenth
}

WindNow WindSchedule::at(double time_s) const {
    if (!rows_.empty()) {
        const double phase = phase_of(time_s, length_s_);
        const double due = phase + k_rounding * (std::abs(time_s) + length_s_);
        const auto after =
            std::upper_bound(rows_.begin(), rows_.end(), due, [](double t, const Row& row) { return t < row.start_s; });
        return (after == rows_.begin() ? rows_.front() : *(after - 1)).wind;
    }
    const WindNow first{params_.speed_m_per_s, params_.angle_deg};
    if (!params_.bidirectional) return first;
    const double period = json_double(params_.period_s);
    const double cycle = params_.strength_based ? 2.0 * period : (json_double(params_.ratio) + 1.0) * period;
    const double phase = phase_of(time_s, cycle);
    if (phase + k_rounding * (std::abs(time_s) + cycle) >= period) return first;
    return {params_.strength_based ? first.speed_m_per_s / params_.ratio : first.speed_m_per_s,
            params_.second_angle_deg};
}

} // namespace sahel
