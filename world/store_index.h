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
///     meta     key, value                                    format version, tile size, cell size, text of world.json
///     commits  generation, step, tiles, digest               one row a commit, generations without gaps
///     tiles    level, x, y | file, bytes, checksum, generation, step, low_m, high_m, blocks, digest
///     inbox    x, y, layer | cells, checksum                 what waits for a tile that sleeps
///     ledger   x, y | account, checksum                      one row a tile that ever was simulated
///     resume   blob, checksum                                at most one row
///
/// Format 1 lacks the last three: opened for reading they are empty, opened for writing they are made.
/// A tile's file is never changed: a commit writes new files and one transaction points to them. Each row carries a
/// digest of itself, since SQLite checks the form of its pages and not what stands in them.
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
    /// `description`: the text of world.json.
    static Result<StoreIndex> create(const std::filesystem::path& path, const WorldDesc& desc,
                                     std::string_view description);
    static Result<StoreIndex> open(const std::filesystem::path& path, OpenMode mode, const WorldDesc& desc);

    [[nodiscard]] int64_t generation() const { return generation_; }
    [[nodiscard]] int64_t step() const { return step_; }

    [[nodiscard]] Result<std::optional<TileRow>> find(TileKey key) const;
    /// All rows of a level (or of every level), in order; `with_blocks` also the state hashes, and then each row is
    /// checked against its digest. Error: corrupt.
    [[nodiscard]] Result<std::vector<TileRow>> rows(std::optional<int32_t> level, bool with_blocks) const;
    [[nodiscard]] Result<std::vector<TileKey>> keys(int32_t level) const;
    [[nodiscard]] Result<int32_t> top_level() const; ///< -1: no tile
    /// One transaction: all of it or nothing.
    Status commit(int64_t generation, int64_t step, std::span<const TileRow> rows, std::span<const TileKey> taken,
                  const CommitExtras& extras);

    /// `damaged` gets a line for each row that is not what was written; without it such a row is an error.
    [[nodiscard]] Result<std::vector<Inbox>> inboxes(std::optional<TileKey> key,
                                                     std::vector<std::string>* damaged = nullptr) const;
    [[nodiscard]] Result<std::vector<LedgerRow>> ledger(std::vector<std::string>* damaged = nullptr) const;
    [[nodiscard]] Result<std::vector<uint8_t>> resume(std::vector<std::string>* damaged = nullptr) const;
    [[nodiscard]] Result<bool> has_inbox(TileKey key) const;
    /// "ok", or what is wrong with the form of the file or with the row of commits.
    [[nodiscard]] Result<std::string> integrity() const;
    /// The text of world.json when the world was made, or as set later; empty: not kept.
    [[nodiscard]] const std::string& description() const { return description_; }
    Status set_description(std::string_view text);

  private:
    StoreIndex(sqlite::Database db) : db_(std::move(db)) {}
    Status check_meta(const WorldDesc& desc);
    Status write_rows(int64_t generation, int64_t step, std::span<const TileRow> rows);
    Status write_extras(std::span<const TileKey> taken, const CommitExtras& extras);
    mutable sqlite::Database db_;
    int version_ = 0; ///< of the file
    int64_t tile_area_ = 0;
    int64_t generation_ = 0;
    int64_t step_ = 0;
    std::string description_;
};

/// tiles/L02/s-1_3/-17_99.g12.exr: 32 x 32 tiles a folder.
std::string tile_file_name(TileKey key, int64_t generation);
/// The other way round; false: not the name of a tile.
bool parse_tile_file_name(const std::string& file, TileKey& key, int64_t& generation);

} // namespace sahel
