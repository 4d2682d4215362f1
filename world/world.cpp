#include "world/world.h"

#include "world/file_io.h"
#include "world/lod_filter.h"
#include "world/store_index.h"
#include "world/store_surface.h"
#include "world/world_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <fcntl.h>
#include <map>
#include <set>
#include <sys/file.h>
#include <unistd.h>
#include <unordered_set>

namespace sahel {

namespace fs = std::filesystem;

namespace {

constexpr uint64_t k_cache_bytes = uint64_t{192} << 20;
constexpr size_t k_few_top_tiles = 4; ///< parents are made up to the level where this many cover everything
constexpr int32_t k_max_stored_level = 20;
constexpr uint64_t k_max_tile_file_bytes = uint64_t{4} << 30;

/// The one writer of a world: a lock on a file that the kernel drops when the process ends, however it ends.
class WriterLock {
  public:
    static Result<WriterLock> take(const fs::path& folder) {
        const fs::path path = folder / ".lock";
        const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
        if (file < 0)
            return Error{ErrorKind::io, fmt::format("{}: cannot be made; is the folder writable?", path.string())};
        if (::flock(file, LOCK_EX | LOCK_NB) != 0) {
            ::close(file);
            return Error{ErrorKind::busy,
                         fmt::format("{}: another program is writing this world; wait for it", folder.string())};
        }
        return WriterLock(file);
    }
    WriterLock(WriterLock&& o) noexcept : file_(std::exchange(o.file_, -1)) {}
    WriterLock& operator=(WriterLock&& o) noexcept {
        std::swap(file_, o.file_);
        return *this;
    }
    ~WriterLock() {
        if (file_ >= 0) ::close(file_);
    }

  private:
    explicit WriterLock(int file) : file_(file) {}
    int file_;
};

Status in_world(const fs::path& folder, const Status& status) {
    if (status.ok()) return {};
    Error e = status.error();
    if (e.message.find(folder.string()) == std::string::npos) e.message = folder.string() + ": " + e.message;
    return e;
}

} // namespace

struct World::Impl {
    fs::path folder;
    WorldDesc desc;
    OpenMode mode;
    std::optional<WriterLock> lock;
    mutable std::mutex mutex; ///< of the index
    StoreIndex index;
    mutable TileCache cache{k_cache_bytes};
    BackgroundSurface background;
    StoreSurface surface;

    Impl(fs::path f, WorldDesc d, OpenMode m, std::optional<WriterLock> l, StoreIndex i)
        : folder(std::move(f)), desc(std::move(d)), mode(m), lock(std::move(l)), index(std::move(i)), background(desc),
          surface(desc, background, [this](TileKey key) { return load(key); }) {}

    Status refresh_top() {
        SAHEL_ASSIGN(const int32_t top, index.top_level());
        std::vector<TileKey> keys;
        if (top >= 0) {
            SAHEL_ASSIGN(keys, index.keys(top));
        }
        surface.set_top(top, std::move(keys));
        return {};
    }

    Result<StoredTile> read_row(const TileRow& row) const {
        const fs::path path = folder / row.file;
        SAHEL_ASSIGN(const std::vector<uint8_t> bytes, read_file(path, k_max_tile_file_bytes));
        if (bytes.size() != row.bytes || to_hex(checksum(bytes)) != row.checksum)
            return Error{ErrorKind::corrupt,
                         fmt::format("{}: its bytes are not what was written; run sahel verify", path.string())};
        SAHEL_ASSIGN(StoredTile tile, decode_tile(bytes, path.string()));
        if (tile.key != row.key || tile.tile_cells != desc.tile_cells)
            return Error{ErrorKind::corrupt, fmt::format("{}: holds another tile than the index says", path.string())};
        return tile;
    }

    /// A stored tile, or null.
    Result<std::shared_ptr<const StoredTile>> load(TileKey key) const {
        if (auto cached = cache.find(key)) return cached;
        std::optional<TileRow> row;
        {
            const std::lock_guard guard(mutex);
            SAHEL_ASSIGN(row, index.find(key));
        }
        if (!row) return std::shared_ptr<const StoredTile>{};
        SAHEL_ASSIGN(StoredTile tile, read_row(*row));
        auto shared = std::make_shared<const StoredTile>(std::move(tile));
        cache.put(key, shared);
        return std::shared_ptr<const StoredTile>(shared);
    }

    /// A tile as the world shows it: stored, or of the background.
    Result<std::shared_ptr<const StoredTile>> shown(TileKey key) const {
        SAHEL_ASSIGN(auto stored, load(key));
        if (stored) return stored;
        SAHEL_ASSIGN(LayerBlock block,
                     LayerBlock::allocate(key.level, tile_rect(key, desc.tile_cells), 0, k_state_layers));
        SAHEL_TRY(background.read(block));
        SAHEL_ASSIGN(StoredTile tile, make_stored_tile(key, desc.tile_cells, block));
        return std::make_shared<const StoredTile>(std::move(tile));
    }

    Result<TileRow> write_tile(const StoredTile& tile, int64_t generation, int64_t step) const {
        TileRow row;
        row.key = tile.key;
        row.file = tile_file_name(tile.key, generation);
        row.generation = generation;
        row.step = step;
        SAHEL_ASSIGN(const std::vector<uint8_t> bytes, encode_tile(tile));
        row.bytes = bytes.size();
        row.checksum = to_hex(checksum(bytes));
        int32_t low = INT32_MAX, high = INT32_MIN;
        for (int y = 0; y < tile.tile_cells; ++y)
            for (int x = 0; x < tile.tile_cells; ++x) {
                const int32_t h = tile.at(Layer::bedrock, x, y) + tile.at(Layer::soil, x, y) +
                                  tile.at(Layer::sand, x, y) + tile.at(Layer::water, x, y);
                low = std::min(low, h);
                high = std::max(high, h);
            }
        row.low_m = metres_of_ticks(low);
        row.high_m = metres_of_ticks(high);
        if (tile.key.level == 0) row.blocks = hash_blocks(tile);
        SAHEL_TRY(write_file(folder / row.file, std::span<const uint8_t>(bytes)));
        return row;
    }

    Status commit(int64_t step, std::span<const TileUpdate> updates, const CommitExtras& extras);
    Status check_extras(std::span<const TileUpdate> updates, const CommitExtras& extras) const;
    Status write_all(int64_t generation, int64_t step, std::span<const TileUpdate> updates,
                     std::vector<TileRow>& rows) const;
    Result<std::vector<BlockDigest>> waiting_blocks(const std::vector<Inbox>& waiting) const;
    void remove_files(std::span<const std::string> files) const {
        std::error_code ignored;
        for (const std::string& f : files) fs::remove(folder / f, ignored);
    }
    std::vector<std::string> files_on_disk() const {
        std::vector<std::string> files;
        std::error_code error;
        for (auto it = fs::recursive_directory_iterator(folder / "tiles", error);
             !error && it != fs::recursive_directory_iterator(); it.increment(error))
            if (!it->is_directory(error)) files.push_back(fs::relative(it->path(), folder, error).generic_string());
        std::sort(files.begin(), files.end());
        return files;
    }
    /// Removes what a killed commit left: files on their way, files of the commit that never was, and files that a
    /// later commit replaced. Nothing else: a row that a damaged index lost must not cost the tile too.
    Status forget_orphans() {
        SAHEL_ASSIGN(const auto rows, index.rows(std::nullopt, false));
        std::map<TileKey, int64_t> current;
        for (const TileRow& r : rows) current[r.key] = r.generation;
        for (const std::string& f : files_on_disk()) {
            TileKey key;
            int64_t generation = 0;
            bool orphan = f.ends_with(".aside") && fs::path(f).filename().string().starts_with('.');
            if (parse_tile_file_name(f, key, generation)) {
                const auto row = current.find(key);
                orphan = generation > index.generation() || (row != current.end() && row->second > generation);
            }
            if (orphan) remove_files(std::span(&f, 1));
        }
        return {};
    }
    /// Whether the background still gives the very cells of a level 0 tile.
    bool can_regenerate(const TileRow& row) const {
        if (row.key.level > 0) return true; // from the level below
        if (background.is_plain()) return false;
        auto block = LayerBlock::allocate(0, tile_rect(row.key, desc.tile_cells), 0, k_state_layers);
        if (!block.ok() || !background.read(*block).ok()) return false;
        const auto tile = make_stored_tile(row.key, desc.tile_cells, *block);
        return tile.ok() && hash_blocks(*tile) == row.blocks;
    }
};

namespace {

/// Writes the tiles of a commit and every parent above them, depth first: of each level four tiles are held at a time.
class CommitWriter {
  public:
    using Shown = std::function<Result<std::shared_ptr<const StoredTile>>(TileKey)>;
    using Write = std::function<Status(const StoredTile&)>;
    CommitWriter(std::span<const TileUpdate> updates, int tile_cells, Shown shown, Write write)
        : tile_cells_(tile_cells), shown_(std::move(shown)), write_(std::move(write)) {
        for (const TileUpdate& u : updates) updates_[u.key] = &u;
    }

    /// Which parents have to be made; `all`: every stored tile of level 0, this commit's included; `top`: the highest
    /// level that is stored.
    void plan(std::set<TileKey> all, int32_t top) {
        std::set<TileKey> fresh;
        for (const auto& [key, update] : updates_) fresh.insert(key);
        for (int32_t level = 1;
             level <= k_max_stored_level && (level == 1 || all.size() > k_few_top_tiles || level <= top); ++level) {
            std::set<TileKey> dirty, parents;
            for (const TileKey key : fresh) dirty.insert(key.parent());
            for (const TileKey key : all) parents.insert(key.parent());
            if (level > top) dirty = parents; // the first tiles of a new level: all of them
            all = std::move(parents);
            fresh = dirty;
            dirty_.push_back(std::move(dirty));
        }
    }
    Status run() {
        if (dirty_.empty()) return {};
        for (const TileKey key : dirty_.back()) SAHEL_TRY(make(key));
        return {};
    }

  private:
    Result<std::shared_ptr<const StoredTile>> make(TileKey key) { // NOLINT(misc-no-recursion)
        if (key.level == 0) {
            const auto update = updates_.find(key);
            return update == updates_.end() ? shown_(key) : written(make_leaf(*update->second));
        }
        if (!dirty_[static_cast<size_t>(key.level - 1)].contains(key)) return shown_(key);
        std::array<std::shared_ptr<const StoredTile>, 4> held;
        std::array<const StoredTile*, 4> children{};
        for (int q = 0; q < 4; ++q) {
            SAHEL_ASSIGN(held[static_cast<size_t>(q)], make(key.child(q)));
            children[static_cast<size_t>(q)] = held[static_cast<size_t>(q)].get();
        }
        return written(make_parent(key, children));
    }
    Result<StoredTile> make_leaf(const TileUpdate& u) const {
        if (u.block) return make_stored_tile(u.key, tile_cells_, *u.block);
        SAHEL_ASSIGN(LayerBlock block, LayerBlock::allocate(0, tile_rect(u.key, tile_cells_), 0, k_stored_layers));
        block.clear();
        SAHEL_TRY(u.fill(block));
        return make_stored_tile(u.key, tile_cells_, block);
    }
    Result<std::shared_ptr<const StoredTile>> written(Result<StoredTile> tile) const {
        if (!tile.ok()) return tile.error();
        SAHEL_TRY(write_(*tile));
        return std::make_shared<const StoredTile>(std::move(tile).value());
    }

    int tile_cells_;
    Shown shown_;
    Write write_;
    std::map<TileKey, const TileUpdate*> updates_;
    std::vector<std::set<TileKey>> dirty_; ///< of level 1, 2, ...
};

} // namespace

Status World::Impl::write_all(int64_t generation, int64_t step, std::span<const TileUpdate> updates,
                              std::vector<TileRow>& rows) const {
    std::set<TileKey> all;
    {
        SAHEL_ASSIGN(const auto stored, index.keys(0));
        all.insert(stored.begin(), stored.end());
    }
    for (const TileUpdate& u : updates) all.insert(u.key);
    SAHEL_ASSIGN(const int32_t top, index.top_level());
    CommitWriter writer(
        updates, desc.tile_cells, [this](TileKey key) { return shown(key); },
        [&](const StoredTile& tile) -> Status {
            SAHEL_ASSIGN(TileRow row, write_tile(tile, generation, step));
            rows.push_back(std::move(row));
            return {};
        });
    writer.plan(std::move(all), top);
    return writer.run();
}

Status World::Impl::check_extras(std::span<const TileUpdate> updates, const CommitExtras& extras) const {
    const auto bad = [&](const std::string& why) {
        return Error{ErrorKind::usage, fmt::format("{}: {}", folder.string(), why)};
    };
    for (const TileUpdate& u : updates) {
        if (u.takes_inbox) continue;
        SAHEL_ASSIGN(const bool waits, index.has_inbox(u.key));
        if (waits)
            return bad(
                fmt::format("something waits in the inbox of tile {},{}: take it, then commit", u.key.x, u.key.y));
    }
    const int64_t area = int64_t{desc.tile_cells} * desc.tile_cells;
    for (const Inbox& inbox : extras.inboxes) {
        const bool known = inbox.layer < Layer::count_ && info_of(inbox.layer).role == LayerRole::state &&
                           info_of(inbox.layer).type == LayerType::ticks;
        for (const InboxCell& c : inbox.cells)
            if (!known || inbox.key.level != 0 || c.cell < 0 || c.cell >= area)
                return bad(fmt::format("tile {},{} has no such cell to wait at", inbox.key.x, inbox.key.y));
    }
    return {};
}

// The digests of the blocks at which something waits, as they will be when it has arrived.
Result<std::vector<BlockDigest>> World::Impl::waiting_blocks(const std::vector<Inbox>& waiting) const {
    constexpr int k = k_hash_block_cells;
    const int n = desc.tile_cells;
    std::map<std::pair<int64_t, int64_t>, std::vector<int32_t>> blocks; // by y, x of the block
    for (const Inbox& inbox : waiting) {
        SAHEL_ASSIGN(const auto stored, load(inbox.key));
        size_t plane = 0; // of the layer, among those of the state
        k_state_layers.for_each([&](Layer l) { plane += l < inbox.layer; });
        for (const InboxCell& c : inbox.cells) {
            const int bx = c.cell % n / k, by = c.cell / n / k;
            const int64_t block_y = inbox.key.y * (n / k) + by, block_x = inbox.key.x * (n / k) + bx;
            std::vector<int32_t>& cells = blocks[{block_y, block_x}];
            if (cells.empty() && stored) {
                cells = block_cells(*stored, bx, by);
            } else if (cells.empty()) {
                SAHEL_ASSIGN(LayerBlock block,
                             LayerBlock::allocate(0, tile_rect({0, block_x, block_y}, k), 0, k_state_layers));
                SAHEL_TRY(background.read(block));
                SAHEL_ASSIGN(const StoredTile tile, make_stored_tile({0, block_x, block_y}, k, block));
                cells = block_cells(tile, 0, 0);
            }
            auto& cell = reinterpret_cast<uint32_t&>(
                cells[(plane * k + static_cast<size_t>(c.cell / n % k)) * k + static_cast<size_t>(c.cell % n % k)]);
            cell += static_cast<uint32_t>(c.ticks);
        }
    }
    std::vector<BlockDigest> digests;
    for (const auto& [place, cells] : blocks) digests.push_back({place.first, place.second, hash_cells(cells)});
    return digests;
}

Status World::Impl::commit(int64_t step, std::span<const TileUpdate> updates, const CommitExtras& extras) {
    if (mode != OpenMode::write)
        return Error{ErrorKind::usage,
                     fmt::format("{}: opened for reading; open it for writing to commit", folder.string())};
    if (step < index.step())
        return Error{ErrorKind::usage,
                     fmt::format("{}: step {} lies before the committed step {}", folder.string(), step, index.step())};
    std::unordered_set<TileKey> seen;
    std::vector<TileKey> taken;
    for (const TileUpdate& u : updates) {
        SAHEL_CHECK(u.block != nullptr || u.fill);
        if (u.takes_inbox) taken.push_back(u.key);
        if (u.key.level != 0 || !seen.insert(u.key).second)
            return Error{ErrorKind::usage, fmt::format("{}: a commit holds each level 0 tile once", folder.string())};
        if (!is_storable(u.key))
            return Error{ErrorKind::usage, fmt::format("{}: tile {},{} lies beyond the ends of any world",
                                                       folder.string(), u.key.x, u.key.y)};
    }
    SAHEL_TRY(check_extras(updates, extras));
    const int64_t generation = index.generation() + 1;
    std::vector<TileRow> rows;
    std::vector<std::string> replaced;
    Status status = write_all(generation, step, updates, rows);
    for (size_t i = 0; status.ok() && i < rows.size(); ++i) {
        auto old = index.find(rows[i].key);
        if (!old.ok())
            status = old.error();
        else if (*old)
            replaced.push_back((*old)->file);
    }
    {
        const std::lock_guard guard(mutex);
        if (status.ok()) status = index.commit(generation, step, rows, taken, extras);
    }
    if (!status.ok()) { // nothing points to the new files: as if they had never been
        std::vector<std::string> files;
        for (const TileRow& r : rows) files.push_back(r.file);
        remove_files(files);
        return in_world(folder, status);
    }
    cache.clear();
    remove_files(replaced);
    return in_world(folder, refresh_top());
}

World::World(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;
World::~World() = default;

Result<World> World::create(const fs::path& folder, const WorldDesc& desc) {
    SAHEL_TRY(check_world_desc(desc, folder.string()));
    std::error_code error;
    if (fs::exists(folder, error) && (!fs::is_directory(folder, error) || !fs::is_empty(folder, error)))
        return Error{ErrorKind::usage,
                     fmt::format("{}: exists already and is not empty; choose another folder", folder.string())};
    SAHEL_TRY(make_folder(folder));
    SAHEL_ASSIGN(WriterLock lock, WriterLock::take(folder));
    {
        auto index = StoreIndex::create(folder / "index.sqlite", desc, world_json(desc));
        if (!index.ok()) return index.error();
    }
    SAHEL_TRY(make_folder(folder / "tiles"));
    // world.json comes last: a folder without it is not a world yet.
    SAHEL_TRY(write_file(folder / "world.json", world_json(desc)));
    { const WriterLock released = std::move(lock); }
    return open(folder, OpenMode::write);
}

Result<World> World::open(const fs::path& folder, OpenMode mode) {
    std::error_code error;
    if (!fs::is_directory(folder, error))
        return Error{ErrorKind::not_found, fmt::format("{}: there is no such world", folder.string())};
    const fs::path json = folder / "world.json";
    if (!fs::exists(json, error))
        return Error{ErrorKind::not_found, fmt::format("{}: is not a world (it has no world.json)", folder.string())};
    SAHEL_ASSIGN(const std::string text, read_text_file(json));
    SAHEL_ASSIGN(WorldDesc desc, parse_world_json(text, json.string()));
    std::optional<WriterLock> lock;
    if (mode == OpenMode::write) {
        SAHEL_ASSIGN(lock, WriterLock::take(folder));
    }
    auto index = StoreIndex::open(folder / "index.sqlite", mode, desc);
    if (!index.ok()) return in_world(folder, index.error()).error();
    auto impl = std::make_unique<Impl>(folder, std::move(desc), mode, std::move(lock), std::move(index).value());
    if (mode == OpenMode::write) SAHEL_TRY(in_world(folder, impl->forget_orphans()));
    SAHEL_TRY(in_world(folder, impl->refresh_top()));
    return World(std::move(impl));
}

const fs::path& World::folder() const {
    return impl_->folder;
}

const WorldDesc& World::desc() const {
    return impl_->desc;
}

Status World::commit(int64_t step, std::span<const TileUpdate> tiles, const CommitExtras& extras) {
    return impl_->commit(step, tiles, extras);
}

Result<std::vector<Inbox>> World::inboxes(std::optional<TileKey> key) const {
    const std::lock_guard guard(impl_->mutex);
    return impl_->index.inboxes(key);
}

Result<std::vector<LedgerRow>> World::ledger() const {
    const std::lock_guard guard(impl_->mutex);
    return impl_->index.ledger();
}

Result<std::vector<uint8_t>> World::resume() const {
    const std::lock_guard guard(impl_->mutex);
    return impl_->index.resume();
}

Result<bool> World::has_tile(TileKey key) const {
    const std::lock_guard guard(impl_->mutex);
    SAHEL_ASSIGN(const auto row, impl_->index.find(key));
    return row.has_value();
}

Result<std::vector<TileKey>> World::tiles(int32_t level) const {
    const std::lock_guard guard(impl_->mutex);
    return impl_->index.keys(level);
}

Result<LayerBlock> World::read_tile(TileKey key, LayerSet layers, MemoryPool& pool) const {
    SAHEL_ASSIGN(const auto tile, impl_->load(key));
    if (!tile)
        return Error{ErrorKind::not_found, fmt::format("{}: tile {},{} of level {} is not stored",
                                                       impl_->folder.string(), key.x, key.y, key.level)};
    SAHEL_ASSIGN(LayerBlock block,
                 LayerBlock::allocate(key.level, tile_rect(key, impl_->desc.tile_cells), 0, layers, pool));
    block.clear();
    layers.intersected(k_stored_layers).for_each([&](Layer layer) {
        for (int y = 0; y < impl_->desc.tile_cells; ++y) {
            int32_t* to = info_of(layer).type == LayerType::real ? reinterpret_cast<int32_t*>(block.reals(layer).row(y))
                                                                 : block.ints(layer).row(y);
            tile->copy_row(layer, 0, y, impl_->desc.tile_cells, to);
        }
    });
    return block;
}

const SurfaceSource& World::surface() const {
    return impl_->surface;
}

Result<WorldInfo> World::info() const {
    const std::lock_guard guard(impl_->mutex);
    SAHEL_ASSIGN(const auto rows, impl_->index.rows(std::nullopt, false));
    WorldInfo info;
    info.step = impl_->index.step();
    bool first = true;
    for (const TileRow& r : rows) {
        info.disk_bytes += r.bytes;
        if (r.key.level > 0) {
            ++info.parent_count;
            continue;
        }
        ++info.tile_count;
        const CellRect c = tile_rect(r.key, impl_->desc.tile_cells);
        info.bounds = first ? c
                            : CellRect{std::min(info.bounds.x0, c.x0), std::min(info.bounds.y0, c.y0),
                                       std::max(info.bounds.x1, c.x1), std::max(info.bounds.y1, c.y1)};
        info.min_surface_m = first ? r.low_m : std::min(info.min_surface_m, r.low_m);
        info.max_surface_m = first ? r.high_m : std::max(info.max_surface_m, r.high_m);
        first = false;
    }
    std::error_code ignored;
    for (const char* name : {"world.json", "index.sqlite", "index.sqlite-wal"})
        if (const auto size = fs::file_size(impl_->folder / name, ignored); !ignored) info.disk_bytes += size;
    return info;
}

Result<std::string> World::hash() const {
    std::vector<BlockDigest> blocks;
    std::vector<Inbox> waiting;
    {
        const std::lock_guard guard(impl_->mutex);
        SAHEL_ASSIGN(const auto rows, impl_->index.rows(0, true));
        for (const TileRow& r : rows) blocks.insert(blocks.end(), r.blocks.begin(), r.blocks.end());
        SAHEL_ASSIGN(waiting, impl_->index.inboxes(std::nullopt));
    }
    if (!waiting.empty()) {
        SAHEL_ASSIGN(std::vector<BlockDigest> changed, impl_->waiting_blocks(waiting));
        std::set<std::pair<int64_t, int64_t>> places;
        for (const BlockDigest& b : changed) places.insert({b.y, b.x});
        std::erase_if(blocks, [&](const BlockDigest& b) { return places.contains({b.y, b.x}); });
        blocks.insert(blocks.end(), changed.begin(), changed.end());
    }
    return hash_world(std::move(blocks));
}

Result<VerifyReport> World::verify(const std::function<void(int64_t, int64_t)>& progress) const {
    const std::lock_guard guard(impl_->mutex);
    VerifyReport report;
    SAHEL_ASSIGN(const std::string text, read_text_file(impl_->folder / "world.json"));
    if (const std::string& made = impl_->index.description(); !made.empty() && text != made)
        report.issues.push_back(
            {"world.json", "not what was written; if you edited it, say so: sahel verify --accept-edits", false});
    SAHEL_ASSIGN(const std::string index_state, impl_->index.integrity());
    if (index_state != "ok") report.issues.push_back({"index.sqlite", "damaged: " + index_state, false});
    auto all_rows = impl_->index.rows(std::nullopt, true);
    if (!all_rows.ok() && all_rows.error().kind == ErrorKind::corrupt) {
        report.issues.push_back({"index.sqlite", all_rows.error().message, false});
        return report;
    }
    SAHEL_ASSIGN(const auto rows, std::move(all_rows));
    std::vector<std::string> damaged;
    SAHEL_TRY(impl_->index.inboxes(std::nullopt, &damaged));
    SAHEL_TRY(impl_->index.ledger(&damaged));
    SAHEL_TRY(impl_->index.resume(&damaged));
    for (const std::string& what : damaged)
        report.issues.push_back({"index.sqlite", what + " is not what was written", false});
    std::set<std::string> known;
    for (const TileRow& r : rows) {
        known.insert(r.file);
        std::error_code error;
        if (!fs::exists(impl_->folder / r.file, error)) {
            report.issues.push_back({r.file, "missing", impl_->can_regenerate(r)});
        } else if (auto tile = impl_->read_row(r); !tile.ok()) {
            report.issues.push_back({r.file, tile.error().message, impl_->can_regenerate(r)});
        } else if (r.key.level == 0 && hash_blocks(*tile) != r.blocks) {
            report.issues.push_back({r.file, "the index holds other state hashes than the tile", false});
        }
        ++report.files_checked;
        report.bytes_checked += r.bytes;
        if (progress) progress(report.files_checked, static_cast<int64_t>(rows.size()));
    }
    for (const std::string& f : impl_->files_on_disk())
        if (!known.contains(f)) report.issues.push_back({f, "does not belong to this world; it can be deleted", false});
    return report;
}

Status World::accept_description() {
    if (impl_->mode != OpenMode::write)
        return Error{ErrorKind::usage, fmt::format("{}: opened for reading", impl_->folder.string())};
    const std::lock_guard guard(impl_->mutex);
    SAHEL_ASSIGN(const std::string text, read_text_file(impl_->folder / "world.json"));
    return in_world(impl_->folder, impl_->index.set_description(text));
}

} // namespace sahel
