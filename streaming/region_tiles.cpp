#include "streaming/region_tiles.h"

#include "sim/ledger.h"

#include <fmt/format.h>

#include <limits>

namespace sahel {

namespace {

std::optional<SimLayer> sim_layer_of(Layer layer) {
    for (const SimLayerInfo& info : k_sim_layers)
        if (info.world == layer) return info.layer;
    return std::nullopt;
}

// Of the block's first row on, all rows: tiles are whole cache lines wide.
int32_t* cells_of(LayerBlock& block, Layer layer) {
    const auto first = [](auto view) {
        SAHEL_CHECK_EQ(view.stride, static_cast<int64_t>(view.width()));
        return reinterpret_cast<int32_t*>(view.row(0));
    };
    return info_of(layer).type == LayerType::real ? first(block.reals(layer)) : first(block.ints(layer));
}

Status add_waiting(const World& world, const Inbox& inbox, LayerBlock& block) {
    const int32_t n = world.desc().tile_cells;
    FieldView<int32_t> view = block.ints(inbox.layer);
    for (const InboxCell& c : inbox.cells) {
        int32_t& cell = view(c.cell % n, c.cell / n);
        const int64_t sum = cell + c.ticks;
        if (sum > std::numeric_limits<int32_t>::max() || sum < std::numeric_limits<int32_t>::min())
            return Error{ErrorKind::corrupt,
                         fmt::format("{}: {} that waits for tile {},{} would pile up beyond 16 km",
                                     world.folder().string(), info_of(inbox.layer).name, inbox.key.x, inbox.key.y)};
        cell = static_cast<int32_t>(sum);
    }
    return {};
}

} // namespace

Result<LoadedTile> load_tile(const World& world, TileDomain& domain, int32_t slot, MemoryPool& pool) {
    const int32_t n = domain.tile_cells();
    const TileKey key = domain.layout().tiles[static_cast<size_t>(slot)];
    LoadedTile loaded;
    SAHEL_ASSIGN(LayerBlock block, LayerBlock::allocate(0, tile_rect(key, n), 0, k_state_layers, pool));
    SAHEL_TRY(world.surface().read(block));
    SAHEL_ASSIGN(loaded.taken, world.inboxes(key));
    for (const Inbox& inbox : loaded.taken) {
        SAHEL_TRY(add_waiting(world, inbox, block));
        const auto layer = sim_layer_of(inbox.layer);
        SAHEL_CHECK(layer.has_value());
        for (const InboxCell& c : inbox.cells) loaded.arrived[*layer] += c.ticks;
    }
    std::vector<uint32_t> nothing;
    Status status;
    domain.layers().for_each([&](SimLayer layer) {
        const SimLayerInfo& info = info_of(layer);
        if (!status.ok() || info.role == SimRole::working) return;
        if (info.world) {
            status = domain.load(slot, layer, cells_of(block, *info.world));
        } else {
            nothing.resize(static_cast<size_t>(n) * static_cast<size_t>(n), 0);
            status = domain.load(slot, layer, nothing.data());
        }
    });
    SAHEL_TRY(status);
    for (const SimLayer layer : k_ledger_layers) {
        if (domain.layers().contains(layer)) continue;
        const int32_t* cells = cells_of(block, *info_of(layer).world);
        int64_t sum = 0;
        for (int64_t i = 0; i < int64_t{n} * n; ++i) sum += cells[i];
        loaded.untouched[layer] = sum;
    }
    return loaded;
}

Status load_rims(const World& world, TileDomain& domain, int32_t slot) {
    const int32_t n = domain.tile_cells();
    const TileKey key = domain.layout().tiles[static_cast<size_t>(slot)];
    for (int k = 0; k < k_direction_count; ++k) {
        if (domain.plan().border(slot, k) != Border::frozen) continue;
        const LocalRect r = domain.plan().segment(k);
        if (r.empty()) continue;
        const CellRect rect{key.x * n + r.x0, key.y * n + r.y0, key.x * n + r.x1, key.y * n + r.y1};
        SAHEL_ASSIGN(LayerBlock block, LayerBlock::allocate(0, rect, 0, k_state_layers));
        SAHEL_TRY(world.surface().read(block));
        std::vector<int32_t> cells(static_cast<size_t>(r.area()));
        Status status;
        domain.layers().for_each([&](SimLayer layer) {
            const SimLayerInfo& info = info_of(layer);
            if (!status.ok() || info.role == SimRole::working || info.outside != Outside::as_edge) return;
            std::fill(cells.begin(), cells.end(), 0);
            if (info.world) {
                const FieldView<const int32_t> view = std::as_const(block).ints(*info.world);
                auto to = cells.begin();
                for (int32_t y = 0; y < view.height(); ++y, to += view.width())
                    std::copy(view.row(y), view.row(y) + view.width(), to);
            }
            status = domain.load_frozen(slot, k, layer, cells.data());
        });
        SAHEL_TRY(status);
    }
    return {};
}

Status store_tile(const World& world, const TileDomain& domain, int32_t slot, const std::vector<Inbox>& taken,
                  LayerBlock& block) {
    const int32_t n = domain.tile_cells();
    const TileKey key = domain.layout().tiles[static_cast<size_t>(slot)];
    LayerSet lacking;
    block.layers().for_each([&](Layer layer) {
        const auto sim = sim_layer_of(layer);
        if (!sim || !domain.layers().contains(*sim)) lacking.insert(layer);
    });
    if (!lacking.empty()) {
        SAHEL_ASSIGN(LayerBlock rest, LayerBlock::allocate(0, block.owned(), 0, lacking));
        SAHEL_TRY(world.surface().read(rest));
        for (const Inbox& inbox : taken)
            if (lacking.contains(inbox.layer)) SAHEL_TRY(add_waiting(world, inbox, rest));
        lacking.for_each([&](Layer layer) {
            const int32_t* from = cells_of(rest, layer);
            std::copy(from, from + int64_t{n} * n, cells_of(block, layer));
        });
    }
    Status status;
    block.layers().for_each([&](Layer layer) {
        if (!status.ok() || lacking.contains(layer)) return;
        int32_t* cells = cells_of(block, layer);
        status = domain.store(slot, *sim_layer_of(layer), cells);
        if (!status.ok() || layer == Layer::bedrock || info_of(layer).type != LayerType::ticks) return;
        for (int64_t i = 0; i < int64_t{n} * n && status.ok(); ++i)
            if (cells[i] < 0)
                status = Error{ErrorKind::corrupt,
                               fmt::format("tile {},{}: {} ticks of {} at cell ({}, {}): less than nothing; the world "
                                           "stays as it was committed last",
                                           key.x, key.y, cells[i], info_of(layer).name, key.x * n + i % n,
                                           key.y * n + i / n)};
    });
    return status;
}

Status collect_inboxes(const TileDomain& domain, WaitingTicks& waiting) {
    const int32_t n = domain.tile_cells();
    const FrameIndex frame = domain.frame();
    for (const SimLayer layer : k_ledger_layers) {
        if (!domain.layers().contains(layer)) continue;
        for (int32_t slot = 0; slot < domain.slots(); ++slot) {
            SAHEL_ASSIGN(const std::vector<int32_t> inbox, domain.inbox(slot, layer));
            if (inbox.empty()) continue;
            const TileKey key = domain.layout().tiles[static_cast<size_t>(slot)];
            for (int k = 0; k < k_direction_count; ++k) {
                if (domain.plan().border(slot, k) != Border::frozen) continue;
                const LocalRect r = domain.plan().segment(k);
                const TileKey there{0, key.x + direction_x(k), key.y + direction_y(k)};
                for (int32_t y = r.y0; y < r.y1; ++y)
                    for (int32_t x = r.x0; x < r.x1; ++x) {
                        const int32_t ticks = inbox[static_cast<size_t>(frame.of(x, y))];
                        if (ticks == 0) continue;
                        const int32_t cell = (y - direction_y(k) * n) * n + x - direction_x(k) * n;
                        waiting[{there, *info_of(layer).world}][cell] += ticks;
                    }
            }
        }
    }
    return {};
}

std::vector<Inbox> inboxes_of(const WaitingTicks& waiting) {
    std::vector<Inbox> list;
    for (const auto& [place, cells] : waiting) {
        Inbox inbox{place.first, place.second, {}};
        for (const auto& [cell, ticks] : cells) inbox.cells.push_back({cell, ticks});
        list.push_back(std::move(inbox));
    }
    return list;
}

} // namespace sahel
