#include "pass_check.h"

#include "world/cpu_features.h"
#include "world/executor.h"
#include "world/random.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>

namespace sahel::test {

namespace {

// A plausible word of a layer, different for each `which`.
uint32_t random_word(SimLayer layer, int64_t x, int64_t y, uint64_t seed, uint32_t which) {
    const RandomStream stream(seed, static_cast<int64_t>(layer), Purpose::test, which);
    const uint32_t bits = stream.at(x, y).v[0];
    switch (info_of(layer).type) {
    case LayerType::ticks:
        return bits >> 13; // 0 to 4 m
    case LayerType::real:
        return __builtin_bit_cast(uint32_t, uniform(bits));
    case LayerType::flags:
        break;
    }
    return bits & 0x01010101u;
}

} // namespace

std::string find_dishonest(const Pass& pass, SimLayerSet layers, uint64_t seed) {
    constexpr int32_t n = 12;
    const int32_t halo = std::min(n, pass.decl.radius() + 3);
    SAHEL_CHECK_LT(pass.decl.radius(), halo); // else nothing lies beyond
    const auto all = TileLayout::rectangle(n, halo, 2, 1, Border::periodic);
    if (!pass.decl.sound()) return "the declaration writes nothing, or a layer that it reads beside its own cell";
    if (!layers.contains(pass.decl.read_set()) || !layers.contains(pass.decl.writes)) return "a layer is missing";

    const auto fill = [&](TileDomain& d, bool noisy) {
        layers.for_each([&](SimLayer layer) {
            int32_t radius = -1; // how far the pass may look; -1: not at all
            for (const LayerRead& read : pass.decl.reads)
                if (read.layer == layer) radius = std::max(radius, read.radius);
            const auto words = d.words(layer);
            for (int32_t slot = 0; slot < d.slots(); ++slot)
                for (int32_t y = -halo; y < n + halo; ++y)
                    for (int32_t x = -halo; x < n + halo; ++x) {
                        const int32_t beyond = std::max(std::max(-x, x - n + 1), std::max(-y, y - n + 1));
                        const bool seen = radius >= 0 && beyond <= radius;
                        words(slot, x, y) = random_word(layer, 1000 * slot + x, y, seed, noisy && !seen ? 1 : 0);
                    }
            d.set_valid_halo(layer, halo);
        });
    };
    TileDomain calm = TileDomain::create(all, layers).value();
    TileDomain noisy = TileDomain::create(all, layers).value();
    TileDomain before = TileDomain::create(all, layers).value();
    fill(calm, false);
    fill(noisy, true);
    fill(before, true);
    for (TileDomain* d : {&calm, &noisy}) {
        const Status ran = pass.run({*d, d->launch(0, pass.decl.name.data()), 0});
        if (!ran.ok()) return ran.error().message;
    }
    std::string found;
    layers.for_each([&](SimLayer layer) {
        const auto a = calm.words(layer);
        const auto b = noisy.words(layer);
        const auto c = before.words(layer);
        for (int32_t slot = 0; slot < 2; ++slot)
            for (int32_t y = -halo; y < n + halo; ++y)
                for (int32_t x = -halo; x < n + halo; ++x) {
                    if (!found.empty()) return;
                    const bool owned = x >= 0 && x < n && y >= 0 && y < n;
                    if (owned && pass.decl.writes.contains(layer)) {
                        if (a(slot, x, y) != b(slot, x, y))
                            found = fmt::format("{} of cell ({}, {}) depends on what the pass does not declare to read",
                                                info_of(layer).name, x, y);
                    } else if (b(slot, x, y) != c(slot, x, y)) {
                        found = fmt::format("{} of cell ({}, {}) was written, which the pass does not declare",
                                            info_of(layer).name, x, y);
                    }
                }
    });
    return found;
}

std::string text_of(const RunWay& w) {
    return fmt::format("tiles of {}, halo {}, {} threads, {}, {}{}{}", w.tile_cells, w.halo, w.threads,
                       w.order == VisitOrder::forward ? "forward" : "backward", w.v3 ? "v3" : "baseline",
                       w.reversed_slots ? ", slots reversed" : "", w.device ? ", device" : "");
}

std::vector<RunWay> run_ways(int32_t side, bool quick) {
    std::vector<RunWay> ways;
    int i = 0;
    for (const int32_t tile : {side, 512, 256, 128})
        for (const int32_t halo : {8, 16, 64}) {
            if (tile > side || side % tile != 0 ||
                (tile == side && !ways.empty() && ways.back().tile_cells == tile && quick))
                continue;
            for (const int threads : {1, 2, 5})
                for (const VisitOrder order : {VisitOrder::forward, VisitOrder::backward})
                    for (const bool v3 : {false, true}) {
                        if (v3 && best_isa() != Isa::v3) continue;
                        // Quick: two of the twelve machine choices for each cut, a different pair every time.
                        const int choice = (threads == 1   ? 0
                                            : threads == 2 ? 1
                                                           : 2) *
                                               4 +
                                           (order == VisitOrder::forward ? 0 : 2) + v3;
                        if (quick && choice != (5 * i) % 12 && choice != (5 * i + 7) % 12) continue;
                        ways.push_back({tile, halo, threads, order, v3, (choice & 1) != 0, false});
                    }
            ++i;
        }
    return ways;
}

TileDomain make_periodic(int32_t side, const RunWay& way, SimLayerSet layers, MemoryPool& pool) {
    set_thread_count(way.threads);
    set_isa(way.v3 ? Isa::v3 : Isa::baseline);
    TileLayout layout =
        TileLayout::rectangle(way.tile_cells, way.halo, side / way.tile_cells, side / way.tile_cells, Border::periodic);
    if (way.reversed_slots) std::reverse(layout.tiles.begin(), layout.tiles.end());
    TileDomain domain = TileDomain::create(std::move(layout), layers, pool).value();
    domain.set_order(way.order);
    return domain;
}

RestoreMachine::~RestoreMachine() {
    set_thread_count(0);
    set_isa(best_isa());
}

bool long_tests() {
    const char* asked = std::getenv("SAHEL_LONG_TESTS");
    return asked != nullptr && std::string_view(asked) == "1";
}

} // namespace sahel::test
