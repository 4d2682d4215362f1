#pragma once

#include "world/result.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

/// A thin, checked layer over SQLite: one connection, prepared statements, errors with the database's name.
namespace sahel::sqlite {

class Database {
  public:
    enum class Mode { read, write, create };
    /// Errors: not_found, io, corrupt (not a database). A folder that cannot be written is opened as immutable.
    static Result<Database> open(const std::filesystem::path& path, Mode mode);
    Database(Database&& o) noexcept;
    Database& operator=(Database&& o) noexcept;
    ~Database();

    /// Runs statements that give no rows.
    Status run(const char* sql);
    [[nodiscard]] Error error(std::string_view what) const;
    [[nodiscard]] sqlite3* handle() const { return db_; }

  private:
    Database(sqlite3* db, std::string name) : db_(db), name_(std::move(name)) {}
    sqlite3* db_ = nullptr;
    std::string name_;
};

/// `Statement s(db, "SELECT ... WHERE x = ?"); s.bind(1, x); while (s.step()) ...; s.status()`.
class Statement {
  public:
    Statement(const Database& db, const char* sql);
    ~Statement();
    Statement(const Statement&) = delete;
    Statement& operator=(const Statement&) = delete;

    Statement& bind(int index, int64_t value);
    Statement& bind(int index, double value);
    Statement& bind(int index, std::string_view text);
    Statement& bind(int index, std::span<const uint8_t> blob);
    /// True while there is a row. Afterwards status() tells the end from an error.
    bool step();
    void reset();
    [[nodiscard]] Status status() const;

    [[nodiscard]] int64_t integer(int column) const;
    [[nodiscard]] double real(int column) const;
    [[nodiscard]] std::string text(int column) const;
    [[nodiscard]] std::vector<uint8_t> blob(int column) const;

  private:
    const Database& db_;
    sqlite3_stmt* statement_ = nullptr;
    int code_;
};

} // namespace sahel::sqlite
