#include "tools/report_ledger.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <numeric>

namespace sahel::tools {

namespace {

int64_t sum_of(const LayerAccount::Borders& borders) {
    return std::accumulate(borders.begin(), borders.end(), int64_t{0});
}

nlohmann::ordered_json account_json(const LayerAccount& a, bool borders) {
    nlohmann::ordered_json json;
    json["opening"] = a.opening;
    for (size_t i = 0; i < a.sources.size(); ++i) json[std::string(k_ledger_source_names[i])] = a.sources[i];
    json["converted"] = a.converted();
    json["to_sleeping"] = sum_of(a.to_frozen);
    json["to_open"] = sum_of(a.to_open);
    if (borders) {
        json["exchanged_by_border"] = a.exchanged;
        json["to_sleeping_by_border"] = a.to_frozen;
        json["to_open_by_border"] = a.to_open;
    } else {
        json["exchanged"] = sum_of(a.exchanged);
    }
    json["closing"] = a.closing;
    return json;
}

bool touched(const LayerAccount& a) {
    return !(a == LayerAccount{});
}

} // namespace

std::string ledger_text(const LedgerBook& book, const std::array<int64_t, k_conserved_count>* waiting) {
    if (book.tiles().empty()) return {};
    std::string text =
        fmt::format("{:<14}{:>18}{:>16}{:>16}{:>14}{:>14}{:>14}{:>18}\n", "ledger, ticks", "opening", "inbox",
                    "supplied", "converted", "to sleeping", waiting ? "waiting" : "to open", "closing");
    std::array<int64_t, k_ledger_group_count> residual{};
    for (const SimLayer layer : k_ledger_layers) {
        const LayerAccount a = book.total(layer);
        residual[static_cast<size_t>(group_of(layer))] += a.converted();
        if (!touched(a)) continue;
        const auto source = [&](LedgerSource s) { return a.sources[static_cast<size_t>(s)]; };
        text +=
            fmt::format("{:<14}{:>18}{:>16}{:>16}{:>14}{:>14}{:>14}{:>18}\n", info_of(layer).name, a.opening,
                        source(LedgerSource::inbox),
                        source(LedgerSource::supply_added) + source(LedgerSource::supply_removed), a.converted(),
                        sum_of(a.to_frozen), waiting ? (*waiting)[ledger_index(layer)] : sum_of(a.to_open), a.closing);
    }
    text += fmt::format("residual      solids {}, waters {}\n", residual[0], residual[1]);
    return text;
}

nlohmann::ordered_json ledger_json(const LedgerBook& book, const LedgerCheck& check, bool tiles) {
    nlohmann::ordered_json json;
    json["unit"] = "ticks of 2^-17 m on one cell";
    json["closed"] = check.closed();
    if (!check.closed()) json["problem"] = check.text;
    for (int g = 0; g < k_ledger_group_count; ++g)
        json["residual"][std::string(k_ledger_group_names[static_cast<size_t>(g)])] =
            check.total[static_cast<size_t>(g)];
    json["layers"] = nlohmann::ordered_json::object();
    for (const SimLayer layer : k_ledger_layers)
        json["layers"][std::string(info_of(layer).name)] = account_json(book.total(layer), false);
    if (!tiles) return json;
    json["borders"] = "east, south-east, south, south-west, west, north-west, north, north-east; out is positive";
    json["tiles"] = nlohmann::ordered_json::array();
    for (const auto& [key, tile] : book.tiles()) {
        nlohmann::ordered_json row;
        row["x"] = key.x;
        row["y"] = key.y;
        for (int g = 0; g < k_ledger_group_count; ++g)
            row["residual"][std::string(k_ledger_group_names[static_cast<size_t>(g)])] =
                tile.residual(static_cast<LedgerGroup>(g));
        for (const SimLayer layer : k_ledger_layers)
            if (touched(tile.of(layer)))
                row["layers"][std::string(info_of(layer).name)] = account_json(tile.of(layer), true);
        json["tiles"].push_back(std::move(row));
    }
    return json;
}

} // namespace sahel::tools
