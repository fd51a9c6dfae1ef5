#include "projects/sqlite.h"

#include <fmt/format.h>

#include <cassert>
#include <utility>

namespace seamwright {
namespace {

constexpr int kBusyMs = 5000;
constexpr int kMaxValueBytes =
    512 << 20;  // a mesh or an image is smaller; a forged length is refused before memory is taken

tl::unexpected<Error> sqlite_error(sqlite3* db, int code, const std::string& path) {
    switch (code & 0xff) {
        case SQLITE_NOTADB:
            return file_error("this is no project file", path, "choose a .seam file");
        case SQLITE_CORRUPT:
            return file_error("the project file is damaged", path, "take the last good copy from the backup");
        case SQLITE_BUSY:
        case SQLITE_LOCKED:
            return file_error("another program is writing to the project file", path,
                              "close it there and try again");
        case SQLITE_READONLY:
        case SQLITE_PERM:
            return file_error("the project file cannot be written", path, "check its permissions");
        case SQLITE_CANTOPEN:
            return file_error("the project file cannot be opened", path, "check name and permissions");
        case SQLITE_FULL:
            return file_error("the disk is full", path, "make room and try again");
        case SQLITE_NOMEM:
            return file_error("the project file needs more memory than there is", path);
        case SQLITE_TOOBIG:
            return file_error("a value is larger than a project file holds (512 MiB)", path);
        default:
            return file_error(
                fmt::format("the project file failed ({})", db ? sqlite3_errmsg(db) : sqlite3_errstr(code)),
                path);
    }
}

}  // namespace

void Statement::bind(int index, std::int64_t value) {
    sqlite3_bind_int64(stmt_.get(), index, value);
}
void Statement::bind(int index, std::string_view text) {
    sqlite3_bind_text64(stmt_.get(), index, text.data() ? text.data() : "", text.size(), SQLITE_TRANSIENT,
                        SQLITE_UTF8);
}
void Statement::bind(int index, std::span<const std::byte> blob) {
    if (blob.empty())
        sqlite3_bind_zeroblob(stmt_.get(), index, 0);
    else
        sqlite3_bind_blob64(stmt_.get(), index, blob.data(), blob.size(), SQLITE_STATIC);
}
void Statement::bind_null(int index) {
    sqlite3_bind_null(stmt_.get(), index);
}

Expected<bool> Statement::step() {
    type_error_ = false;
    const int code = sqlite3_step(stmt_.get());
    if (code == SQLITE_ROW) return true;
    if (code == SQLITE_DONE) {
        sqlite3_reset(stmt_.get());
        return false;
    }
    auto error = sqlite_error(sqlite3_db_handle(stmt_.get()),
                              sqlite3_extended_errcode(sqlite3_db_handle(stmt_.get())), where_);
    sqlite3_reset(stmt_.get());
    return error;
}

Expected<void> Statement::run() {
    for (;;) {
        auto row = step();
        if (!row) return tl::unexpected(row.error());
        if (!*row) return {};
    }
}

void Statement::reset() {
    sqlite3_reset(stmt_.get());
}

bool Statement::is(int column, int type) {
    if (sqlite3_column_type(stmt_.get(), column) == type) return true;
    type_error_ = true;
    return false;
}

std::int64_t Statement::integer(int column) {
    return is(column, SQLITE_INTEGER) ? sqlite3_column_int64(stmt_.get(), column) : 0;
}

std::string Statement::text(int column) {
    if (!is(column, SQLITE_TEXT)) return {};
    const auto* p = reinterpret_cast<const char*>(sqlite3_column_text(stmt_.get(), column));
    return p ? std::string(p, static_cast<std::size_t>(sqlite3_column_bytes(stmt_.get(), column)))
             : std::string();
}

std::span<const std::byte> Statement::blob(int column) {
    if (!is(column, SQLITE_BLOB)) return {};
    const auto* p = static_cast<const std::byte*>(sqlite3_column_blob(stmt_.get(), column));
    return p ? std::span(p, static_cast<std::size_t>(sqlite3_column_bytes(stmt_.get(), column)))
             : std::span<const std::byte>();
}

bool Statement::is_null(int column) const {
    return sqlite3_column_type(stmt_.get(), column) == SQLITE_NULL;
}

Expected<void> Statement::row_ok() const {
    if (type_error_)
        return file_error("a column of the project file holds a value of the wrong type", where_);
    return {};
}

Expected<Database> Database::open(const std::string& path, int flags) {
    Database db;
    db.path_ = path;
    sqlite3* raw = nullptr;
    const int code =
        sqlite3_open_v2(path.c_str(), &raw, flags | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE, nullptr);
    db.db_.reset(raw);
    if (code != SQLITE_OK) return sqlite_error(raw, code, path);
    sqlite3_busy_timeout(raw, kBusyMs);
    sqlite3_limit(raw, SQLITE_LIMIT_LENGTH, kMaxValueBytes);
    sqlite3_limit(raw, SQLITE_LIMIT_ATTACHED, 0);
    for (const int option : {SQLITE_DBCONFIG_DEFENSIVE, SQLITE_DBCONFIG_ENABLE_FKEY})
        sqlite3_db_config(raw, option, 1, nullptr);
    for (const int option : {SQLITE_DBCONFIG_TRUSTED_SCHEMA, SQLITE_DBCONFIG_DQS_DML, SQLITE_DBCONFIG_DQS_DDL,
                             SQLITE_DBCONFIG_ENABLE_TRIGGER, SQLITE_DBCONFIG_ENABLE_VIEW})
        sqlite3_db_config(raw, option, 0, nullptr);
    auto set = db.execute(
        "PRAGMA cell_size_check = ON; PRAGMA mmap_size = 0; PRAGMA synchronous = FULL; PRAGMA temp_store = "
        "MEMORY");
    if (!set) return tl::unexpected(set.error());
    return db;
}

Expected<void> Database::execute(const std::string& sql) {
    const int code = sqlite3_exec(db_.get(), sql.c_str(), nullptr, nullptr, nullptr);
    if (code != SQLITE_OK) return sqlite_error(db_.get(), code, path_);
    return {};
}

Expected<Statement> Database::prepare(std::string_view sql) {
    Statement s;
    sqlite3_stmt* raw = nullptr;
    const int code = sqlite3_prepare_v2(db_.get(), sql.data(), static_cast<int>(sql.size()), &raw, nullptr);
    s.stmt_.reset(raw);
    s.where_ = path_;
    if (code != SQLITE_OK) return sqlite_error(db_.get(), code, path_);
    return s;
}

Expected<std::int64_t> Database::integer(const std::string& sql) {
    auto s = prepare(sql);
    if (!s) return tl::unexpected(s.error());
    auto row = s->step();
    if (!row) return tl::unexpected(row.error());
    if (!*row) return file_error("a value is missing in the project file", path_);
    const std::int64_t value = s->integer(0);
    if (auto ok = s->row_ok(); !ok) return tl::unexpected(ok.error());
    return value;
}

Expected<void> Database::copy_to(Database& target) {
    sqlite3_backup* backup = sqlite3_backup_init(target.handle(), "main", handle(), "main");
    if (!backup)
        return sqlite_error(target.handle(), sqlite3_extended_errcode(target.handle()), target.path_);
    const int step = sqlite3_backup_step(backup, -1);
    sqlite3_backup_finish(backup);
    if (step != SQLITE_DONE) return sqlite_error(handle(), step, path_);
    return {};
}

Expected<Transaction> Transaction::begin(Database& db) {
    auto begun = db.execute("BEGIN IMMEDIATE");
    if (!begun) return tl::unexpected(begun.error());
    return Transaction(db);
}

Transaction::~Transaction() {
    if (db_) sqlite3_exec(db_->handle(), "ROLLBACK", nullptr, nullptr, nullptr);
}

Expected<void> Transaction::commit() {
    assert(db_);
    auto done = db_->execute("COMMIT");
    if (!done) return done;  // the destructor rolls back
    db_ = nullptr;
    return {};
}

}  // namespace seamwright
