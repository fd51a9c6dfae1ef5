#pragma once
// SQLite behind RAII and tl::expected. Only what our files need (a project, a capture). Not thread-safe: one
// connection, one thread.

#include <sqlite3.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "core/error.h"

namespace seamwright {

// application_id of our files.
inline constexpr std::int32_t kProjectApplicationId = 0x5365616D;  // "Seam"
inline constexpr std::int32_t kCaptureApplicationId = 0x53656143;  // "SeaC"

class Database;

// Prepared statements that are free to be used again, by their SQL: to prepare one costs more than to run it.
// They outlive neither the connection nor a change of the schema (SQLite prepares them anew then).
class FreeStatements {
  public:
    sqlite3_stmt* take(std::string_view sql);  // nullptr: none
    void put(sqlite3_stmt* statement);         // reset, without bindings

  private:
    struct Finalize {
        void operator()(sqlite3_stmt* s) const { sqlite3_finalize(s); }
    };
    std::map<std::string, std::unique_ptr<sqlite3_stmt, Finalize>, std::less<>> by_sql_;
};

// A prepared statement. bind() counts from 1, column() from 0. After step() answered false (done) or an Error
// the statement is reset and can be run again with new bindings.
class Statement {
  public:
    void bind(int index, std::int64_t value);
    void bind(int index, std::string_view text);
    void bind(int index,
              std::span<const std::byte> blob);  // not copied: must live until the statement has run
    void bind_null(int index);
    Expected<bool> step();  // true: a row is there
    Expected<void> run();   // steps to the end, ignoring rows
    void reset();

    // A column of another type than asked for is an empty value plus type_error(): nothing is converted
    // silently.
    std::int64_t integer(int column);
    std::string text(int column);
    std::span<const std::byte> blob(int column);  // valid until the next step
    bool is_null(int column) const;
    // The columns from `first` on, each as a netstring "LENGTH:BYTES,": whole numbers in decimal, text and blobs as they
    // are, NULL as an empty one.
    void append_netstrings(int first, std::string& out) const;
    // Error when a column read from this row was not of the type asked for.
    Expected<void> row_ok() const;

  private:
    friend class Database;
    struct GiveBack {
        std::shared_ptr<FreeStatements> to;
        void operator()(sqlite3_stmt* s) const { to->put(s); }
    };
    bool is(int column, int type);
    std::unique_ptr<sqlite3_stmt, GiveBack> stmt_;
    std::string where_, kind_;
    bool type_error_ = false;
};

class Database {
  public:
    // `flags` as of sqlite3_open_v2. Hardened: defensive, untrusted schema, no double-quoted strings, cell
    // checks. `kind` is what the sentences of its Errors call the file. Statements may call
    // row_checksum(VALUE, ...): CRC-32 over type, length and bytes of each value in turn.
    static Expected<Database> open(const std::string& path, int flags, std::string_view kind = "file");

    Expected<void> execute(const std::string& sql);  // one or more statements without bindings
    Expected<Statement> prepare(std::string_view sql);
    Expected<std::int64_t> integer(const std::string& sql);  // one row, one column
    std::int64_t last_rowid() const { return sqlite3_last_insert_rowid(db_.get()); }
    Expected<void> copy_to(Database& target);
    // Write-ahead log (on) or rollback journal (off). What a log holds is in the file when it goes. Answers
    // whether the file is as wanted: another connection holds on to a log.
    Expected<bool> set_write_ahead(bool on);
    Expected<bool> write_ahead();
    // Error when the file is shorter than its header says: SQLite itself pads a last page that is cut. Call
    // after the first read, which rolls a killed writer's journal back, and with the rollback journal only:
    // the end of the file may still be in a log.
    Expected<void> check_length();
    // Error when the file's name leads to another file by now, or to none: moved, deleted or replaced while
    // it is open. Whatever is written then is lost with the last program that has it open; no transaction
    // begins.
    Expected<void> check_place() const;
    // Name and SQL of all tables, indices, triggers and views.
    using Tables = std::set<std::pair<std::string, std::string>>;
    Expected<Tables> tables();
    const std::string& path() const { return path_; }
    sqlite3* handle() const { return db_.get(); }

  private:
    struct Close {
        void operator()(sqlite3* db) const { sqlite3_close_v2(db); }
    };
    std::unique_ptr<sqlite3, Close> db_;
    std::shared_ptr<FreeStatements> free_ = std::make_shared<FreeStatements>();  // goes before db_
    std::string path_, kind_;
    struct FileNumber {
        std::uint64_t device, inode;
        bool operator==(const FileNumber&) const = default;
    };
    static std::optional<FileNumber> number_of(const std::string& path);
    std::optional<FileNumber> number_;  // none: in memory
};

// BEGIN IMMEDIATE; refused where the file is no longer where it was (check_place); rolled back unless
// committed.
class Transaction {
  public:
    static Expected<Transaction> begin(Database& db);
    Transaction(Transaction&& other) noexcept : db_(std::exchange(other.db_, nullptr)) {}
    Transaction& operator=(Transaction&&) = delete;
    ~Transaction();
    Expected<void> commit();

  private:
    explicit Transaction(Database& db) : db_(&db) {}
    Database* db_;
};

}  // namespace seamwright
