#pragma once

#include "world/file_io.h"
#include "world/world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

/// Worlds of a few small tiles in a folder of their own.
namespace sahel::store_test {

namespace fs = std::filesystem;

/// A value that depends on nothing but the world cell, so any tiling of it is the same state.
inline int32_t cell_value(int64_t x, int64_t y, int salt) {
    uint64_t h = static_cast<uint64_t>(x) * 0x9E3779B97F4A7C15ull ^ static_cast<uint64_t>(y) * 0xBF58476D1CE4E5B9ull ^
                 static_cast<uint64_t>(salt) * 0x94D049BB133111EBull;
    h ^= h >> 31;
    h *= 0xD6E8FEB86659FD93ull;
    return static_cast<int32_t>(h >> 44); // 0 .. 2^20 ticks: 8 m
}

inline LayerBlock make_tile(TileKey key, int n, int salt = 0) {
    auto block = LayerBlock::allocate(0, tile_rect(key, n), 0, k_surface_layers);
    EXPECT_TRUE(block.ok());
    block->clear();
    auto rock = block->ints(Layer::bedrock), sand = block->ints(Layer::sand);
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            rock(x, y) = cell_value(key.x * n + x, key.y * n + y, salt);
            sand(x, y) = cell_value(key.x * n + x, key.y * n + y, salt + 1) / 64;
        }
    return std::move(block).value();
}

inline Status commit_tiles(World& world, int64_t step, const std::vector<TileKey>& keys, int salt = 0,
                           const CommitExtras& extras = {}) {
    std::vector<LayerBlock> blocks;
    std::vector<TileUpdate> updates;
    blocks.reserve(keys.size());
    for (const TileKey key : keys) {
        blocks.push_back(make_tile(key, world.desc().tile_cells, salt));
        updates.push_back({key, &blocks.back()});
    }
    return world.commit(step, updates, extras);
}

/// Tiles, an inbox that grows with every step, a row of the ledger and something to go on with.
inline Status commit_whole_step(World& world, int64_t step, const std::vector<TileKey>& keys) {
    const Inbox inbox{{0, 9, 9}, Layer::sand, {{4, 1}}};
    const LedgerRow row{{0, 0, 0}, {static_cast<uint8_t>(step)}};
    const std::vector<uint8_t> resume(3, static_cast<uint8_t>(step));
    return commit_tiles(world, step, keys, static_cast<int>(step), {std::span(&inbox, 1), std::span(&row, 1), resume});
}

class Store : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (fs::temp_directory_path() / "sahel-store-XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        base_ = pattern;
    }
    void TearDown() override {
        std::error_code ignored;
        fs::permissions(base_, fs::perms::owner_all, ignored);
        fs::remove_all(base_);
    }
    [[nodiscard]] fs::path folder(const std::string& name = "world") const { return base_ / name; }
    static WorldDesc desc(int tile_cells = 128, const std::string& preset = "none") {
        WorldDesc d;
        d.name = "test";
        d.preset = preset;
        d.tile_cells = tile_cells;
        return d;
    }
    World create(const WorldDesc& d, const std::string& name = "world") {
        auto world = World::create(folder(name), d);
        EXPECT_TRUE(world.ok()) << (world.ok() ? "" : world.error().message);
        return std::move(world).value();
    }
    [[nodiscard]] std::vector<fs::path> tile_files(const std::string& name = "world") const {
        std::vector<fs::path> files;
        for (const auto& e : fs::recursive_directory_iterator(folder(name) / "tiles"))
            if (e.is_regular_file()) files.push_back(e.path());
        std::sort(files.begin(), files.end());
        return files;
    }
    fs::path base_;
};

} // namespace sahel::store_test
