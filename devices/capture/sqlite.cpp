#include "devices/capture/sqlite.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <zlib.h>

#include <array>
#include <cassert>
#include <filesystem>
#include <iterator>
#include <set>
#include <utility>

namespace seamwright {
namespace {

constexpr int kBusyMs = 5000;
constexpr std::size_t kMostFree = 64;  // statements kept; our files need some thirty
constexpr int kMaxValueBytes =
    512 << 20;  // a mesh or an image is smaller; a forged length is refused before memory is taken

tl::unexpected<Error> sqlite_error(sqlite3* db, int code, const std::string& path, std::string_view kind) {
    switch (code & 0xff) {
        case SQLITE_NOTADB:
            return file_error(Text("this is no {}", kind), path, "choose a .seam file");
        case SQLITE_CORRUPT:
            return file_error(Text("the {} is damaged", kind), path,
                              "take the last good copy from the backup");
        case SQLITE_BUSY:
        case SQLITE_LOCKED:
            return file_error(Text("another program is writing to the {}", kind), path,
                              "close it there and try again");
        case SQLITE_READONLY:
        case SQLITE_PERM:
            return file_error(Text("the {} cannot be written", kind), path, "check its permissions");
        case SQLITE_CANTOPEN:
            return file_error(Text("the {} cannot be opened", kind), path, "check name and permissions");
        case SQLITE_FULL:
            return file_error("the disk is full", path, "make room and try again");
        case SQLITE_NOMEM:
            return file_error(Text("the {} needs more memory than there is", kind), path);
        case SQLITE_TOOBIG:
            return file_error(Text("a value is larger than a {} holds (512 MiB)", kind), path);
        default:
            return file_error(
                Text("the {} failed ({})", kind, db ? sqlite3_errmsg(db) : sqlite3_errstr(code)), path);
    }
}

// What a value is, how long, and its bytes, so that no two rows of one table are the same to it by where a
// value ends.
void row_checksum(sqlite3_context* context, int count, sqlite3_value** values) {
    uLong crc = crc32_z(0, nullptr, 0);
    const auto take = [&](const void* bytes, std::size_t size) {
        crc = crc32_z(crc, static_cast<const Bytef*>(bytes), size);
    };
    const auto little_endian = [](std::uint64_t number) {
        std::array<unsigned char, 8> bytes;
        for (unsigned char& byte : bytes) byte = static_cast<unsigned char>(number), number >>= 8;
        return bytes;
    };
    for (int i = 0; i < count; ++i) {
        const int type = sqlite3_value_type(values[i]);
        std::array<unsigned char, 8> number{};
        const void* bytes = number.data();
        std::size_t size = number.size();
        if (type == SQLITE_INTEGER) {
            number = little_endian(static_cast<std::uint64_t>(sqlite3_value_int64(values[i])));
        } else if (type != SQLITE_NULL) {  // a text, a blob, or a fraction as the text that it is written as
            bytes = type == SQLITE_BLOB ? sqlite3_value_blob(values[i]) : sqlite3_value_text(values[i]);
            size = static_cast<std::size_t>(sqlite3_value_bytes(values[i]));
            if (!bytes && size > 0) return sqlite3_result_error_nomem(context);
        }
        const auto kind = static_cast<unsigned char>(type);
        take(&kind, 1);
        take(little_endian(size).data(), 8);
        if (size > 0) take(bytes, size);
    }
    sqlite3_result_int64(context, static_cast<sqlite3_int64>(crc));
}

}  // namespace

sqlite3_stmt* FreeStatements::take(std::string_view sql) {
    const auto it = by_sql_.find(sql);
    if (it == by_sql_.end()) return nullptr;
    sqlite3_stmt* statement = it->second.release();
    by_sql_.erase(it);
    return statement;
}

void FreeStatements::put(sqlite3_stmt* statement) {
    std::unique_ptr<sqlite3_stmt, Finalize> owned(statement);
    sqlite3_reset(statement);
    sqlite3_clear_bindings(statement);
    if (by_sql_.size() < kMostFree) by_sql_.try_emplace(sqlite3_sql(statement), std::move(owned));
}

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
                              sqlite3_extended_errcode(sqlite3_db_handle(stmt_.get())), where_, kind_);
    sqlite3_reset(stmt_.get());
    return error;
}

Expected<void> Statement::run() {
    for (;;) {
        SEAM_TRY(auto row, step());
        if (!row) return {};
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

void Statement::append_netstrings(int first, std::string& out) const {
    for (int i = first, count = sqlite3_column_count(stmt_.get()); i < count; ++i) {
        const auto* bytes =
            static_cast<const char*>(sqlite3_column_type(stmt_.get(), i) == SQLITE_BLOB
                                         ? sqlite3_column_blob(stmt_.get(), i)
                                         : static_cast<const void*>(sqlite3_column_text(stmt_.get(), i)));
        const auto size = bytes ? static_cast<std::size_t>(sqlite3_column_bytes(stmt_.get(), i)) : 0;
        fmt::format_to(std::back_inserter(out), "{}:", size);
        if (size > 0) out.append(bytes, size);
        out += ',';
    }
}

Expected<void> Statement::row_ok() const {
    if (type_error_)
        return file_error(Text("a column of the {} holds a value of the wrong type", kind_), where_);
    return {};
}

Expected<Database> Database::open(const std::string& path, int flags, std::string_view kind) {
    Database db;
    db.path_ = path;
    db.kind_ = kind;
    sqlite3* raw = nullptr;
    const int code =
        sqlite3_open_v2(path.c_str(), &raw, flags | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE, nullptr);
    db.db_.reset(raw);
    if (code != SQLITE_OK) return sqlite_error(raw, code, path, kind);
    db.number_ = number_of(path);
    sqlite3_busy_timeout(raw, kBusyMs);
    sqlite3_limit(raw, SQLITE_LIMIT_LENGTH, kMaxValueBytes);
    sqlite3_limit(raw, SQLITE_LIMIT_ATTACHED, 0);
    for (const int option : {SQLITE_DBCONFIG_DEFENSIVE, SQLITE_DBCONFIG_ENABLE_FKEY})
        sqlite3_db_config(raw, option, 1, nullptr);
    for (const int option : {SQLITE_DBCONFIG_TRUSTED_SCHEMA, SQLITE_DBCONFIG_DQS_DML, SQLITE_DBCONFIG_DQS_DDL,
                             SQLITE_DBCONFIG_ENABLE_TRIGGER, SQLITE_DBCONFIG_ENABLE_VIEW})
        sqlite3_db_config(raw, option, 0, nullptr);
    const int made = sqlite3_create_function_v2(raw, "row_checksum", -1,
                                                SQLITE_UTF8 | SQLITE_DETERMINISTIC | SQLITE_DIRECTONLY,
                                                nullptr, row_checksum, nullptr, nullptr, nullptr);
    if (made != SQLITE_OK) return sqlite_error(raw, made, path, kind);
    SEAM_OK(db.execute(
        "PRAGMA cell_size_check = ON; PRAGMA mmap_size = 0; PRAGMA synchronous = FULL; PRAGMA temp_store = "
        "MEMORY"));
    return db;
}

Expected<void> Database::execute(const std::string& sql) {
    const int code = sqlite3_exec(db_.get(), sql.c_str(), nullptr, nullptr, nullptr);
    if (code != SQLITE_OK) return sqlite_error(db_.get(), code, path_, kind_);
    return {};
}

Expected<Statement> Database::prepare(std::string_view sql) {
    sqlite3_stmt* raw = free_->take(sql);
    if (!raw) {
        const int code = sqlite3_prepare_v3(db_.get(), sql.data(), static_cast<int>(sql.size()),
                                            SQLITE_PREPARE_PERSISTENT, &raw, nullptr);
        if (code != SQLITE_OK) return sqlite_error(db_.get(), code, path_, kind_);
    }
    Statement s;
    s.stmt_ = {raw, {free_}};
    s.where_ = path_;
    s.kind_ = kind_;
    return s;
}

Expected<std::int64_t> Database::integer(const std::string& sql) {
    SEAM_TRY(auto s, prepare(sql));
    SEAM_TRY(auto row, s.step());
    if (!row) return file_error(Text("a value is missing in the {}", kind_), path_);
    const std::int64_t value = s.integer(0);
    SEAM_OK(s.row_ok());
    return value;
}

Expected<void> Database::copy_to(Database& target) {
    sqlite3_backup* backup = sqlite3_backup_init(target.handle(), "main", handle(), "main");
    if (!backup)
        return sqlite_error(target.handle(), sqlite3_extended_errcode(target.handle()), target.path_, kind_);
    const int step = sqlite3_backup_step(backup, -1);
    sqlite3_backup_finish(backup);
    if (step != SQLITE_DONE) return sqlite_error(handle(), step, path_, kind_);
    return {};
}

Expected<bool> Database::write_ahead() {
    SEAM_TRY(auto s, prepare("PRAGMA journal_mode"));
    SEAM_TRY(auto row, s.step());
    return row && s.text(0) == "wal";
}

Expected<bool> Database::set_write_ahead(bool on) {
    sqlite3_busy_timeout(handle(), 0);  // whoever holds on to a log does so for hours
    const int code = sqlite3_exec(handle(), on ? "PRAGMA journal_mode = WAL" : "PRAGMA journal_mode = DELETE",
                                  nullptr, nullptr, nullptr);
    sqlite3_busy_timeout(handle(), kBusyMs);
    if (code != SQLITE_OK && (code & 0xff) != SQLITE_BUSY && (code & 0xff) != SQLITE_LOCKED)
        return sqlite_error(handle(), code, path_, kind_);
    auto is = write_ahead();
    if (!is) return is;
    return *is == on;
}

Expected<void> Database::check_length() {
    SEAM_TRY(auto pages, integer("PRAGMA page_count"));
    SEAM_TRY(auto page_bytes, integer("PRAGMA page_size"));
    std::error_code code;
    const auto bytes = std::filesystem::file_size(path_, code);
    if (code || bytes % static_cast<std::uintmax_t>(page_bytes) != 0 ||
        bytes / static_cast<std::uintmax_t>(page_bytes) < static_cast<std::uintmax_t>(pages))
        return file_error(Text("the {} is cut short", kind_), path_,
                          "take the last good copy from the backup");
    return {};
}

std::optional<Database::FileNumber> Database::number_of(const std::string& path) {
    struct stat info {};
    if (::stat(path.c_str(), &info) != 0) return std::nullopt;
    return FileNumber{info.st_dev, info.st_ino};
}

Expected<void> Database::check_place() const {
    if (!number_ || number_of(path_) == number_) return {};
    return file_error(Text("the {} was replaced or deleted while it was in use", kind_), path_,
                      "close it and open what stands there now");
}

Expected<Database::Tables> Database::tables() {
    SEAM_TRY(auto s,
             prepare("SELECT name, ifnull(sql, '') FROM sqlite_schema WHERE name NOT LIKE 'sqlite_stat%'"));
    Tables entries;
    for (;;) {
        SEAM_TRY(auto row, s.step());
        if (!row) return entries;
        entries.emplace(s.text(0), s.text(1));
        SEAM_OK(s.row_ok());
    }
}

Expected<Transaction> Transaction::begin(Database& db) {
    SEAM_OK(db.check_place());
    SEAM_OK(db.execute("BEGIN IMMEDIATE"));
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
