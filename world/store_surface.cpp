#include "world/store_surface.h"

#include "world/lod_filter.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace sahel {

BackgroundSurface::BackgroundSurface(const WorldDesc& desc) : cell_m_(desc.cell_m) {
    if (desc.preset != "none")
        terrain_ = std::make_unique<BaseTerrain>(desc.seed, desc.terrain, desc.cell_m);
    else
        plain_ticks_ = ticks_of_metres(static_cast<float>(desc.outside_m));
    if (desc.preset == "none" && desc.sea_m) // the sea goes on around an imported coast
        sea_ticks_ = std::max(0, ticks_of_metres(static_cast<float>(*desc.sea_m)) - plain_ticks_);
}

Status BackgroundSurface::read(LayerBlock& block) const {
    if (terrain_) return terrain_->read(block);
    block.clear();
    const auto fill = [&](Layer layer, int32_t value) {
        if (!block.layers().contains(layer)) return;
        const auto view = block.ints(layer);
        for (int32_t y = view.y0; y < view.y1; ++y) std::fill(view.row(y) + view.x0, view.row(y) + view.x1, value);
    };
    fill(Layer::bedrock, plain_ticks_);
    fill(Layer::water, sea_ticks_);
    fill(Layer::mask, sea_ticks_ > 0 ? k_mask_outside | k_mask_sea : k_mask_outside);
    return {};
}

std::shared_ptr<const StoredTile> TileCache::find(TileKey key) {
    const std::lock_guard lock(mutex_);
    const auto found = index_.find(key);
    if (found == index_.end()) return nullptr;
    entries_.splice(entries_.begin(), entries_, found->second);
    return entries_.front().tile;
}

void TileCache::put(TileKey key, std::shared_ptr<const StoredTile> tile) {
    const std::lock_guard lock(mutex_);
    if (index_.contains(key)) return;
    bytes_ += tile->bytes();
    entries_.push_front({key, std::move(tile)});
    index_[key] = entries_.begin();
    while (bytes_ > max_bytes_ && entries_.size() > 1) {
        bytes_ -= entries_.back().tile->bytes();
        index_.erase(entries_.back().key);
        entries_.pop_back();
    }
}

void TileCache::clear() {
    const std::lock_guard lock(mutex_);
    entries_.clear();
    index_.clear();
    bytes_ = 0;
}

void StoreSurface::set_top(int32_t level, std::vector<TileKey> keys) {
    top_level_ = level;
    top_keys_ = std::move(keys);
}

Status StoreSurface::read(LayerBlock& block) const {
    SAHEL_TRY(background_.read(block));
    if (top_level_ < 0) return {};
    return block.level() <= top_level_ ? overlay_stored(block) : overlay_top(block);
}

Status StoreSurface::overlay_stored(LayerBlock& block) const {
    const CellRect rect = block.rect();
    Status status;
    for_each_tile(rect, block.level(), tile_cells_, [&](TileKey key) {
        if (!status.ok()) return;
        auto loaded = load_(key);
        if (!loaded.ok()) {
            status = loaded.error();
            return;
        }
        const std::shared_ptr<const StoredTile> tile = loaded.value();
        if (!tile) return;
        const CellRect cells = tile_rect(key, tile_cells_);
        const CellRect part = cells.intersected(rect);
        block.layers().intersected(k_stored_layers).for_each([&](Layer layer) {
            for (int64_t y = part.y0; y < part.y1; ++y) {
                const auto to_x = static_cast<int32_t>(part.x0 - block.owned().x0),
                           to_y = static_cast<int32_t>(y - block.owned().y0);
                int32_t* to = info_of(layer).type == LayerType::real
                                  ? reinterpret_cast<int32_t*>(block.reals(layer).row(to_y))
                                  : block.ints(layer).row(to_y);
                tile->copy_row(layer, static_cast<int>(part.x0 - cells.x0), static_cast<int>(y - cells.y0),
                               static_cast<int>(part.width()), to + to_x);
            }
        });
    });
    return status;
}

Status StoreSurface::overlay_top(LayerBlock& block) const {
    const int up = block.level() - top_level_;
    const int64_t scale = int64_t{1} << up;
    const CellRect rect = block.rect();
    for (const TileKey key : top_keys_) {
        const CellRect fine = tile_rect(key, tile_cells_);
        // Cells of the block that the tile touches, and of each the part that it covers.
        const CellRect coarse = CellRect{floor_div(fine.x0, scale), floor_div(fine.y0, scale),
                                         floor_div(fine.x1 - 1, scale) + 1, floor_div(fine.y1 - 1, scale) + 1}
                                    .intersected(rect);
        if (coarse.empty()) continue;
        SAHEL_ASSIGN(const auto tile, load_(key));
        if (!tile) continue;
        std::vector<int32_t> row(static_cast<size_t>(tile_cells_));
        block.layers().intersected(k_stored_layers).for_each([&](Layer layer) {
            if (info_of(layer).type != LayerType::ticks)
                return; // flags and reals keep the background's values that far out
            const auto view = block.ints(layer);
            for (int64_t cy = coarse.y0; cy < coarse.y1; ++cy)
                for (int64_t cx = coarse.x0; cx < coarse.x1; ++cx) {
                    const CellRect covered =
                        CellRect{cx * scale, cy * scale, (cx + 1) * scale, (cy + 1) * scale}.intersected(fine);
                    int64_t sum = 0;
                    for (int64_t y = covered.y0; y < covered.y1; ++y) {
                        tile->copy_row(layer, static_cast<int>(covered.x0 - fine.x0), static_cast<int>(y - fine.y0),
                                       static_cast<int>(covered.width()), row.data());
                        for (int64_t x = 0; x < covered.width(); ++x) sum += row[static_cast<size_t>(x)];
                    }
                    int32_t& to =
                        view(static_cast<int32_t>(cx - block.owned().x0), static_cast<int32_t>(cy - block.owned().y0));
                    const double share =
                        static_cast<double>(covered.area()) / (static_cast<double>(scale) * static_cast<double>(scale));
                    const double mean = static_cast<double>(sum) / static_cast<double>(covered.area());
                    to = static_cast<int32_t>(
                        std::floor(static_cast<double>(to) + (mean - static_cast<double>(to)) * share + 0.5));
                }
        });
    }
    return {};
}

} // namespace sahel
