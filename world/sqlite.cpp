#include "world/sqlite.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <utility>

namespace sahel::sqlite {

Result<Database> Database::open(const std::filesystem::path& path, Mode mode) {
    std::error_code ignored;
    if (mode != Mode::create && !std::filesystem::exists(path, ignored))
        return Error{ErrorKind::not_found, fmt::format("{}: no such file", path.string())};
    const int flags = mode == Mode::read    ? SQLITE_OPEN_READONLY
                      : mode == Mode::write ? SQLITE_OPEN_READWRITE
                                            : SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
    const auto attempt = [&](const std::string& name, int more) -> Result<Database> {
        sqlite3* raw = nullptr;
        const int code = sqlite3_open_v2(name.c_str(), &raw, flags | more, nullptr);
        Database db(raw, path.string());
        if (code != SQLITE_OK) return db.error("cannot be opened");
        sqlite3_busy_timeout(raw, 10000);
        // A world may come from anywhere: no code in its schema, no writing to it but through tables.
        for (const int off :
             {SQLITE_DBCONFIG_TRUSTED_SCHEMA, SQLITE_DBCONFIG_ENABLE_TRIGGER, SQLITE_DBCONFIG_ENABLE_VIEW})
            sqlite3_db_config(raw, off, 0, nullptr);
        sqlite3_db_config(raw, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
        // The first read finds out whether it is a database, and whether its log can be used.
        Statement probe(db, "SELECT count(*) FROM sqlite_master");
        (void)probe.step();
        if (const Status s = probe.status(); !s.ok()) return s.error();
        return db;
    };
    auto opened = attempt(path.string(), 0);
    if (opened.ok() || mode != Mode::read || opened.error().kind == ErrorKind::corrupt) return opened;
    // A reader of a WAL database needs to make its shared memory file; where it may not, nobody writes either. But what
    // a killed writer left in the log counts, and would not be read.
    std::error_code no_log;
    const auto log_bytes = std::filesystem::file_size(path.string() + "-wal", no_log);
    if (!no_log && log_bytes > 0)
        return Error{ErrorKind::io, fmt::format("{}: its log must be played back, and the folder cannot be written; "
                                                "copy the world to one that can",
                                                path.string())};
    return attempt("file:" + path.string() + "?immutable=1", SQLITE_OPEN_URI);
}

Database::Database(Database&& o) noexcept : db_(std::exchange(o.db_, nullptr)), name_(std::move(o.name_)) {}

Database& Database::operator=(Database&& o) noexcept {
    std::swap(db_, o.db_);
    std::swap(name_, o.name_);
    return *this;
}

Database::~Database() {
    sqlite3_close(db_);
}

Status Database::run(const char* sql) {
    if (sqlite3_exec(db_, sql, nullptr, nullptr, nullptr) == SQLITE_OK) return {};
    return error(sql);
}

Error Database::error(std::string_view what) const {
    const int code = db_ ? sqlite3_errcode(db_) : SQLITE_NOMEM;
    ErrorKind kind = ErrorKind::io;
    if (code == SQLITE_CORRUPT || code == SQLITE_NOTADB) kind = ErrorKind::corrupt;
    if (code == SQLITE_BUSY || code == SQLITE_LOCKED) kind = ErrorKind::busy;
    return {kind, fmt::format("{}: {}: {}", name_, what, db_ ? sqlite3_errmsg(db_) : "no memory")};
}

Statement::Statement(const Database& db, const char* sql) : db_(db) {
    code_ = sqlite3_prepare_v2(db.handle(), sql, -1, &statement_, nullptr);
}

Statement::~Statement() {
    sqlite3_finalize(statement_);
}

Statement& Statement::bind(int index, int64_t value) {
    if (code_ == SQLITE_OK) code_ = sqlite3_bind_int64(statement_, index, value);
    return *this;
}
Statement& Statement::bind(int index, double value) {
    if (code_ == SQLITE_OK) code_ = sqlite3_bind_double(statement_, index, value);
    return *this;
}
Statement& Statement::bind(int index, std::string_view text) {
    if (code_ == SQLITE_OK)
        code_ = sqlite3_bind_text(statement_, index, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
    return *this;
}
Statement& Statement::bind(int index, std::span<const uint8_t> blob) {
    if (code_ == SQLITE_OK)
        code_ = sqlite3_bind_blob(statement_, index, blob.data(), static_cast<int>(blob.size()), SQLITE_TRANSIENT);
    return *this;
}

bool Statement::step() {
    if (code_ != SQLITE_OK && code_ != SQLITE_ROW) return false;
    code_ = sqlite3_step(statement_);
    return code_ == SQLITE_ROW;
}

void Statement::reset() {
    sqlite3_reset(statement_);
    sqlite3_clear_bindings(statement_);
    code_ = SQLITE_OK;
}

Status Statement::status() const {
    if (code_ == SQLITE_OK || code_ == SQLITE_ROW || code_ == SQLITE_DONE) return {};
    return db_.error("statement failed");
}

int64_t Statement::integer(int column) const {
    return sqlite3_column_int64(statement_, column);
}
double Statement::real(int column) const {
    return sqlite3_column_double(statement_, column);
}
std::string Statement::text(int column) const {
    const auto* t = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    return t ? t : "";
}
std::vector<uint8_t> Statement::blob(int column) const {
    const auto* data = static_cast<const uint8_t*>(sqlite3_column_blob(statement_, column));
    return {data, data + (data ? sqlite3_column_bytes(statement_, column) : 0)};
}

} // namespace sahel::sqlite
