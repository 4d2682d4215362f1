#include "world/ground_sampler.h"

#include <cmath>

namespace sahel {

GroundSampler::GroundSampler(const SurfaceSource& source, int32_t level)
    : source_(source), level_(level), cell_m_(std::ldexp(source.cell_m(), level)) {}

const GroundSampler::Block& GroundSampler::block(TileKey key) {
    if (const auto found = index_.find(key); found != index_.end()) {
        blocks_.splice(blocks_.begin(), blocks_, found->second);
        return blocks_.front().second;
    }
    Block block;
    block.ground_m.assign(k_side * k_side, 0.0f);
    block.water_m = block.sand_m = block.ground_m;
    auto cells = LayerBlock::allocate(level_, tile_rect(key, k_side), 0, k_surface_layers);
    if (cells.ok() && source_.read(*cells).ok()) {
        const auto rock = cells->ints(Layer::bedrock);
        const auto soil = cells->ints(Layer::soil);
        const auto sand = cells->ints(Layer::sand);
        const auto water = cells->ints(Layer::water);
        for (int y = 0; y < k_side; ++y)
            for (int x = 0; x < k_side; ++x) {
                const auto i = static_cast<size_t>(y * k_side + x);
                block.ground_m[i] = metres_of_ticks(rock(x, y) + soil(x, y) + sand(x, y));
                block.water_m[i] = metres_of_ticks(water(x, y));
                block.sand_m[i] = metres_of_ticks(sand(x, y));
            }
    } else if (!blocks_.empty()) {
        block = blocks_.front().second;
    }
    if (blocks_.size() == k_max_blocks) {
        index_.erase(blocks_.back().first);
        blocks_.pop_back();
    }
    blocks_.emplace_front(key, std::move(block));
    index_[key] = blocks_.begin();
    return blocks_.front().second;
}

GroundSample GroundSampler::cell(int64_t x, int64_t y) {
    const Block& b = block(tile_of({x, y}, level_, k_side));
    const auto i = static_cast<size_t>(floor_mod(y, k_side) * k_side + floor_mod(x, k_side));
    return {b.ground_m[i], b.water_m[i], b.sand_m[i]};
}

GroundSample GroundSampler::at(double x_m, double y_m) {
    const double u = x_m / cell_m_ - 0.5;
    const double v = y_m / cell_m_ - 0.5;
    const double fu = std::floor(u);
    const double fv = std::floor(v);
    const auto i = static_cast<int64_t>(fu);
    const auto j = static_cast<int64_t>(fv);
    const double a = u - fu;
    const double b = v - fv;
    const GroundSample c00 = cell(i, j), c10 = cell(i + 1, j), c01 = cell(i, j + 1), c11 = cell(i + 1, j + 1);
    const auto mix = [&](double GroundSample::*m) {
        return (c00.*m * (1 - a) + c10.*m * a) * (1 - b) + (c01.*m * (1 - a) + c11.*m * a) * b;
    };
    return {mix(&GroundSample::ground_m), mix(&GroundSample::water_m), mix(&GroundSample::sand_m)};
}

} // namespace sahel
