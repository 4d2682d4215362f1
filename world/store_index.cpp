#include "world/store_index.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <map>
#include <utility>

namespace sahel {

namespace {

constexpr const char* k_schema = R"SQL(
PRAGMA journal_mode = WAL;
PRAGMA synchronous = FULL;
BEGIN;
CREATE TABLE meta(key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE commits(generation INTEGER PRIMARY KEY, step INTEGER NOT NULL, tiles INTEGER NOT NULL,
                     digest TEXT NOT NULL);
CREATE TABLE tiles(level INTEGER, x INTEGER, y INTEGER, file TEXT NOT NULL, bytes INTEGER NOT NULL, checksum TEXT NOT NULL,
                   generation INTEGER NOT NULL, step INTEGER NOT NULL, low_m REAL, high_m REAL, blocks BLOB, digest TEXT NOT NULL,
                   PRIMARY KEY(level, y, x)) WITHOUT ROWID;
COMMIT;
)SQL";

constexpr const char* k_schema_2 = R"SQL(
BEGIN;
CREATE TABLE inbox(x INTEGER, y INTEGER, layer TEXT, cells BLOB NOT NULL, checksum TEXT NOT NULL,
                   PRIMARY KEY(y, x, layer)) WITHOUT ROWID;
CREATE TABLE ledger(x INTEGER, y INTEGER, account BLOB NOT NULL, checksum TEXT NOT NULL, PRIMARY KEY(y, x)) WITHOUT ROWID;
CREATE TABLE resume(id INTEGER PRIMARY KEY CHECK(id = 0), blob BLOB NOT NULL, checksum TEXT NOT NULL);
UPDATE meta SET value = '2' WHERE key = 'format_version';
COMMIT;
)SQL";

std::vector<uint8_t> pack(const std::vector<BlockDigest>& blocks) {
    std::vector<uint8_t> bytes(blocks.size() * sizeof(BlockDigest));
    if (!bytes.empty()) std::memcpy(bytes.data(), blocks.data(), bytes.size());
    return bytes;
}
static_assert(sizeof(BlockDigest) == 32);

std::vector<BlockDigest> unpack(const std::vector<uint8_t>& bytes) {
    std::vector<BlockDigest> blocks(bytes.size() / sizeof(BlockDigest));
    if (!blocks.empty()) std::memcpy(blocks.data(), bytes.data(), blocks.size() * sizeof(BlockDigest));
    return blocks;
}

// An inbox: 12 bytes a cell, its number and its ticks, in rising order.
constexpr size_t k_inbox_cell_bytes = 12;

std::vector<uint8_t> pack(const std::map<int32_t, int64_t>& cells) {
    std::vector<uint8_t> bytes(cells.size() * k_inbox_cell_bytes);
    uint8_t* to = bytes.data();
    for (const auto& [cell, ticks] : cells) {
        std::memcpy(to, &cell, 4);
        std::memcpy(to + 4, &ticks, 8);
        to += k_inbox_cell_bytes;
    }
    return bytes;
}

bool unpack_inbox(const std::vector<uint8_t>& bytes, int64_t tile_area, std::vector<InboxCell>& cells) {
    if (bytes.size() % k_inbox_cell_bytes != 0) return false;
    cells.resize(bytes.size() / k_inbox_cell_bytes);
    int32_t last = -1;
    const uint8_t* from = bytes.data();
    for (InboxCell& c : cells) {
        std::memcpy(&c.cell, from, 4);
        std::memcpy(&c.ticks, from + 4, 8);
        from += k_inbox_cell_bytes;
        if (c.cell <= last || c.cell >= tile_area) return false;
        last = c.cell;
    }
    return true;
}

constexpr const char* k_columns = "level, x, y, file, bytes, checksum, generation, step, low_m, high_m";

std::string digest_of(const std::string& text) {
    return to_hex(checksum({reinterpret_cast<const uint8_t*>(text.data()), text.size()}));
}
std::string digest_of(const TileRow& r) {
    return digest_of(fmt::format("{} {} {} {} {} {} {} {} {} {} {}", r.key.level, r.key.x, r.key.y, r.file, r.bytes,
                                 r.checksum, r.generation, r.step, r.low_m, r.high_m,
                                 to_hex(checksum(pack(r.blocks)))));
}
/// Of what a blob is and where it belongs, too.
std::string digest_of(std::string_view what, TileKey key, std::span<const uint8_t> bytes) {
    return digest_of(fmt::format("{} {} {} {}", what, key.x, key.y, to_hex(checksum(bytes))));
}
std::string digest_of_commit(int64_t generation, int64_t step, int64_t tiles) {
    return digest_of(fmt::format("{} {} {}", generation, step, tiles));
}

Error damaged(const std::string& what) {
    return {ErrorKind::corrupt, fmt::format("index.sqlite: {}; run sahel verify, or restore the file", what)};
}

Result<TileRow> read_row(const sqlite::Statement& s) {
    TileRow r;
    const int64_t level = s.integer(0);
    r.key = {static_cast<int32_t>(std::clamp<int64_t>(level, -1, 1000)), s.integer(1), s.integer(2)};
    r.file = s.text(3);
    r.bytes = static_cast<uint64_t>(s.integer(4));
    r.checksum = s.text(5);
    r.generation = s.integer(6);
    r.step = s.integer(7);
    r.low_m = static_cast<float>(s.real(8));
    r.high_m = static_cast<float>(s.real(9));
    if (!is_storable(r.key) || r.file != tile_file_name(r.key, r.generation))
        return damaged(
            fmt::format("the row of tile {},{} of level {} names no file of its own", r.key.x, r.key.y, level));
    return r;
}

std::string cell_text(double cell_m) {
    return fmt::format("{}", cell_m);
}

} // namespace

std::string tile_file_name(TileKey key, int64_t generation) {
    return fmt::format("tiles/L{:02}/s{}_{}/{}_{}.g{}.exr", key.level, key.x >> 5, key.y >> 5, key.x, key.y,
                       generation);
}

bool parse_tile_file_name(const std::string& file, TileKey& key, int64_t& generation) {
    long long x = 0, y = 0, g = 0;
    int level = 0;
    if (std::sscanf(file.c_str(), "tiles/L%2d/s%*[-0-9]_%*[-0-9]/%lld_%lld.g%lld.exr", &level, &x, &y, &g) != 4)
        return false;
    key = {level, x, y};
    generation = g;
    return file == tile_file_name(key, generation);
}

Result<StoreIndex> StoreIndex::create(const std::filesystem::path& path, const WorldDesc& desc,
                                      std::string_view description) {
    SAHEL_ASSIGN(sqlite::Database db, sqlite::Database::open(path, sqlite::Database::Mode::create));
    SAHEL_TRY(db.run(k_schema));
    StoreIndex index(std::move(db));
    index.version_ = k_world_format_version;
    index.tile_area_ = int64_t{desc.tile_cells} * desc.tile_cells;
    sqlite::Statement put(index.db_, "INSERT INTO meta(key, value) VALUES(?, ?)");
    for (const auto& [key, value] :
         {std::pair<std::string, std::string>{"format_version", std::to_string(k_world_format_version)},
          {"tile_cells", std::to_string(desc.tile_cells)},
          {"cell_m", cell_text(desc.cell_m)},
          {"description", std::string(description)}}) {
        put.bind(1, std::string_view(key)).bind(2, std::string_view(value));
        (void)put.step();
        SAHEL_TRY(put.status());
        put.reset();
    }
    SAHEL_TRY(index.db_.run(k_schema_2));
    return index;
}

Result<StoreIndex> StoreIndex::open(const std::filesystem::path& path, OpenMode mode, const WorldDesc& desc) {
    SAHEL_ASSIGN(sqlite::Database db,
                 sqlite::Database::open(path, mode == OpenMode::write ? sqlite::Database::Mode::write
                                                                      : sqlite::Database::Mode::read));
    if (mode == OpenMode::write) SAHEL_TRY(db.run("PRAGMA synchronous = FULL"));
    StoreIndex index(std::move(db));
    SAHEL_TRY(index.check_meta(desc));
    index.tile_area_ = int64_t{desc.tile_cells} * desc.tile_cells;
    if (mode == OpenMode::write && index.version_ < 2) {
        if (const Status made = index.db_.run(k_schema_2); !made.ok()) {
            (void)index.db_.run("ROLLBACK");
            return made.error();
        }
        index.version_ = 2;
    }
    sqlite::Statement last(index.db_,
                           "SELECT generation, step, tiles, digest FROM commits ORDER BY generation DESC LIMIT 1");
    if (last.step()) {
        index.generation_ = last.integer(0);
        index.step_ = last.integer(1);
        if (last.text(3) != digest_of_commit(last.integer(0), last.integer(1), last.integer(2)))
            return damaged("the row of the last commit is not what was written");
    }
    SAHEL_TRY(last.status());
    return index;
}

Status StoreIndex::check_meta(const WorldDesc& desc) {
    sqlite::Statement all(db_, "SELECT key, value FROM meta");
    int found = 0;
    while (all.step()) {
        const std::string key = all.text(0), value = all.text(1);
        if (key == "format_version") {
            ++found;
            version_ = std::atoi(value.c_str());
            if (version_ < 1) return damaged("its format version is no number");
            if (version_ > k_world_format_version)
                return Error{ErrorKind::unsupported,
                             fmt::format("index.sqlite: world format {} is newer than this program's {}; use "
                                         "a newer sahel",
                                         value, k_world_format_version)};
        }
        if (key == "description") description_ = value;
        const std::string wanted = key == "tile_cells" ? std::to_string(desc.tile_cells)
                                   : key == "cell_m"   ? cell_text(desc.cell_m)
                                                       : "";
        if (!wanted.empty()) {
            ++found;
            if (wanted != value)
                return Error{ErrorKind::corrupt,
                             fmt::format("world.json says {} {}, but the tiles were written with {}; set it back", key,
                                         wanted, value)};
        }
    }
    SAHEL_TRY(all.status());
    if (found != 3) return damaged("its description of the world is incomplete");
    return {};
}

Result<std::optional<TileRow>> StoreIndex::find(TileKey key) const {
    sqlite::Statement s(db_,
                        fmt::format("SELECT {} FROM tiles WHERE level = ? AND y = ? AND x = ?", k_columns).c_str());
    s.bind(1, int64_t{key.level}).bind(2, key.y).bind(3, key.x);
    std::optional<TileRow> row;
    if (s.step()) {
        SAHEL_ASSIGN(row, read_row(s));
    }
    SAHEL_TRY(s.status());
    return row;
}

Result<std::vector<TileRow>> StoreIndex::rows(std::optional<int32_t> level, bool with_blocks) const {
    sqlite::Statement s(
        db_, fmt::format("SELECT {}, digest{} FROM tiles WHERE level >= ? AND level <= ? ORDER BY level, y, x",
                         k_columns, with_blocks ? ", blocks" : "")
                 .c_str());
    s.bind(1, int64_t{level.value_or(INT32_MIN)}).bind(2, int64_t{level.value_or(INT32_MAX)});
    std::vector<TileRow> rows;
    while (s.step()) {
        SAHEL_ASSIGN(TileRow row, read_row(s));
        if (with_blocks) {
            const std::vector<uint8_t> blob = s.blob(11);
            row.blocks = unpack(blob);
            if (blob.size() % sizeof(BlockDigest) != 0 || s.text(10) != digest_of(row))
                return damaged(fmt::format("the row of {} is not what was written", row.file));
        }
        rows.push_back(std::move(row));
    }
    SAHEL_TRY(s.status());
    return rows;
}

Result<std::vector<TileKey>> StoreIndex::keys(int32_t level) const {
    sqlite::Statement s(db_, "SELECT x, y FROM tiles WHERE level = ? ORDER BY y, x");
    s.bind(1, int64_t{level});
    std::vector<TileKey> keys;
    while (s.step()) keys.push_back({level, s.integer(0), s.integer(1)});
    SAHEL_TRY(s.status());
    for (const TileKey key : keys)
        if (!is_storable(key)) return damaged(fmt::format("tile {},{} of level {} cannot be", key.x, key.y, level));
    return keys;
}

Result<int32_t> StoreIndex::top_level() const {
    sqlite::Statement s(db_, "SELECT ifnull(max(level), -1) FROM tiles");
    int32_t top = -1;
    if (s.step()) {
        if (s.integer(0) > k_max_terrain_level) return damaged("a level is too high");
        top = static_cast<int32_t>(s.integer(0));
    }
    SAHEL_TRY(s.status());
    return top;
}

Status StoreIndex::write_rows(int64_t generation, int64_t step, std::span<const TileRow> rows) {
    sqlite::Statement put(
        db_, "INSERT OR REPLACE INTO tiles(level, x, y, file, bytes, checksum, generation, step, low_m, high_m, "
             "blocks, digest) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
    for (const TileRow& r : rows) {
        const std::vector<uint8_t> blocks = pack(r.blocks);
        const std::string digest = digest_of(r);
        put.bind(1, int64_t{r.key.level}).bind(2, r.key.x).bind(3, r.key.y).bind(4, std::string_view(r.file));
        put.bind(5, static_cast<int64_t>(r.bytes))
            .bind(6, std::string_view(r.checksum))
            .bind(7, r.generation)
            .bind(8, r.step);
        put.bind(9, static_cast<double>(r.low_m))
            .bind(10, static_cast<double>(r.high_m))
            .bind(11, std::span(blocks))
            .bind(12, std::string_view(digest));
        (void)put.step();
        SAHEL_TRY(put.status());
        put.reset();
    }
    sqlite::Statement note(db_, "INSERT INTO commits(generation, step, tiles, digest) VALUES(?, ?, ?, ?)");
    const auto tiles = static_cast<int64_t>(rows.size());
    const std::string digest = digest_of_commit(generation, step, tiles);
    note.bind(1, generation).bind(2, step).bind(3, tiles).bind(4, std::string_view(digest));
    (void)note.step();
    return note.status();
}

Status StoreIndex::write_extras(std::span<const TileKey> taken, const CommitExtras& extras) {
    sqlite::Statement empty(db_, "DELETE FROM inbox WHERE y = ? AND x = ?");
    for (const TileKey key : taken) {
        empty.bind(1, key.y).bind(2, key.x);
        (void)empty.step();
        SAHEL_TRY(empty.status());
        empty.reset();
    }
    std::map<std::pair<TileKey, Layer>, std::map<int32_t, int64_t>> added;
    for (const Inbox& inbox : extras.inboxes)
        for (const InboxCell& c : inbox.cells)
            if (c.ticks != 0) added[{inbox.key, inbox.layer}][c.cell] += c.ticks;
    sqlite::Statement fill(db_, "INSERT OR REPLACE INTO inbox(x, y, layer, cells, checksum) VALUES(?, ?, ?, ?, ?)");
    for (auto& [place, cells] : added) {
        SAHEL_ASSIGN(const std::vector<Inbox> waiting, inboxes(place.first));
        for (const Inbox& inbox : waiting)
            if (inbox.layer == place.second)
                for (const InboxCell& c : inbox.cells) cells[c.cell] += c.ticks;
        const std::vector<uint8_t> bytes = pack(cells);
        const std::string sum = digest_of(info_of(place.second).name, place.first, bytes);
        fill.bind(1, place.first.x).bind(2, place.first.y).bind(3, info_of(place.second).name);
        fill.bind(4, std::span(bytes)).bind(5, std::string_view(sum));
        (void)fill.step();
        SAHEL_TRY(fill.status());
        fill.reset();
    }
    sqlite::Statement account(db_, "INSERT OR REPLACE INTO ledger(x, y, account, checksum) VALUES(?, ?, ?, ?)");
    for (const LedgerRow& row : extras.ledger) {
        const std::string sum = digest_of("ledger", row.key, row.bytes);
        account.bind(1, row.key.x).bind(2, row.key.y).bind(3, std::span(row.bytes)).bind(4, std::string_view(sum));
        (void)account.step();
        SAHEL_TRY(account.status());
        account.reset();
    }
    SAHEL_TRY(db_.run("DELETE FROM resume"));
    if (extras.resume.empty()) return {};
    sqlite::Statement resume(db_, "INSERT INTO resume(id, blob, checksum) VALUES(0, ?, ?)");
    const std::string sum = digest_of("resume", {}, extras.resume);
    resume.bind(1, extras.resume).bind(2, std::string_view(sum));
    (void)resume.step();
    return resume.status();
}

Status StoreIndex::commit(int64_t generation, int64_t step, std::span<const TileRow> rows,
                          std::span<const TileKey> taken, const CommitExtras& extras) {
    SAHEL_TRY(db_.run("BEGIN IMMEDIATE"));
    Status written = write_rows(generation, step, rows);
    if (written.ok()) written = write_extras(taken, extras);
    if (written.ok()) written = db_.run("COMMIT");
    if (!written.ok()) {
        (void)db_.run("ROLLBACK");
        return written;
    }
    generation_ = generation;
    step_ = step;
    return {};
}

namespace {

// A row that is not what was written: noted, or an error.
Status damaged_row(std::vector<std::string>* damaged, std::string what) {
    if (!damaged) return sahel::damaged(what + " is not what was written");
    damaged->push_back(std::move(what));
    return {};
}

} // namespace

Result<std::vector<Inbox>> StoreIndex::inboxes(std::optional<TileKey> key, std::vector<std::string>* damaged) const {
    std::vector<Inbox> list;
    if (version_ < 2) return list;
    sqlite::Statement s(db_, key ? "SELECT x, y, layer, cells, checksum FROM inbox WHERE y = ? AND x = ? ORDER BY layer"
                                 : "SELECT x, y, layer, cells, checksum FROM inbox ORDER BY y, x, layer");
    if (key) s.bind(1, key->y).bind(2, key->x);
    while (s.step()) {
        Inbox inbox{{0, s.integer(0), s.integer(1)}, Layer::count_, {}};
        const std::string name = s.text(2);
        for (const LayerInfo& info : k_layers)
            if (info.name == name && info.role == LayerRole::state && info.type == LayerType::ticks)
                inbox.layer = info.layer;
        const std::vector<uint8_t> bytes = s.blob(3);
        if (inbox.layer == Layer::count_ || digest_of(name, inbox.key, bytes) != s.text(4) ||
            !unpack_inbox(bytes, tile_area_, inbox.cells)) {
            SAHEL_TRY(
                damaged_row(damaged, fmt::format("what waits for tile {},{} ({})", inbox.key.x, inbox.key.y, name)));
            continue;
        }
        list.push_back(std::move(inbox));
    }
    SAHEL_TRY(s.status());
    return list;
}

Result<bool> StoreIndex::has_inbox(TileKey key) const {
    if (version_ < 2) return false;
    sqlite::Statement s(db_, "SELECT 1 FROM inbox WHERE y = ? AND x = ? LIMIT 1");
    s.bind(1, key.y).bind(2, key.x);
    const bool found = s.step();
    SAHEL_TRY(s.status());
    return found;
}

Result<std::vector<LedgerRow>> StoreIndex::ledger(std::vector<std::string>* damaged) const {
    std::vector<LedgerRow> rows;
    if (version_ < 2) return rows;
    sqlite::Statement s(db_, "SELECT x, y, account, checksum FROM ledger ORDER BY y, x");
    while (s.step()) {
        LedgerRow row{{0, s.integer(0), s.integer(1)}, s.blob(2)};
        if (digest_of("ledger", row.key, row.bytes) != s.text(3)) {
            SAHEL_TRY(damaged_row(damaged, fmt::format("the account of tile {},{}", row.key.x, row.key.y)));
            continue;
        }
        rows.push_back(std::move(row));
    }
    SAHEL_TRY(s.status());
    return rows;
}

Result<std::vector<uint8_t>> StoreIndex::resume(std::vector<std::string>* damaged) const {
    std::vector<uint8_t> bytes;
    if (version_ < 2) return bytes;
    sqlite::Statement s(db_, "SELECT blob, checksum FROM resume");
    if (s.step()) {
        bytes = s.blob(0);
        if (digest_of("resume", {}, bytes) != s.text(1)) {
            SAHEL_TRY(damaged_row(damaged, "what the last run left to go on with"));
            bytes.clear();
        }
    }
    SAHEL_TRY(s.status());
    return bytes;
}

Result<std::string> StoreIndex::integrity() const {
    sqlite::Statement s(db_, "PRAGMA integrity_check(1)");
    std::string answer;
    if (s.step()) answer = s.text(0);
    SAHEL_TRY(s.status());
    if (answer != "ok") return answer;
    sqlite::Statement all(db_, "SELECT generation, step, tiles, digest FROM commits ORDER BY generation");
    int64_t count = 0, step = INT64_MIN;
    while (all.step()) {
        const int64_t generation = all.integer(0);
        if (generation != ++count || all.integer(1) < step ||
            all.text(3) != digest_of_commit(generation, all.integer(1), all.integer(2)))
            return fmt::format("commit {} is not what was written", count);
        step = all.integer(1);
    }
    SAHEL_TRY(all.status());
    return answer;
}

Status StoreIndex::set_description(std::string_view text) {
    sqlite::Statement put(db_, "INSERT OR REPLACE INTO meta(key, value) VALUES('description', ?)");
    put.bind(1, text);
    (void)put.step();
    SAHEL_TRY(put.status());
    description_ = text;
    return {};
}

} // namespace sahel
