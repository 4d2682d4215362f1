#pragma once

#include "world/base_terrain.h"
#include "world/field.h"
#include "world/surface_source.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// A world on disk.
///
///     WORLD/
///       world.json     what a person may read and edit: seed, preset, parameters, tile and cell size, georeference
///       index.sqlite   tiles, commits, checksums, inboxes, ledger, resume (WAL mode)
///       tiles/...      one OpenEXR file per stored tile: level 0 tiles, and parent tiles above them
///
/// A tile that is not stored is what the base terrain says. A commit is one step of many tiles: all of it or nothing.
namespace sahel {

inline constexpr int k_world_format_version = 2; ///< 2: inboxes, ledger, resume, simulation

/// Where an imported elevation model lies; kept so that an export can say the same.
struct GeoReference {
    std::string projection_wkt;
    double origin_x = 0.0; ///< projected coordinates of the north-west corner of cell (0, 0)
    double origin_y = 0.0;
    double cell_x = 1.0; ///< projected units per cell, eastward
    double cell_y = -1.0;
    double datum_m = 0.0; ///< added to stored heights to give the source's heights, m
};

struct WorldDesc {
    std::string name;
    uint64_t seed = 1;
    std::string preset = "oasis"; ///< "none": only stored tiles, a plain at `outside_m` around them
    BaseTerrainParams terrain;
    int tile_cells = 2048;
    double cell_m = 1.0;
    double outside_m = 0.0;
    std::optional<double> sea_m; ///< sea level of an imported model, m
    std::optional<GeoReference> georeference;
    std::string simulation; ///< a JSON object that this floor keeps and does not read; empty: none
};

/// One tile of a commit: every stored layer of the owned cells of a level 0 tile (a halo is ignored; layers that the
/// block lacks are stored as zero). Either a block, or a function that fills one (zeroed, every stored layer): tiles
/// are asked for one by one, so that a commit of many needs the memory of few.
struct TileUpdate {
    TileKey key;
    const LayerBlock* block = nullptr;
    std::function<Status(LayerBlock&)> fill = {};
    bool takes_inbox = false; ///< the cells hold what waited in the tile's inbox: it is emptied
};

/// What flowed into a tile that was not resident: it waits until the tile wakes.
struct InboxCell {
    int32_t cell = 0; ///< y * tile_cells + x
    int64_t ticks = 0;
    friend bool operator==(const InboxCell&, const InboxCell&) = default;
};
struct Inbox {
    TileKey key;
    Layer layer = Layer::count_;
    std::vector<InboxCell> cells =
        {}; ///< of the store: by cell, each once; in a commit: any order, equal ones are added up
};

/// The account of a tile, in the bytes of sim/ledger.h.
struct LedgerRow {
    TileKey key;
    std::vector<uint8_t> bytes;
};

/// What is committed in the same transaction as the tiles.
struct CommitExtras {
    std::span<const Inbox> inboxes;    ///< added to what waits already
    std::span<const LedgerRow> ledger; ///< replaces the rows of these tiles
    std::span<const uint8_t> resume;   ///< replaces what a run left to go on with; empty: nothing
};

struct WorldInfo {
    int64_t step = 0;
    int64_t tile_count = 0;   ///< level 0
    int64_t parent_count = 0; ///< levels above 0
    uint64_t disk_bytes = 0;
    CellRect bounds; ///< of the stored level 0 tiles
    float min_surface_m = 0.0f;
    float max_surface_m = 0.0f;
};

struct VerifyIssue {
    std::string path; ///< relative to the world folder
    std::string what;
    bool can_regenerate = false; ///< parent tiles, and tiles that the base terrain still gives
};

struct VerifyReport {
    int64_t files_checked = 0;
    uint64_t bytes_checked = 0;
    std::vector<VerifyIssue> issues;
};

enum class OpenMode { read, write };

class World {
  public:
    /// Errors: usage (folder exists and is not empty, bad description), io.
    static Result<World> create(const std::filesystem::path& folder, const WorldDesc& desc);
    /// Opens the last committed step, whole; forgets files of a commit that did not finish (write mode).
    /// Errors: not_found, corrupt, unsupported (a newer format), busy (somebody else writes), io.
    static Result<World> open(const std::filesystem::path& folder, OpenMode mode);

    World(World&&) noexcept;
    World& operator=(World&&) noexcept;
    ~World();

    [[nodiscard]] const std::filesystem::path& folder() const;
    [[nodiscard]] const WorldDesc& desc() const;

    /// Stores the tiles and refreshes every parent above them, in one transaction. After an error, or a kill at any
    /// instant, the world is what it was before. `step` must not be smaller than the last one.
    /// A tile whose inbox is not empty can only be committed by who took it (usage).
    Status commit(int64_t step, std::span<const TileUpdate> tiles, const CommitExtras& extras = {});

    [[nodiscard]] Result<bool> has_tile(TileKey key) const;
    [[nodiscard]] Result<std::vector<TileKey>> tiles(int32_t level) const;
    /// The stored cells of a tile. Errors: not_found, corrupt (checksum), io.
    [[nodiscard]] Result<LayerBlock> read_tile(TileKey key, LayerSet layers = k_stored_layers,
                                               MemoryPool& pool = MemoryPool::host()) const;

    /// What waits for a tile, or (without a key) for all, in order of tiles and layers. Errors: corrupt, io.
    [[nodiscard]] Result<std::vector<Inbox>> inboxes(std::optional<TileKey> key = std::nullopt) const;
    /// All rows of the ledger, in order. Errors: corrupt, io.
    [[nodiscard]] Result<std::vector<LedgerRow>> ledger() const;
    /// What the last commit left to go on with; empty: nothing. Errors: corrupt, io.
    [[nodiscard]] Result<std::vector<uint8_t>> resume() const;

    /// Stored tiles over the base terrain (or over the plain around an import), at any level; what waits in inboxes is
    /// not part of it. Thread safe. Valid as long as the world.
    [[nodiscard]] const SurfaceSource& surface() const;

    [[nodiscard]] Result<WorldInfo> info() const;
    /// Hash of all stored state over world cells in world order: independent of tile size, files and commits. What
    /// waits in an inbox counts as if it had arrived. 32 hexadecimal digits.
    [[nodiscard]] Result<std::string> hash() const;
    /// Re-reads everything and finds any byte that is not what was written, missing files and files too many.
    /// `progress(done, total)` may be empty.
    [[nodiscard]] Result<VerifyReport> verify(const std::function<void(int64_t, int64_t)>& progress = {}) const;
    /// world.json was edited on purpose: from now on verify takes it as it is. Needs write mode.
    Status accept_description();

  private:
    struct Impl;
    explicit World(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

} // namespace sahel
