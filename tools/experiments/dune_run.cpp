#include "tools/experiments/dune_run.h"

#include "sim/domain_field.h"
#include "world/random.h"

#include <fmt/format.h>

#include <algorithm>

namespace sahel::experiments {

Result<TileLayout> periodic_layout(int32_t cells_x, int32_t cells_y, int32_t halo) {
    int32_t tile = 512;
    while (tile > 1 && (cells_x % tile != 0 || cells_y % tile != 0)) tile /= 2;
    if (tile < halo)
        return Error{ErrorKind::usage,
                     fmt::format("a domain of {} x {} cells is made of tiles of {}, narrower than the "
                                 "halo of {} that this run needs",
                                 cells_x, cells_y, tile, halo)};
    return TileLayout::rectangle(tile, halo, cells_x / tile, cells_y / tile, Border::periodic);
}

double cell_noise(uint64_t seed, int32_t x, int32_t y) {
    uint64_t h = seed * 0x9E3779B97F4A7C15ull + static_cast<uint32_t>(x) + (uint64_t{static_cast<uint32_t>(y)} << 32);
    for (int i = 0; i < 2; ++i) { // the finaliser of MurmurHash3
        h ^= h >> 33;
        h *= 0xFF51AFD7ED558CCDull;
        h ^= h >> 33;
        h *= 0xC4CEB9FE1A85EC53ull;
        h ^= h >> 33;
    }
    return static_cast<double>(h >> 11) * 0x1.0p-53;
}

SandParams dune_sand() {
    SandParams sand;
    sand.avalanche_max_sweeps = 50;
    return sand;
}

Result<DuneRun> DuneRun::create(DuneRunDesc desc, const Setup& setup) {
    setup.wind.apply(desc.wind);
    setup.sand.apply(desc.sand);
    DuneRun run;
    run.desc_ = desc;
    Aeolian::Desc aeolian;
    aeolian.wind = desc.wind;
    aeolian.sand = desc.sand;
    aeolian.schedule = desc.schedule;
    aeolian.cell_m = desc.cell_m;
    aeolian.seed = desc.seed;
    const int32_t halo = std::max(Aeolian::least_halo(aeolian), 16);
    SAHEL_ASSIGN(const TileLayout layout, periodic_layout(desc.cells_x, desc.cells_y, halo));
    SimLayerSet layers = Aeolian::layers(aeolian);
    layers.insert({SimLayer::bedrock, SimLayer::soil, SimLayer::sand, SimLayer::airborne_sand});
    SAHEL_ASSIGN(TileDomain domain, TileDomain::create(layout, layers));
    Status filled;
    layers.for_each([&](SimLayer layer) {
        if (!filled.ok() || info_of(layer).role == SimRole::working) return;
        const Ground::Height* height = layer == SimLayer::bedrock      ? &desc.ground.bedrock_m
                                       : layer == SimLayer::sand       ? &desc.ground.sand_m
                                       : layer == SimLayer::vegetation ? &desc.ground.vegetation
                                       : layer == SimLayer::resistance ? &desc.ground.resistance
                                                                       : nullptr;
        const auto value = [&](int64_t x, int64_t y) {
            return height && *height ? (*height)(static_cast<int32_t>(x), static_cast<int32_t>(y)) : 0.0;
        };
        if (info_of(layer).type == LayerType::real)
            filled = domain.fill(layer, [&](int64_t x, int64_t y) { return static_cast<float>(value(x, y)); });
        else if (layer == SimLayer::object)
            filled = domain.fill(layer, [&](int64_t x, int64_t y) {
                return desc.ground.object && desc.ground.object(static_cast<int32_t>(x), static_cast<int32_t>(y)) ? 1
                                                                                                                  : 0;
            });
        else
            filled = domain.fill(layer, [&](int64_t x, int64_t y) {
                return static_cast<int32_t>(std::lround(value(x, y) * double{k_ticks_per_m}));
            });
    });
    SAHEL_TRY(filled);
    run.domain_ = std::make_unique<TileDomain>(std::move(domain));
    SAHEL_ASSIGN(Aeolian made, Aeolian::create(aeolian, *run.domain_));
    run.aeolian_ = std::make_unique<Aeolian>(std::move(made));
    return run;
}

Status DuneRun::advance(int64_t steps) {
    for (int64_t i = 0; i < steps; ++i) {
        SAHEL_TRY(aeolian_->step(*domain_, step_));
        ++step_;
        sweeps_ += aeolian_->stats().sand.sweeps;
    }
    return {};
}

Status DuneRun::advance(int64_t steps, const Setup& setup, double share, double part, const std::string& what) {
    constexpr int64_t k_stride = 10;
    for (int64_t done = 0; done < steps; done += k_stride) {
        setup.tell(share + part * static_cast<double>(done) / static_cast<double>(steps), what);
        SAHEL_TRY(advance(std::min(k_stride, steps - done)));
    }
    return {};
}

Plane plane_of(const TileDomain& d, SimLayer layer, double cell_m) {
    const TileLayout& layout = d.layout();
    const int32_t n = d.tile_cells();
    Plane out(static_cast<int32_t>(layout.tx1 - layout.tx0) * n, static_cast<int32_t>(layout.ty1 - layout.ty0) * n,
              cell_m);
    Result<std::vector<float>> values = field_of(d, layer);
    SAHEL_CHECK(values.ok());
    SAHEL_CHECK_EQ(values->size(), out.size());
    out.values = std::move(*values);
    return out;
}

Plane DuneRun::surface() const {
    return sum_of(sum_of(bedrock(), plane(SimLayer::soil)), sand());
}

int64_t DuneRun::solid_ticks() const {
    int64_t total = 0;
    for (const SimLayer layer : {SimLayer::bedrock, SimLayer::soil, SimLayer::sand, SimLayer::airborne_sand}) {
        const auto sums = domain_->sums(layer);
        SAHEL_CHECK(sums.ok());
        for (const int64_t s : *sums) total += s;
    }
    return total;
}

} // namespace sahel::experiments
