#include "sim/tile_domain.h"

#include "sim/domain_cuda.h"
#include "world/cuda_runtime.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>

namespace sahel {

namespace {

constexpr int64_t k_row_words = 16; // rows start on a cache line

int64_t stride_of(const TileLayout& layout) {
    const int64_t width = layout.tile_cells + 2 * int64_t{layout.halo};
    return (width + k_row_words - 1) / k_row_words * k_row_words;
}

uint64_t mixed(uint64_t h) { // the finaliser of splitmix64
    h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9ull;
    h = (h ^ (h >> 27)) * 0x94D049BB133111EBull;
    return h ^ (h >> 31);
}

template <class T> Result<Buffer> to_device(MemoryPool& pool, const std::vector<T>& values) {
    if (values.empty()) return Buffer{};
    SAHEL_ASSIGN(Buffer buffer, Buffer::allocate(pool, values.size() * sizeof(T)));
    SAHEL_TRY(cuda::copy_to_device(buffer.data(), values.data(), buffer.bytes()));
    return buffer;
}

} // namespace

uint64_t TileDomain::slab_bytes(const TileLayout& layout, SimLayerSet layers) {
    const auto rows = static_cast<uint64_t>(layout.tile_cells + 2 * int64_t{layout.halo});
    return rows * static_cast<uint64_t>(stride_of(layout)) * 4u * layout.tiles.size() *
           static_cast<uint64_t>(layers.size());
}

Result<TileDomain> TileDomain::create(TileLayout layout, SimLayerSet layers, MemoryPool& pool) {
    if (layout.tile_cells <= 0 || layout.halo < 0 || layout.halo > layout.tile_cells)
        return Error{ErrorKind::usage,
                     fmt::format("a halo of {} cells around tiles of {} cells is not possible: the halo is "
                                 "at most one tile wide",
                                 layout.halo, layout.tile_cells)};
    TileDomain domain;
    domain.plan_ = ExchangePlan(layout);
    domain.layout_ = std::move(layout);
    domain.layers_ = layers;
    domain.pool_ = &pool;
    domain.device_ = pool.kind() == MemoryKind::cuda;
    domain.stride_ = stride_of(domain.layout_);
    domain.slot_stride_ = domain.stride_ * (domain.tile_cells() + 2 * int64_t{domain.halo()});
    domain.valid_.fill(k_nothing_valid);
    Status status;
    layers.for_each([&](SimLayer layer) {
        if (!status.ok()) return;
        auto slab = Buffer::allocate(pool, slab_bytes(domain.layout_, {layer}));
        if (!slab.ok()) {
            status = slab.error();
            return;
        }
        Buffer& buffer = domain.slabs_[static_cast<size_t>(layer)];
        buffer = std::move(slab).value();
        auto* words = static_cast<uint32_t*>(buffer.data());
        if (domain.device_)
            status = cuda::fill_words(words, static_cast<int64_t>(buffer.bytes() / 4), k_poison);
        else
            std::fill(words, words + buffer.bytes() / 4, k_poison);
    });
    SAHEL_TRY(status);
    for (const TileKey& key : domain.layout_.tiles) {
        domain.origins_.push_back(key.x * domain.tile_cells());
        domain.origins_.push_back(key.y * domain.tile_cells());
    }
    if (domain.device_) {
        const auto copies = domain.plan_.copies();
        const auto fills = domain.plan_.fills();
        SAHEL_ASSIGN(domain.device_origins_, to_device(pool, domain.origins_));
        SAHEL_ASSIGN(domain.device_copies_, to_device(pool, std::vector<HaloCopy>(copies.begin(), copies.end())));
        SAHEL_ASSIGN(domain.device_fills_, to_device(pool, std::vector<EdgeFill>(fills.begin(), fills.end())));
    }
    return domain;
}

SlabView<uint32_t> TileDomain::words(SimLayer layer) const {
    SAHEL_CHECK(layers_.contains(layer));
    auto* base = static_cast<uint32_t*>(slabs_[static_cast<size_t>(layer)].data());
    return {base + halo() * stride_ + halo(), stride_, slot_stride_, -halo(), tile_cells() + halo()};
}

CellPlaces TileDomain::places() const {
    CellPlaces p;
    p.origin = device_ ? static_cast<const int64_t*>(device_origins_.data()) : origins_.data();
    p.x0 = p.y0 = std::numeric_limits<int64_t>::min();
    p.x1 = p.y1 = std::numeric_limits<int64_t>::max();
    if (!layout_.bounded) return p;
    const int64_t n = tile_cells();
    p.x0 = layout_.tx0 * n;
    p.y0 = layout_.ty0 * n;
    p.x1 = layout_.tx1 * n;
    p.y1 = layout_.ty1 * n;
    p.period_x = layout_.west == Border::periodic ? p.x1 - p.x0 : 0;
    p.period_y = layout_.north == Border::periodic ? p.y1 - p.y0 : 0;
    p.wall_x0 = layout_.west == Border::wall;
    p.wall_x1 = layout_.east == Border::wall;
    p.wall_y0 = layout_.north == Border::wall;
    p.wall_y1 = layout_.south == Border::wall;
    return p;
}

void TileDomain::set_valid_halo(SimLayer layer, int32_t cells) {
    SAHEL_CHECK_LE(cells, halo());
    valid_[static_cast<size_t>(layer)] = cells;
}

void TileDomain::touch(SimLayerSet layers) {
    layers.for_each([&](SimLayer l) { set_valid_halo(l, std::min(valid_halo(l), 0)); });
}

Status TileDomain::load(int32_t slot, SimLayer layer, const void* cells) {
    const int32_t n = tile_cells();
    SlabView<uint32_t> slab = words(layer);
    const auto* from = static_cast<const uint32_t*>(cells);
    if (!device_) {
        for (int32_t y = 0; y < n; ++y) std::memcpy(slab.row(slot, y), from + int64_t{y} * n, size_t(n) * 4);
    } else { // whole rows, as the halo between them is stale anyway
        std::vector<uint32_t> rows(static_cast<size_t>(stride_) * static_cast<size_t>(n), k_poison);
        for (int32_t y = 0; y < n; ++y)
            std::memcpy(rows.data() + y * stride_ + halo(), from + int64_t{y} * n, size_t(n) * 4);
        SAHEL_TRY(cuda::copy_to_device(slab.row(slot, 0) - halo(), rows.data(), rows.size() * 4));
    }
    set_valid_halo(layer, 0);
    return {};
}

Status TileDomain::store(int32_t slot, SimLayer layer, void* cells) const {
    const int32_t n = tile_cells();
    SlabView<uint32_t> slab = words(layer);
    auto* to = static_cast<uint32_t*>(cells);
    if (!device_) {
        for (int32_t y = 0; y < n; ++y) std::memcpy(to + int64_t{y} * n, slab.row(slot, y), size_t(n) * 4);
        return {};
    }
    std::vector<uint32_t> rows(static_cast<size_t>(stride_) * static_cast<size_t>(n));
    SAHEL_TRY(cuda::copy_to_host(rows.data(), slab.row(slot, 0) - halo(), rows.size() * 4));
    for (int32_t y = 0; y < n; ++y) std::memcpy(to + int64_t{y} * n, rows.data() + y * stride_ + halo(), size_t(n) * 4);
    return {};
}

Status TileDomain::load_frozen(int32_t slot, int direction, SimLayer layer, const void* cells) {
    SAHEL_CHECK(plan_.border(slot, direction) == Border::frozen);
    const LocalRect rect = plan_.segment(direction);
    SlabView<uint32_t> slab = words(layer);
    const auto* from = static_cast<const uint32_t*>(cells);
    const int64_t width = rect.x1 - rect.x0;
    for (int32_t y = rect.y0; y < rect.y1; ++y, from += width) {
        uint32_t* row = slab.row(slot, y) + rect.x0;
        if (device_) {
            SAHEL_TRY(cuda::copy_to_device(row, from, static_cast<uint64_t>(width) * 4));
        } else {
            std::memcpy(row, from, static_cast<size_t>(width) * 4);
        }
    }
    return {};
}

Status TileDomain::exchange(SimLayerSet layers) {
    const auto copies = plan_.copies();
    int32_t longest = 0;
    int64_t cells = 0;
    for (const HaloCopy& c : copies) {
        longest = std::max(longest, static_cast<int32_t>(c.dst.area()));
        cells += c.dst.area();
    }
    std::vector<SimLayer> list;
    layers.for_each([&](SimLayer l) {
        SAHEL_CHECK_LE(0, valid_halo(l)); // owned cells must exist before they can be sent
        list.push_back(l);
    });
    if (device_) {
        for (const SimLayer layer : list)
            SAHEL_TRY(cuda::exchange(static_cast<const HaloCopy*>(device_copies_.data()),
                                     static_cast<int32_t>(copies.size()), longest, words(layer),
                                     info_of(layer).mirror));
    } else {
        const auto count = static_cast<int64_t>(copies.size());
        for_each_index("sim/exchange", cells * layers.size(), count * layers.size(), [&](int64_t i) {
            const HaloCopy& c = copies[static_cast<size_t>(i % count)];
            const SimLayer layer = list[static_cast<size_t>(i / count)];
            const SlabView<uint32_t> slab = words(layer);
            const Mirror mirror = info_of(layer).mirror;
            const int32_t width = c.dst.x1 - c.dst.x0;
            for (int32_t y = 0; y < c.dst.y1 - c.dst.y0; ++y) {
                uint32_t* to = slab.row(c.dst_slot, c.dst.y0 + y) + c.dst.x0;
                const uint32_t* from = slab.row(c.src_slot, c.src_y + y * c.step_y) + c.src_x;
                if (c.step_x > 0 && c.step_y > 0) {
                    std::memcpy(to, from, static_cast<size_t>(width) * 4);
                } else {
                    for (int32_t x = 0; x < width; ++x)
                        to[x] = mirrored_word(from[x * c.step_x], mirror, c.step_x < 0, c.step_y < 0);
                }
            }
        });
    }
    counts_.exchanges += 1;
    counts_.words += cells * layers.size();
    SAHEL_TRY(fill_edges(layers));
    for (const SimLayer l : list) set_valid_halo(l, halo());
    return {};
}

Status TileDomain::fill_edges(SimLayerSet layers) {
    const auto fills = plan_.fills();
    if (fills.empty()) return {};
    int32_t longest = 0;
    for (const EdgeFill& f : fills) longest = std::max(longest, static_cast<int32_t>(f.dst.area()));
    Status status;
    layers.for_each([&](SimLayer layer) { // in table order: the ground before the water
        if (!status.ok()) return;
        const EdgeRule rule =
            layer == SimLayer::water && layers_.contains({SimLayer::bedrock, SimLayer::soil, SimLayer::sand})
                ? EdgeRule::water
            : info_of(layer).outside == Outside::nothing ? EdgeRule::nothing
            : info_of(layer).outside == Outside::sealed  ? EdgeRule::sealed
                                                         : EdgeRule::as_edge;
        EdgeLayers e{words(layer), {}, {}, {}, rule, layout_.level_ticks};
        if (rule == EdgeRule::water) {
            e.bedrock = ints(SimLayer::bedrock);
            e.soil = ints(SimLayer::soil);
            e.sand = ints(SimLayer::sand);
        }
        if (device_) {
            status = cuda::fill_edges(static_cast<const EdgeFill*>(device_fills_.data()),
                                      static_cast<int32_t>(fills.size()), longest, e);
            return;
        }
        for (const EdgeFill& f : fills)
            for (int32_t y = f.dst.y0; y < f.dst.y1; ++y)
                for (int32_t x = f.dst.x0; x < f.dst.x1; ++x) e.fill(f, x, y);
    });
    return status;
}

const Launch& TileDomain::finished(CoverList& cover, const char* name) {
    Launch& l = cover.launch;
    if (l.items == nullptr && !cover.items.empty()) {
        l.bounds = cover.items.front().rect;
        for (const WorkItem& item : cover.items) {
            const LocalRect& r = item.rect;
            l.cells += r.area();
            l.bounds = {std::min(l.bounds.x0, r.x0), std::min(l.bounds.y0, r.y0), std::max(l.bounds.x1, r.x1),
                        std::max(l.bounds.y1, r.y1)};
        }
        l.items = cover.items.data();
        l.count = static_cast<int32_t>(cover.items.size());
        if (device_) {
            auto buffer = to_device(*pool_, cover.items);
            SAHEL_CHECK(buffer.ok());
            cover.device_items = std::move(buffer).value();
            l.device_items = static_cast<const WorkItem*>(cover.device_items.data());
        }
    }
    l.name = name;
    l.order = order_;
    return l;
}

const Launch& TileDomain::launch(int32_t margin, const char* name) {
    CoverList& cover = covers_[margin];
    if (cover.items.empty()) {
        std::vector<LocalRect> rects;
        for (int32_t slot = 0; slot < slots(); ++slot) {
            rects.clear();
            plan_.cover(slot, margin, rects);
            for (const LocalRect& r : rects) cover.items.push_back({slot, r});
        }
    }
    return finished(cover, name);
}

const Launch& TileDomain::frozen_launch(const char* name) {
    CoverList& cover = covers_[-1];
    if (cover.items.empty() && halo() > 0)
        for (int32_t slot = 0; slot < slots(); ++slot)
            for (int k = 0; k < k_direction_count; ++k)
                if (plan_.border(slot, k) == Border::frozen) cover.items.push_back({slot, plan_.segment(k)});
    return finished(cover, name);
}

Result<std::vector<int64_t>> TileDomain::sums(SimLayer layer) const {
    SAHEL_CHECK(info_of(layer).type == LayerType::ticks);
    std::vector<int64_t> out(static_cast<size_t>(slots()), 0);
    const SlabView<const int32_t> slab = ints(layer);
    const int32_t n = tile_cells();
    if (device_) {
        SAHEL_TRY(cuda::sums(slab, slots(), n, out.data()));
        return out;
    }
    std::vector<int64_t> rows(static_cast<size_t>(slots()) * static_cast<size_t>(n));
    for_each_index("sim/sums", owned_cells(), slots() * int64_t{n}, [&](int64_t i) {
        const int32_t* row = slab.row(static_cast<int32_t>(i / n), static_cast<int32_t>(i % n));
        int64_t sum = 0;
        for (int32_t x = 0; x < n; ++x) sum += row[x];
        rows[static_cast<size_t>(i)] = sum;
    });
    for (size_t i = 0; i < rows.size(); ++i) out[i / static_cast<size_t>(n)] += rows[i];
    return out;
}

Result<std::string> TileDomain::hash(SimLayerSet layers) const {
    uint64_t a = 0;
    uint64_t b = 0;
    const int32_t n = tile_cells();
    std::vector<uint32_t> cells(static_cast<size_t>(n) * static_cast<size_t>(n));
    Status status;
    layers.for_each([&](SimLayer layer) {
        for (int32_t slot = 0; slot < slots() && status.ok(); ++slot) {
            status = store(slot, layer, cells.data());
            const auto ox = static_cast<uint64_t>(origins_[2 * static_cast<size_t>(slot)]);
            const auto oy = static_cast<uint64_t>(origins_[2 * static_cast<size_t>(slot) + 1]);
            size_t i = 0;
            for (int32_t y = 0; y < n; ++y) {
                const uint64_t row =
                    mixed((oy + static_cast<uint64_t>(y)) * 0x9E3779B97F4A7C15ull + static_cast<uint64_t>(layer));
                for (int32_t x = 0; x < n; ++x) {
                    const uint64_t place = row + (ox + static_cast<uint64_t>(x)) * 0xD1B54A32D192ED03ull;
                    const uint64_t h = mixed(place ^ (uint64_t{cells[i++]} << 32 | 1u));
                    a += h;
                    b += h * (h | 1u);
                }
            }
        }
    });
    SAHEL_TRY(status);
    return fmt::format("{:016x}{:016x}", a, b);
}

namespace {

int32_t conserved_count(SimLayerSet layers) {
    int32_t count = 0;
    k_conserved_layers.for_each([&](SimLayer l) { count += layers.contains(l); });
    return count;
}

uint64_t inbox_bytes(const TileLayout& layout, SimLayerSet layers) {
    const FrameIndex frame{layout.tile_cells, layout.halo};
    return static_cast<uint64_t>(conserved_count(layers)) * layout.tiles.size() * static_cast<uint64_t>(frame.count()) *
           sizeof(int32_t);
}

} // namespace

size_t TileDomain::flow_index(SimLayer layer) const {
    SAHEL_CHECK(k_conserved_layers.contains(layer) && layers_.contains(layer));
    size_t i = 0;
    k_conserved_layers.for_each([&](SimLayer l) { i += l < layer && layers_.contains(l) ? 1u : 0u; });
    return i;
}

uint64_t TileDomain::flow_bytes(const TileLayout& layout, SimLayerSet layers) {
    const uint64_t flows = static_cast<uint64_t>(conserved_count(layers)) * layout.tiles.size() * sizeof(SlotFlows);
    const bool frozen = ExchangePlan(layout).has_frozen() && layout.halo > 0;
    return Buffer::taken_bytes(flows) +
           (frozen ? Buffer::taken_bytes(inbox_bytes(layout, layers)) + Buffer::taken_bytes(layout.tiles.size()) : 0);
}

Status TileDomain::keep_flows() {
    const auto slot_count = static_cast<uint64_t>(slots());
    const auto layer_count = static_cast<uint64_t>(conserved_count(layers_));
    const auto zero = [&](Buffer& buffer, uint64_t bytes) -> Status {
        if (buffer.empty()) {
            SAHEL_ASSIGN(buffer, Buffer::allocate(*pool_, bytes));
        }
        if (bytes == 0) return {};
        if (device_) return cuda::fill_words(static_cast<uint32_t*>(buffer.data()), static_cast<int64_t>(bytes / 4), 0);
        std::memset(buffer.data(), 0, bytes);
        return {};
    };
    SAHEL_TRY(zero(flows_, layer_count * slot_count * sizeof(SlotFlows)));
    sources_.assign(k_ledger_source_count * layer_count * slot_count, 0);
    if (!plan_.has_frozen() || halo() == 0) return {};
    SAHEL_TRY(zero(inbox_, inbox_bytes(layout_, layers_)));
    if (!frozen_.empty()) return {};
    std::vector<uint8_t> bits(slot_count, 0);
    for (int32_t slot = 0; slot < slots(); ++slot)
        for (int k = 0; k < k_direction_count; ++k)
            if (plan_.border(slot, k) == Border::frozen)
                bits[static_cast<size_t>(slot)] |= static_cast<uint8_t>(1 << k);
    SAHEL_ASSIGN(frozen_, Buffer::allocate(*pool_, slot_count));
    if (device_) return cuda::copy_to_device(frozen_.data(), bits.data(), slot_count);
    std::memcpy(frozen_.data(), bits.data(), slot_count);
    return {};
}

void TileDomain::add_source(LedgerSource source, SimLayer layer, int32_t slot, int64_t ticks) {
    SAHEL_CHECK(keeps_flows());
    const auto slot_count = static_cast<size_t>(slots());
    sources_[(static_cast<size_t>(source) * (sources_.size() / slot_count / k_ledger_source_count) +
              flow_index(layer)) *
                 slot_count +
             static_cast<size_t>(slot)] += ticks;
}

int64_t TileDomain::source(LedgerSource source, SimLayer layer, int32_t slot) const {
    SAHEL_CHECK(keeps_flows());
    const auto slot_count = static_cast<size_t>(slots());
    return sources_[(static_cast<size_t>(source) * (sources_.size() / slot_count / k_ledger_source_count) +
                     flow_index(layer)) *
                        slot_count +
                    static_cast<size_t>(slot)];
}

Result<void*> TileDomain::scratch(const std::string& name, uint64_t bytes, bool* fresh) {
    Buffer& buffer = scratch_[name];
    const bool taken = !buffer.empty() && buffer.bytes() == Buffer::taken_bytes(bytes);
    if (!taken) {
        SAHEL_ASSIGN(buffer, Buffer::allocate(*pool_, bytes));
    }
    if (fresh) *fresh = !taken;
    return buffer.data();
}

BorderFlowsView TileDomain::border_flows(SimLayer layer) {
    SAHEL_CHECK(keeps_flows());
    const auto first = static_cast<int64_t>(flow_index(layer)) * slots();
    BorderFlowsView view;
    view.frame = frame();
    view.flows = static_cast<int64_t*>(flows_.data()) + first * k_direction_count;
    if (inbox_.empty()) return view;
    view.inbox = static_cast<int32_t*>(inbox_.data()) + first * view.frame.count();
    view.frozen = static_cast<const uint8_t*>(frozen_.data());
    return view;
}

Result<std::vector<TileDomain::SlotFlows>> TileDomain::flows(SimLayer layer) const {
    SAHEL_CHECK(keeps_flows());
    std::vector<SlotFlows> out(static_cast<size_t>(slots()));
    const auto* from = static_cast<const SlotFlows*>(flows_.data()) + flow_index(layer) * out.size();
    if (device_) {
        SAHEL_TRY(cuda::copy_to_host(out.data(), from, out.size() * sizeof(SlotFlows)));
    } else {
        std::copy(from, from + out.size(), out.begin());
    }
    return out;
}

Result<std::vector<int32_t>> TileDomain::inbox(int32_t slot, SimLayer layer) const {
    std::vector<int32_t> out;
    if (inbox_.empty()) return out;
    out.resize(static_cast<size_t>(frame().count()));
    const auto* from = static_cast<const int32_t*>(inbox_.data()) +
                       (static_cast<int64_t>(flow_index(layer)) * slots() + slot) * frame().count();
    if (device_) {
        SAHEL_TRY(cuda::copy_to_host(out.data(), from, out.size() * 4));
    } else {
        std::copy(from, from + out.size(), out.begin());
    }
    return out;
}

} // namespace sahel
