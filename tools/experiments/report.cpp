#include "render/contact_sheet.h"
#include "tools/experiments/experiment.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace sahel::experiments {

namespace {

std::string short_number(double v) {
    if (!std::isfinite(v)) return std::isnan(v) ? "nan" : (v > 0 ? "inf" : "-inf");
    if (v != 0.0 && std::abs(v) < 1.0e-3) return fmt::format("{:.2e}", v);
    if (v == std::floor(v) && std::abs(v) < 1.0e7) return fmt::format("{:.0f}", v);
    return fmt::format("{:.4g}", v);
}

} // namespace

bool Number::holds() const {
    return (!low || value >= *low) && (!high || value <= *high);
}

std::string Number::value_text() const {
    return unit.empty() ? short_number(value) : short_number(value) + " " + unit;
}

std::string Number::bound_text() const {
    if (low && high)
        return *low == *high ? "= " + short_number(*low) : short_number(*low) + " to " + short_number(*high);
    if (low) return ">= " + short_number(*low);
    if (high) return "<= " + short_number(*high);
    return {};
}

void Report::tell(std::string name, double value, std::string unit, std::string note) {
    numbers.push_back({std::move(name), value, std::move(unit), std::nullopt, std::nullopt, std::move(note)});
}

void Report::require(std::string name, double value, std::string unit, std::optional<double> low,
                     std::optional<double> high, std::string note) {
    SAHEL_CHECK(low || high);
    numbers.push_back({std::move(name), value, std::move(unit), low, high, std::move(note)});
}

void Report::require_where(bool binds, std::string name, double value, std::string unit, std::optional<double> low,
                           std::optional<double> high, std::string note) {
    if (binds)
        require(std::move(name), value, std::move(unit), low, high, std::move(note));
    else
        tell(std::move(name), value, std::move(unit), std::move(note));
}

void Report::require_true(std::string name, bool so, std::string note) {
    numbers.push_back({std::move(name), so ? 1.0 : 0.0, "", 1.0, 1.0, std::move(note)});
}

bool Report::holds() const {
    return failed() == 0;
}

int Report::failed() const {
    return static_cast<int>(
        std::count_if(numbers.begin(), numbers.end(), [](const Number& n) { return n.bounded() && !n.holds(); }));
}

nlohmann::ordered_json report_json(const Experiment& e, const Setup& setup, const Report& report) {
    nlohmann::ordered_json j;
    j["experiment"] = e.name;
    j["shows"] = e.shows;
    j["source"] = e.source;
    j["quick"] = setup.quick;
    j["size_cells"] = setup.extent.size_cells;
    j["steps"] = setup.extent.steps;
    j["holds"] = report.holds();
    auto& numbers = j["numbers"] = nlohmann::ordered_json::array();
    for (const Number& n : report.numbers) {
        nlohmann::ordered_json row;
        row["name"] = n.name;
        row["value"] = std::isfinite(n.value) ? nlohmann::ordered_json(n.value) : nlohmann::ordered_json(nullptr);
        row["unit"] = n.unit;
        if (n.low) row["low"] = *n.low;
        if (n.high) row["high"] = *n.high;
        if (n.bounded()) row["holds"] = n.holds();
        if (!n.note.empty()) row["note"] = n.note;
        numbers.push_back(std::move(row));
    }
    auto& tables = j["tables"] = nlohmann::ordered_json::array();
    for (const Table& t : report.tables)
        tables.push_back({{"title", t.title}, {"columns", t.columns}, {"rows", t.rows}});
    return j;
}

std::string report_text(const Experiment& e, const Setup& setup, const Report& report) {
    std::string out = fmt::format("{}: {}\n{}; {}form, {} cells, {} steps\n", e.name, e.shows, e.source,
                                  setup.quick ? "quick " : "full ", setup.extent.size_cells, setup.extent.steps);
    size_t name_width = 0, value_width = 0, bound_width = 0;
    for (const Number& n : report.numbers) {
        name_width = std::max(name_width, n.name.size());
        value_width = std::max(value_width, n.value_text().size());
        bound_width = std::max(bound_width, n.bound_text().size());
    }
    for (const Number& n : report.numbers) {
        std::string line = fmt::format("  {:<{}}  {:>{}}  {:<{}}  {}", n.name, name_width, n.value_text(), value_width,
                                       n.bound_text(), bound_width,
                                       !n.bounded() ? "    "
                                       : n.holds()  ? "pass"
                                                    : "FAIL");
        if (!n.note.empty()) line += "  " + n.note;
        while (!line.empty() && line.back() == ' ') line.pop_back();
        out += line + "\n";
    }
    for (const Table& t : report.tables) {
        out += "  " + t.title + "\n";
        std::vector<size_t> widths;
        for (size_t c = 0; c < t.columns.size(); ++c) {
            size_t w = t.columns[c].size();
            for (const auto& row : t.rows)
                if (c < row.size()) w = std::max(w, row[c].size());
            widths.push_back(w);
        }
        const auto print = [&](const std::vector<std::string>& row) {
            std::string line = "   ";
            for (size_t c = 0; c < row.size() && c < widths.size(); ++c)
                line += c == 0 ? fmt::format(" {:<{}}", row[c], widths[c]) : fmt::format("  {:>{}}", row[c], widths[c]);
            while (!line.empty() && line.back() == ' ') line.pop_back();
            out += line + "\n";
        };
        print(t.columns);
        for (const auto& row : t.rows) print(row);
    }
    const auto bounds =
        std::count_if(report.numbers.begin(), report.numbers.end(), [](const Number& n) { return n.bounded(); });
    out += report.holds() ? fmt::format("  all {} bounds hold\n", bounds)
                          : fmt::format("  {} of {} bounds do not hold\n", report.failed(), bounds);
    return out;
}

Result<Image> report_sheet(const Experiment& e, const Report& report) {
    std::vector<ContactSheetItem> items;
    for (const Picture& p : report.pictures) items.push_back({&p.image, p.caption});
    ContactSheetOptions options;
    options.columns = std::min(report.columns, static_cast<int>(items.size()));
    options.cell_width_px = report.picture_px;
    options.title =
        fmt::format("{}: {} ({})", e.name, e.shows,
                    report.holds() ? "all bounds hold" : fmt::format("{} bounds do not hold", report.failed()));
    return make_contact_sheet(items, options);
}

} // namespace sahel::experiments
