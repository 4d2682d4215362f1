#include "sim/exchange_plan.h"

#include "world/check.h"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <utility>

namespace sahel {

namespace {

// One axis of a neighbour: the key it is found under, mirrored or not, or the border that ends the world there.
struct Axis {
    int64_t key = 0;
    Border border = Border::neighbour;
    [[nodiscard]] bool outside() const { return border == Border::open || border == Border::level; }
    [[nodiscard]] bool flip() const { return border == Border::wall; }
};

Axis resolve(const TileLayout& layout, int64_t own, int32_t step, int64_t lo, int64_t hi, Border below, Border above) {
    Axis axis{own + step, Border::neighbour};
    if (step == 0 || !layout.bounded || (axis.key >= lo && axis.key < hi)) return axis;
    axis.border = axis.key < lo ? below : above;
    if (axis.border == Border::periodic) axis.key += axis.key < lo ? hi - lo : lo - hi;
    if (axis.border == Border::wall) axis.key = own;
    return axis;
}

int32_t source_of(int32_t dst, int32_t step, int32_t n,
                  bool flip) { // first source cell of a segment that starts at dst
    if (flip) return step < 0 ? -1 - dst : 2 * n - 1 - dst;
    return dst - step * n;
}

LocalRect segment_of(int32_t n, int32_t halo, int direction) {
    const auto span = [&](int32_t step) -> std::pair<int32_t, int32_t> {
        if (step < 0) return {-halo, 0};
        if (step > 0) return {n, n + halo};
        return {0, n};
    };
    const auto [x0, x1] = span(direction_x(direction));
    const auto [y0, y1] = span(direction_y(direction));
    return {x0, y0, x1, y1};
}

} // namespace

TileLayout TileLayout::rectangle(int32_t tile_cells, int32_t halo, int64_t tiles_x, int64_t tiles_y, Border border,
                                 int64_t first_x, int64_t first_y) {
    SAHEL_CHECK(border != Border::neighbour && border != Border::frozen);
    TileLayout layout;
    layout.tile_cells = tile_cells;
    layout.halo = halo;
    layout.bounded = true;
    layout.tx0 = first_x;
    layout.ty0 = first_y;
    layout.tx1 = first_x + tiles_x;
    layout.ty1 = first_y + tiles_y;
    layout.west = layout.east = layout.north = layout.south = border;
    for (int64_t y = first_y; y < layout.ty1; ++y)
        for (int64_t x = first_x; x < layout.tx1; ++x) layout.tiles.push_back({0, x, y});
    return layout;
}

ExchangePlan::ExchangePlan(const TileLayout& layout) : n_(layout.tile_cells), halo_(layout.halo) {
    SAHEL_CHECK_LT(0, layout.tile_cells);
    SAHEL_CHECK_LE(0, layout.halo);
    SAHEL_CHECK_LE(layout.halo, layout.tile_cells);
    SAHEL_CHECK((layout.west == Border::periodic) == (layout.east == Border::periodic));
    SAHEL_CHECK((layout.north == Border::periodic) == (layout.south == Border::periodic));
    std::unordered_map<TileKey, int32_t> slot_of;
    for (const TileKey& key : layout.tiles) {
        SAHEL_CHECK(slot_of.emplace(key, static_cast<int32_t>(slot_of.size())).second);
        SAHEL_CHECK(!layout.bounded ||
                    (key.x >= layout.tx0 && key.x < layout.tx1 && key.y >= layout.ty0 && key.y < layout.ty1));
    }

    std::map<std::pair<int32_t, int32_t>, std::vector<HaloCopy>> by_pair; // (dst, src)
    borders_.resize(layout.tiles.size());
    partners_.resize(layout.tiles.size());
    for (int32_t slot = 0; slot < static_cast<int32_t>(layout.tiles.size()); ++slot) {
        const TileKey key = layout.tiles[static_cast<size_t>(slot)];
        for (int k = 0; k < k_direction_count; ++k) {
            const int32_t dx = direction_x(k);
            const int32_t dy = direction_y(k);
            const Axis ax = resolve(layout, key.x, dx, layout.tx0, layout.tx1, layout.west, layout.east);
            const Axis ay = resolve(layout, key.y, dy, layout.ty0, layout.ty1, layout.north, layout.south);
            const LocalRect rect = segment_of(n_, halo_, k);
            Border& border = borders_[static_cast<size_t>(slot)][static_cast<size_t>(k)];
            if (ax.outside() || ay.outside()) {
                border = ax.outside() ? ax.border : ay.border;
                LocalRect from = rect; // the axes that end the world are clamped to the edge, the others stay
                if (ax.outside()) from.x0 = dx < 0 ? 0 : n_ - 1, from.x1 = from.x0 + 1;
                if (ay.outside()) from.y0 = dy < 0 ? 0 : n_ - 1, from.y1 = from.y0 + 1;
                fills_.push_back({slot, rect, from, border});
                continue;
            }
            const auto found = slot_of.find({key.level, ax.key, ay.key});
            if (found == slot_of.end()) {
                border = Border::frozen;
                has_frozen_ = true;
                fills_.push_back({slot, rect, rect, border});
                continue;
            }
            border = ax.flip() || ay.flip() ? Border::wall : Border::neighbour;
            partners_[static_cast<size_t>(slot)][static_cast<size_t>(k)] = {
                found->second, direction_of(ax.flip() ? dx : -dx, ay.flip() ? dy : -dy)};
            by_pair[{slot, found->second}].push_back({found->second, slot, rect, source_of(rect.x0, dx, n_, ax.flip()),
                                                      source_of(rect.y0, dy, n_, ay.flip()), ax.flip() ? -1 : 1,
                                                      ay.flip() ? -1 : 1});
        }
    }
    for (const auto& [pair, list] : by_pair) {
        HaloMessage message{pair.second, pair.first, static_cast<int32_t>(copies_.size()),
                            static_cast<int32_t>(list.size()), 0};
        for (const HaloCopy& copy : list) {
            message.cells += copy.dst.area();
            copies_.push_back(copy);
        }
        messages_.push_back(message);
    }
}

LocalRect ExchangePlan::segment(int direction) const {
    return segment_of(n_, halo_, direction);
}

void ExchangePlan::cover(int32_t slot, int32_t margin, std::vector<LocalRect>& out) const {
    SAHEL_CHECK_LE(0, margin);
    SAHEL_CHECK_LE(margin, halo_);
    const auto live = [&](int32_t dx, int32_t dy) {
        const int k = direction_of(dx, dy);
        return k < 0 || (margin > 0 && is_live(border(slot, k)));
    };
    // Three bands of rows; in each the live cells are runs; bands with the same runs grow together.
    const int32_t cut[4] = {-margin, 0, n_, n_ + margin};
    const size_t first = out.size();
    for (int band = 0; band < 3; ++band) {
        if (cut[band] == cut[band + 1]) continue;
        for (int part = 0; part < 3;) {
            if (!live(part - 1, band - 1)) {
                ++part;
                continue;
            }
            int end = part + 1;
            while (end < 3 && live(end - 1, band - 1)) ++end;
            const LocalRect rect{cut[part], cut[band], cut[end], cut[band + 1]};
            part = end;
            if (rect.empty()) continue;
            const auto above =
                std::find_if(out.begin() + static_cast<ptrdiff_t>(first), out.end(),
                             [&](const LocalRect& r) { return r.x0 == rect.x0 && r.x1 == rect.x1 && r.y1 == rect.y0; });
            if (above != out.end())
                above->y1 = rect.y1;
            else
                out.push_back(rect);
        }
    }
}

void ExchangePlan::pack(const HaloMessage& m, SimLayer layer, SlabView<const int32_t> slab, int32_t* words) const {
    const Mirror mirror = info_of(layer).mirror;
    for (int32_t i = m.first_copy; i < m.first_copy + m.copy_count; ++i) {
        const HaloCopy& c = copies_[static_cast<size_t>(i)];
        for (int32_t y = c.dst.y0; y < c.dst.y1; ++y) {
            const int32_t* row = slab.row(c.src_slot, c.src_y + (y - c.dst.y0) * c.step_y) + c.src_x;
            const bool plain = c.step_x > 0 && c.step_y > 0;
            for (int32_t x = 0; x < c.dst.x1 - c.dst.x0; ++x) {
                const int32_t word = row[x * c.step_x];
                *words++ = plain ? word
                                 : static_cast<int32_t>(
                                       mirrored_word(static_cast<uint32_t>(word), mirror, c.step_x < 0, c.step_y < 0));
            }
        }
    }
}

void ExchangePlan::unpack(const HaloMessage& m, SlabView<int32_t> slab, const int32_t* words) const {
    for (int32_t i = m.first_copy; i < m.first_copy + m.copy_count; ++i) {
        const HaloCopy& c = copies_[static_cast<size_t>(i)];
        for (int32_t y = c.dst.y0; y < c.dst.y1; ++y) {
            int32_t* row = slab.row(c.dst_slot, y);
            for (int32_t x = c.dst.x0; x < c.dst.x1; ++x) row[x] = *words++;
        }
    }
}

} // namespace sahel
