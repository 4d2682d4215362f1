#include "sim/ledger.h"

#include <fmt/format.h>

#include <numeric>

namespace sahel {

namespace {

int64_t sum_of(const LayerAccount::Borders& borders) {
    return std::accumulate(borders.begin(), borders.end(), int64_t{0});
}

std::string tile_text(TileKey key) {
    return fmt::format("tile {},{}", key.x, key.y);
}

constexpr const char* k_direction_names[k_direction_count] = {"east", "south-east", "south", "south-west",
                                                              "west", "north-west", "north", "north-east"};

// The residuals of tiles.
template <class Tiles> void check_tiles(const Tiles& tiles, LedgerCheck& check) {
    for (const TileAccount& tile : tiles) {
        bool open = false;
        for (int g = 0; g < k_ledger_group_count; ++g) {
            const int64_t residual = tile.residual(static_cast<LedgerGroup>(g));
            if (residual == 0) continue;
            open = true;
            if (!check.text.empty()) continue;
            check.text = fmt::format("the ledger does not close: {} of {} {} by {} ticks (",
                                     k_ledger_group_names[static_cast<size_t>(g)], tile_text(tile.key),
                                     residual > 0 ? "grew" : "shrank", std::abs(residual));
            const char* separator = "";
            for (const SimLayer layer : k_ledger_layers) {
                if (group_of(layer) != static_cast<LedgerGroup>(g) || tile.of(layer).converted() == 0) continue;
                check.text += fmt::format("{}{} {:+}", separator, info_of(layer).name, tile.of(layer).converted());
                separator = ", ";
            }
            check.text += ")";
        }
        check.tiles_open += open;
    }
}

void add_border(LedgerCheck& check, const BorderResidual& b) {
    check.borders.push_back(b);
    if (!check.text.empty()) return;
    check.text = b.inbox
                     ? fmt::format("the ledger does not close: {} ticks of {} that left {} to the {} are not in "
                                   "the inbox there",
                                   b.ticks, info_of(b.layer).name, tile_text(b.tile), k_direction_names[b.direction])
                     : fmt::format("the ledger does not close: the two sides of the {} border of {} differ by "
                                   "{} ticks of {}",
                                   k_direction_names[b.direction], tile_text(b.tile), b.ticks, info_of(b.layer).name);
}

} // namespace

size_t ledger_index(SimLayer layer) {
    for (size_t i = 0; i < k_ledger_layers.size(); ++i)
        if (k_ledger_layers[i] == layer) return i;
    SAHEL_CHECK(k_conserved_layers.contains(layer));
    return 0;
}

int64_t LayerAccount::added() const {
    return std::accumulate(sources.begin(), sources.end(), int64_t{0});
}

int64_t LayerAccount::outflow() const {
    return sum_of(exchanged) + sum_of(to_frozen) + sum_of(to_open);
}

void LayerAccount::add(const LayerAccount& o) {
    opening += o.opening;
    closing += o.closing;
    for (size_t i = 0; i < sources.size(); ++i) sources[i] += o.sources[i];
    for (size_t k = 0; k < k_direction_count; ++k) {
        exchanged[k] += o.exchanged[k];
        to_frozen[k] += o.to_frozen[k];
        to_open[k] += o.to_open[k];
    }
}

int64_t TileAccount::residual(LedgerGroup group) const {
    int64_t sum = 0;
    for (const SimLayer layer : k_ledger_layers)
        if (group_of(layer) == group) sum += of(layer).converted();
    return sum;
}

Status TileAccount::append(const TileAccount& later) {
    SAHEL_CHECK(key == later.key);
    for (const SimLayer layer : k_ledger_layers) {
        LayerAccount& mine = of(layer);
        const LayerAccount& next = later.of(layer);
        if (mine.closing != next.opening)
            return Error{ErrorKind::corrupt,
                         fmt::format("{}: {} ticks of {} when its last run ended, {} now: something else than a run "
                                     "changed it",
                                     tile_text(key), mine.closing, info_of(layer).name, next.opening)};
    }
    for (const SimLayer layer : k_ledger_layers) {
        LayerAccount& mine = of(layer);
        const int64_t opening = mine.opening;
        mine.add(later.of(layer));
        mine.opening = opening;
        mine.closing = later.of(layer).closing;
    }
    return {};
}

Result<Ledger> Ledger::open(TileDomain& domain) {
    Ledger ledger;
    SAHEL_TRY(domain.keep_flows());
    for (const TileKey& key : domain.layout().tiles) ledger.tiles_.push_back({key, {}});
    ledger.partners_.resize(ledger.tiles_.size());
    for (int32_t slot = 0; slot < domain.slots(); ++slot)
        for (int k = 0; k < k_direction_count; ++k)
            ledger.partners_[static_cast<size_t>(slot)][static_cast<size_t>(k)] = domain.plan().partner(slot, k);
    for (const SimLayer layer : k_ledger_layers) {
        if (!domain.layers().contains(layer)) continue;
        ledger.counted_.insert(layer);
        SAHEL_ASSIGN(const std::vector<int64_t> sums, domain.sums(layer));
        for (size_t slot = 0; slot < sums.size(); ++slot) {
            LayerAccount& account = ledger.tiles_[slot].of(layer);
            account.opening = account.closing = sums[slot];
        }
    }
    return ledger;
}

void Ledger::arrived(int32_t slot, SimLayer layer, int64_t ticks) {
    LayerAccount& account = tiles_[static_cast<size_t>(slot)].of(layer);
    account.opening -= ticks;
    account.sources[static_cast<size_t>(LedgerSource::inbox)] += ticks;
}

void Ledger::untouched(int32_t slot, SimLayer layer, int64_t ticks) {
    SAHEL_CHECK(!counted_.contains(layer));
    LayerAccount& account = tiles_[static_cast<size_t>(slot)].of(layer);
    account.opening = account.closing = ticks;
}

Status Ledger::close(const TileDomain& domain) {
    SAHEL_CHECK_EQ(static_cast<size_t>(domain.slots()), tiles_.size());
    inboxes_.clear();
    const FrameIndex frame = domain.frame();
    for (const SimLayer layer : k_ledger_layers) {
        if (!counted_.contains(layer)) continue;
        SAHEL_ASSIGN(const std::vector<int64_t> sums, domain.sums(layer));
        SAHEL_ASSIGN(const auto flows, domain.flows(layer));
        for (int32_t slot = 0; slot < domain.slots(); ++slot) {
            const auto s = static_cast<size_t>(slot);
            LayerAccount& account = tiles_[s].of(layer);
            account.closing = sums[s];
            for (int i = 0; i < k_ledger_source_count; ++i)
                if (const auto source = static_cast<LedgerSource>(i); source != LedgerSource::inbox)
                    account.sources[static_cast<size_t>(i)] = domain.source(source, layer, slot);
            LayerAccount::Borders waiting{};
            SAHEL_ASSIGN(const std::vector<int32_t> inbox, domain.inbox(slot, layer));
            if (!inbox.empty()) {
                for (int k = 0; k < k_direction_count; ++k) {
                    const LocalRect r = domain.plan().segment(k);
                    for (int32_t y = r.y0; y < r.y1; ++y)
                        for (int32_t x = r.x0; x < r.x1; ++x)
                            waiting[static_cast<size_t>(k)] += inbox[static_cast<size_t>(frame.of(x, y))];
                }
            }
            for (size_t k = 0; k < k_direction_count; ++k) {
                const Border border = domain.plan().border(slot, static_cast<int>(k));
                auto& borders = is_live(border)            ? account.exchanged
                                : border == Border::frozen ? account.to_frozen
                                                           : account.to_open;
                borders[k] = flows[s][k];
                if (border == Border::frozen && waiting[k] != flows[s][k])
                    inboxes_.push_back({tiles_[s].key, static_cast<int>(k), layer, flows[s][k] - waiting[k], true});
            }
        }
    }
    return {};
}

LedgerCheck Ledger::check() const {
    LedgerCheck check;
    check_tiles(tiles_, check);
    for (size_t slot = 0; slot < tiles_.size(); ++slot)
        for (size_t k = 0; k < k_direction_count; ++k) {
            const BorderPartner partner = partners_[slot][k];
            if (partner.slot < 0) continue;
            const auto other = static_cast<size_t>(partner.slot);
            const auto back = static_cast<size_t>(partner.direction);
            if (other < slot || (other == slot && back < k)) continue; // seen from the other side
            for (const SimLayer layer : k_ledger_layers) {
                const int64_t here = tiles_[slot].of(layer).exchanged[k];
                const int64_t there = tiles_[other].of(layer).exchanged[back];
                if (here + there != 0)
                    add_border(check, {tiles_[slot].key, static_cast<int>(k), layer, here + there, false});
            }
        }
    for (const BorderResidual& b : inboxes_) add_border(check, b);
    for (const TileAccount& tile : tiles_)
        for (const SimLayer layer : k_ledger_layers) {
            const LayerAccount& a = tile.of(layer);
            check.total[static_cast<size_t>(group_of(layer))] +=
                a.closing - a.opening - a.added() + sum_of(a.to_frozen) + sum_of(a.to_open);
        }
    return check;
}

Status LedgerBook::append(std::span<const TileAccount> run) {
    for (const TileAccount& tile : run) {
        const auto found = tiles_.find(tile.key);
        if (found == tiles_.end())
            tiles_.emplace(tile.key, tile);
        else
            SAHEL_TRY(found->second.append(tile));
    }
    return {};
}

LayerAccount LedgerBook::total(SimLayer layer) const {
    LayerAccount sum;
    for (const auto& [key, tile] : tiles_) sum.add(tile.of(layer));
    return sum;
}

LedgerCheck LedgerBook::check(const std::array<int64_t, k_conserved_count>& waiting) const {
    LedgerCheck check;
    std::vector<TileAccount> list;
    list.reserve(tiles_.size());
    for (const auto& [key, tile] : tiles_) list.push_back(tile);
    check_tiles(list, check);
    for (const TileAccount& tile : list)
        for (int k = 0; k < k_direction_count; ++k) {
            const TileKey there{0, tile.key.x + direction_x(k), tile.key.y + direction_y(k)};
            const auto found = tiles_.find(there);
            if (found != tiles_.end() && k >= 4) continue; // seen from the other side
            for (const SimLayer layer : k_ledger_layers) {
                int64_t sum = tile.of(layer).exchanged[static_cast<size_t>(k)];
                if (found != tiles_.end()) sum += found->second.of(layer).exchanged[static_cast<size_t>(k ^ 4)];
                if (sum != 0) add_border(check, {tile.key, k, layer, sum, false});
            }
        }
    for (const SimLayer layer : k_ledger_layers) {
        const LayerAccount sum = total(layer);
        const int64_t waits = waiting[ledger_index(layer)];
        const int64_t arrived = sum.sources[static_cast<size_t>(LedgerSource::inbox)];
        check.total[static_cast<size_t>(group_of(layer))] +=
            sum.closing - sum.opening - (sum.added() - arrived) + sum_of(sum.to_open) + waits;
        const int64_t lost = sum_of(sum.to_frozen) - arrived - waits;
        if (lost != 0 && check.text.empty())
            check.text = fmt::format("the ledger does not close: of the {} that left for sleeping tiles {} ticks have "
                                     "neither arrived nor wait there",
                                     info_of(layer).name, lost);
    }
    return check;
}

} // namespace sahel
