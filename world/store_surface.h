#pragma once

#include "world/base_terrain.h"
#include "world/exr_tile.h"
#include "world/surface_source.h"
#include "world/world.h"

#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>

/// What lies where nothing is stored: the base terrain, or the plain around an imported model.
namespace sahel {

class BackgroundSurface final : public SurfaceSource {
  public:
    explicit BackgroundSurface(const WorldDesc& desc);
    Status read(LayerBlock& block) const override;
    [[nodiscard]] double cell_m() const override { return cell_m_; }
    [[nodiscard]] bool is_plain() const { return terrain_ == nullptr; }

  private:
    std::unique_ptr<BaseTerrain> terrain_; ///< null: a plain
    int32_t plain_ticks_ = 0;
    int32_t sea_ticks_ = 0; ///< depth of water on the plain
    double cell_m_ = 1.0;
};

/// Decoded tiles, the last used ones within a budget of bytes. Thread safe.
class TileCache {
  public:
    explicit TileCache(uint64_t max_bytes) : max_bytes_(max_bytes) {}
    std::shared_ptr<const StoredTile> find(TileKey key);
    void put(TileKey key, std::shared_ptr<const StoredTile> tile);
    void clear();

  private:
    struct Entry {
        TileKey key;
        std::shared_ptr<const StoredTile> tile;
    };
    std::mutex mutex_;
    uint64_t max_bytes_;
    uint64_t bytes_ = 0;
    std::list<Entry> entries_; ///< most recently used first
    std::unordered_map<TileKey, std::list<Entry>::iterator> index_;
};

/// Stored tiles over the background, at any level. Above the highest stored level the tiles of that level are filtered
/// down further, each cell by the share of it that they cover.
class StoreSurface final : public SurfaceSource {
  public:
    /// `load` gives a stored tile or null; `top` is the highest stored level (-1: nothing stored).
    using Load = std::function<Result<std::shared_ptr<const StoredTile>>(TileKey)>;
    StoreSurface(const WorldDesc& desc, const BackgroundSurface& background, Load load)
        : tile_cells_(desc.tile_cells), background_(background), load_(std::move(load)) {}

    /// The tiles of the highest stored level; called after each commit, never beside a read.
    void set_top(int32_t level, std::vector<TileKey> keys);
    Status read(LayerBlock& block) const override;
    [[nodiscard]] double cell_m() const override { return background_.cell_m(); }

  private:
    Status overlay_stored(LayerBlock& block) const;
    Status overlay_top(LayerBlock& block) const;
    int tile_cells_;
    const BackgroundSurface& background_;
    Load load_;
    int32_t top_level_ = -1;
    std::vector<TileKey> top_keys_;
};

} // namespace sahel
