#pragma once

#include "world/sqlite.h"
#include "world/state_hash.h"
#include "world/world.h"

#include <mutex>
#include <optional>
#include <string>
#include <vector>

/// The index of a world: which file holds which tile, since which step, with which checksum.
///
///     meta     key, value                                    format version, tile size, cell size
///     commits  generation, step, tiles                       one row a commit
///     tiles    level, x, y | file, bytes, checksum, generation, step, low_m, high_m, blocks
///
/// A tile's file is never changed: a commit writes new files and one transaction points to them.
namespace sahel {

struct TileRow {
    TileKey key;
    std::string file; ///< relative to the world folder
    uint64_t bytes = 0;
    std::string checksum; ///< XXH3-128 of the file, hexadecimal
    int64_t generation = 0;
    int64_t step = 0;
    float low_m = 0.0f, high_m = 0.0f; ///< of the surface
    std::vector<BlockDigest> blocks;   ///< level 0 only
};

class StoreIndex {
  public:
    static Result<StoreIndex> create(const std::filesystem::path& path, const WorldDesc& desc);
    static Result<StoreIndex> open(const std::filesystem::path& path, OpenMode mode, const WorldDesc& desc);

    [[nodiscard]] int64_t generation() const { return generation_; }
    [[nodiscard]] int64_t step() const { return step_; }

    [[nodiscard]] Result<std::optional<TileRow>> find(TileKey key) const;
    /// All rows of a level (or of every level), in order; `with_blocks` also their digests.
    [[nodiscard]] Result<std::vector<TileRow>> rows(std::optional<int32_t> level, bool with_blocks) const;
    [[nodiscard]] Result<std::vector<TileKey>> keys(int32_t level) const;
    [[nodiscard]] Result<int32_t> top_level() const; ///< -1: no tile
    /// One transaction: all of it or nothing.
    Status commit(int64_t generation, int64_t step, std::span<const TileRow> rows);
    [[nodiscard]] Result<std::string> integrity() const; ///< "ok", or what SQLite found

  private:
    StoreIndex(sqlite::Database db) : db_(std::move(db)) {}
    Status check_meta(const WorldDesc& desc);
    mutable sqlite::Database db_;
    int64_t generation_ = 0;
    int64_t step_ = 0;
};

} // namespace sahel
