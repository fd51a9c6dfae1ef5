#include "projects/file/project_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <string_view>

#include "core/system_text.h"
#include "devices/exchange/files.h"
#include "projects/file/project_file_detail.h"
#include "projects/file/schema.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const fs::path& file) {
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

// Makes a rename durable.
void sync_folder(const fs::path& file) {
    if (const int fd = ::open(folder_of(file).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); fd >= 0) {
        ::fsync(fd);
        ::close(fd);
    }
}

// Replaces `path` by the finished `made`. Without `replace` an existing file wins.
Expected<void> put_in_place(const fs::path& made, const fs::path& path, bool replace) {
    const unsigned flags = replace ? 0 : RENAME_NOREPLACE;
    int failed = ::renameat2(AT_FDCWD, made.c_str(), AT_FDCWD, path.c_str(), flags);
    if (failed && (errno == EINVAL || errno == ENOSYS) && (replace || !fs::exists(path)))
        failed = std::rename(made.c_str(), path.c_str());  // a file system without RENAME_NOREPLACE
    if (failed) {
        const int code = errno;
        std::error_code ignored;
        fs::remove(made, ignored);
        if (code == EEXIST)
            return file_error("the file exists already", path.string(), "choose another name");
        return file_error(Text("the file cannot be made ({})", system_text(code)), path.string());
    }
    sync_folder(path);
    return {};
}

constexpr std::string_view kJournals[] = {"-journal", "-wal", "-shm"};

// Of a file that is gone, or goes with them.
void remove_journals(const fs::path& path) {
    std::error_code ignored;
    for (const std::string_view suffix : kJournals) fs::remove(path.string() + std::string(suffix), ignored);
}

void remove_with_journal(const fs::path& path) {
    std::error_code ignored;
    fs::remove(path, ignored);
    remove_journals(path);
}

// Whether the file's header says that it is read with a write-ahead log.
bool asks_for_log(const fs::path& path) {
    char header[20] = {};
    std::ifstream(path, std::ios::binary).read(header, sizeof header);
    return header[19] == 2;  // "read version" of SQLite's file format
}

// Unfinished files of a process that was killed. One of the last minute is let be: a folder may be another
// computer's, whose processes are not seen here.
void remove_abandoned(const fs::path& path, const std::string& what) {
    const std::string start = path.filename().string() + "." + what + "-";
    std::error_code code;
    std::vector<fs::path> abandoned;
    for (fs::directory_iterator it(folder_of(path), code), end; !code && it != end; it.increment(code)) {
        const std::string name = it->path().filename().string();
        if (!name.starts_with(start)) continue;
        pid_t maker = 0;
        const char* const last = name.data() + name.size();
        const std::string_view rest(std::from_chars(name.data() + start.size(), last, maker).ptr, last);
        if (!rest.empty() && std::ranges::find(kJournals, rest) == std::end(kJournals)) continue;
        std::error_code gone;
        const auto age = fs::file_time_type::clock::now() - it->last_write_time(gone);
        if (!gone && maker > 0 && age > std::chrono::minutes(1) && ::kill(maker, 0) != 0 && errno == ESRCH)
            abandoned.push_back(it->path());
    }
    for (const fs::path& file : abandoned) fs::remove(file, code);
}

// The name under which a file is made before it takes the place of `path`.
fs::path beside(const fs::path& path, const char* what) {
    remove_abandoned(path, what);
    const fs::path made = path.string() + fmt::format(".{}-{}", what, ::getpid());
    remove_with_journal(made);
    return made;
}

// The file that `create` would replace: must be ours or empty, and gives up its journal, which must never
// meet the file that takes its name.
Expected<void> prepare_replacing(const fs::path& path) {
    std::error_code code;
    if (!fs::is_regular_file(path, code))
        return file_error("this is no file", path.string(), "choose a .seam file");
    if (fs::file_size(path, code) == 0) return {};
    SEAM_TRY(auto old, Database::open(path.string(), SQLITE_OPEN_READWRITE, kProjectFile));
    SEAM_TRY(auto id, old.integer("PRAGMA application_id"));
    if (id != kApplicationId)
        return file_error("the file exists and is no project file", path.string(), "choose another name");
    SEAM_TRY(auto alone, old.set_write_ahead(false));
    if (!alone)
        return file_error("another program works with the file", path.string(),
                          "close it there or choose another name");
    return old.execute("BEGIN EXCLUSIVE; ROLLBACK");
}

// Gives a finished new file its name, or clears it away when the work failed.
Expected<void> finish_new(Expected<void> done, const fs::path& made, const fs::path& path, bool replace) {
    std::error_code code;
    if (done && fs::exists(path, code)) {
        if (replace) done = prepare_replacing(path);
    } else if (done) {
        remove_journals(path);  // of a file that was deleted by hand
    }
    if (!done) {
        remove_with_journal(made);
        return done;
    }
    return put_in_place(made, path, replace);
}

// Brings an older file up to date on a copy, which takes the name of the original when it has passed.
Expected<void> migrate_file(Database& original, const fs::path& name) {
    const fs::path path = behind_links(name);
    const fs::path made = beside(path, "migrating");
    // Holds off other writers; the copy is read through a second connection, which this lock lets pass.
    SEAM_OK(original.execute("BEGIN IMMEDIATE"));
    const auto work = [&]() -> Expected<void> {
        SEAM_TRY(auto source, Database::open(path.string(), SQLITE_OPEN_READONLY, kProjectFile));
        SEAM_TRY(auto copy,
                 Database::open(made.string(), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, kProjectFile));
        SEAM_OK(source.copy_to(copy));
        SEAM_OK(migrate(copy));
        return check_structure(copy, current_version());
    };
    auto done = work();
    if (done) done = put_in_place(made, path, true);
    if (!done) remove_with_journal(made);
    (void)original.execute("ROLLBACK");
    return done;
}

}  // namespace

ProjectFile::ProjectFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ProjectFile::ProjectFile(ProjectFile&&) noexcept = default;
ProjectFile& ProjectFile::operator=(ProjectFile&&) noexcept = default;
ProjectFile::~ProjectFile() {
    if (impl_) keep_write_ahead(false);  // so that the last to close leaves one file
}

void ProjectFile::keep_write_ahead(bool on) {
    const int writable = sqlite3_db_readonly(impl_->db.handle(), "main");
    if (writable == 0) (void)impl_->db.set_write_ahead(on);
}

void ProjectFile::checkpoint() {
    sqlite3_wal_checkpoint_v2(impl_->db.handle(), nullptr, SQLITE_CHECKPOINT_PASSIVE, nullptr, nullptr);
}

const fs::path& ProjectFile::path() const {
    return impl_->path;
}

Expected<ProjectFile> ProjectFile::create(const fs::path& name, const Project& project, bool replace) {
    const fs::path path = behind_links(name);
    std::error_code code;
    const bool exists = fs::exists(path, code);
    if (fs::is_directory(path, code)) return file_error("this is a folder", path.string(), "name a file");
    if (exists && !replace)
        return file_error("the file exists already", path.string(), "choose another name");
    const fs::path folder = folder_of(path);
    if (!fs::is_directory(folder, code))
        return file_error("the folder does not exist", folder.string(), "make it first");
    const fs::path made = beside(path, "new");
    const auto work = [&]() -> Expected<void> {
        SEAM_TRY(auto db,
                 Database::open(made.string(), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, kProjectFile));
        SEAM_OK(migrate(db));
        SEAM_TRY(auto transaction, Transaction::begin(db));
        SEAM_TRY(const auto made_rows, save_rows_of(db, project));
        SEAM_OK(chain_changes(db, {}, made_rows));
        return transaction.commit();
    };
    SEAM_OK(finish_new(work(), made, path, replace));
    SEAM_TRY(auto file, open(name));
    SEAM_OK(file.impl_->see_project());
    return file;
}

Expected<void> ProjectFile::copy_to(const fs::path& name) const {
    const fs::path path = behind_links(name);
    const fs::path made = beside(path, "new");
    const auto work = [&]() -> Expected<void> {
        SEAM_TRY(auto copy,
                 Database::open(made.string(), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, kProjectFile));
        SEAM_OK(impl_->db.copy_to(copy));
        auto plain = copy.set_write_ahead(false);
        return plain ? Expected<void>() : tl::unexpected(plain.error());
    };
    return finish_new(work(), made, path, true);
}

Expected<ProjectFile> ProjectFile::open(const fs::path& path, FileAccess access) {
    std::error_code code;
    if (!fs::exists(path, code)) return file_error("the file does not exist", path.string());
    if (!fs::is_regular_file(path, code))
        return file_error("this is no file", path.string(), "choose a .seam file");
    if (fs::file_size(path, code) == 0)
        return file_error("the file is empty", path.string(), "choose a .seam file");
    const bool writing = access == FileAccess::read_write;
    if (!writing && (fs::exists(path.string() + "-journal", code) || asks_for_log(path))) {
        // A killed writer left its journal or log; a read-only connection may not take it in.
        if (auto healing = Database::open(path.string(), SQLITE_OPEN_READWRITE, kProjectFile))
            if (check_identity(*healing)) (void)healing->set_write_ahead(false);
    }
    for (int round = 0;; ++round) {
        SEAM_TRY(auto db,
                 Database::open(path.string(), writing ? SQLITE_OPEN_READWRITE : SQLITE_OPEN_READONLY,
                                kProjectFile));
        SEAM_TRY(auto version, check_identity(db));
        auto write_ahead = db.write_ahead();
        if (write_ahead && *write_ahead && writing) {
            SEAM_TRY(auto ended, db.set_write_ahead(false));
            write_ahead = !ended;
        }
        if (!write_ahead) return tl::unexpected(write_ahead.error());
        if (!*write_ahead)  // else whoever keeps the log has found the file whole
            SEAM_OK(db.check_length());
        SEAM_OK(check_structure(db, version));
        if (version < current_version()) {
            if (!writing) {
                auto memory =
                    Database::open(":memory:", SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, kProjectFile);
                if (!memory) return tl::unexpected(memory.error());
                SEAM_OK(db.copy_to(*memory));
                SEAM_OK(migrate(*memory));
                return ProjectFile(std::make_unique<Impl>(path, std::move(*memory)));
            }
            SEAM_OK(migrate_file(db, path));
            if (round == 0) continue;
            return file_error("the project file could not be brought up to date", path.string());
        }
        // A backstop: checkpoint() comes long before.
        SEAM_OK(db.execute("PRAGMA wal_autocheckpoint = 16384"));
        auto impl = std::make_unique<Impl>(path, std::move(db));
        if (writing) {
            SEAM_TRY(impl->trouble, chain_trouble(impl->db));
        }
        return ProjectFile(std::move(impl));
    }
}

Expected<Project> ProjectFile::load() const {
    // One read transaction: another process's save is seen whole or not at all.
    SEAM_OK(impl_->db.execute("BEGIN"));
    auto project = load_rows_of(impl_->db);
    const auto saw = project && !impl_->seen ? impl_->see_project() : Expected<void>();
    (void)impl_->db.execute("ROLLBACK");
    if (!saw) return tl::unexpected(saw.error());
    return project;
}

Expected<void> ProjectFile::save(const Project& project) {
    SEAM_TRY(auto transaction, Transaction::begin(impl_->db));
    SEAM_TRY(const auto theirs, rows_of_others(project));
    SEAM_TRY(const auto changes, save_rows_of(impl_->db, project, theirs));
    for (const RowChange& change : changes)
        SEAM_OK(may(change.table == "drift_watch" ? Deed::override
                    : change.table == "regions" || change.table == "requirements" || change.table == "elastic"
                        ? Deed::limits
                        : Deed::teach));
    SEAM_OK(chain_changes(impl_->db, impl_->name(), changes));
    SEAM_OK(transaction.commit());
    SEAM_OK(see_saved(changes));
    checkpoint();
    return {};
}

}  // namespace seamwright
