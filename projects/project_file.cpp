#include "projects/project_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <set>

#include "projects/profile_blob.h"
#include "projects/project_json.h"
#include "projects/schema.h"
#include "projects/sqlite.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;

constexpr ArchiveOptions kRow{.profiles = false, .rigid_poses = true};  // profiles have columns of their own
constexpr ArchiveOptions kSetup{.profiles = true, .rigid_poses = true};
constexpr ArchiveOptions kResult{.profiles = true, .rigid_poses = false};

Error at_file(Error error, const std::string& path) {
    error.kind = ErrorKind::file;
    error.where = error.where.empty() ? path : path + ": " + error.where;
    return error;
}

std::uint32_t crc_of(std::string_view text) {
    return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(text.data()), text.size()));
}
std::uint32_t crc_of(std::span<const std::byte> bytes) {
    return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

// Makes a rename durable.
void sync_folder(const fs::path& file) {
    const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
    if (const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); fd >= 0) {
        ::fsync(fd);
        ::close(fd);
    }
}

// Text of a value that must be readable again; the Error is the caller's input.
template <class T>
Expected<std::string> row_text(const T& value, const std::string& where, const ArchiveOptions& options) {
    const nlohmann::json document = to_json_document(value, options);
    auto text = dump_document(document, where);
    if (!text) return text;
    if (auto again = from_json_document<T>(document, where, options); !again)
        return tl::unexpected(again.error());
    return text;
}

template <class T>
Expected<T> row_value(const std::string& text, const std::string& where, const std::string& path,
                      const ArchiveOptions& options) {
    nlohmann::json document;
    try {
        document = nlohmann::json::parse(text);
    } catch (const nlohmann::json::exception&) {
        return file_error("an entry of the project file cannot be read", path + ": " + where);
    }
    auto value = from_json_document<T>(document, where, options);
    if (!value) return tl::unexpected(at_file(value.error(), path));
    return value;
}

Expected<void> unique_ids(const std::vector<std::string>& ids, const char* kind) {
    std::set<std::string> seen;
    for (const std::string& id : ids) {
        if (id.empty()) return input_error(fmt::format("a {} has no id", kind), {}, "give every one a name");
        if (!seen.insert(id).second)
            return input_error(fmt::format("two {}s are called \"{}\"", kind, id), {}, "rename one");
    }
    return {};
}

template <class T>
std::vector<std::string> ids_of(const std::vector<T>& items) {
    std::vector<std::string> ids;
    for (const T& item : items) ids.push_back(item.id);
    return ids;
}

// Rows that are not in `ids` go.
Expected<void> delete_others(Database& db, const char* table, const std::vector<std::string>& ids) {
    auto list = db.prepare(fmt::format("SELECT id FROM {}", table));
    if (!list) return tl::unexpected(list.error());
    const std::set<std::string> keep(ids.begin(), ids.end());
    std::vector<std::string> gone;
    for (;;) {
        auto row = list->step();
        if (!row) return tl::unexpected(row.error());
        if (!*row) break;
        if (std::string id = list->text(0); !keep.count(id)) gone.push_back(std::move(id));
    }
    auto remove = db.prepare(fmt::format("DELETE FROM {} WHERE id = ?", table));
    if (!remove) return tl::unexpected(remove.error());
    for (const std::string& id : gone) {
        remove->bind(1, id);
        if (auto done = remove->run(); !done) return done;
    }
    return {};
}

// Writes each row that differs from what is stored: `columns` after id and position.
template <class T, class Bind>
Expected<void> save_rows(Database& db, const char* table, const std::vector<std::string>& columns,
                         const std::vector<T>& items, Bind bind) {
    if (auto done = delete_others(db, table, ids_of(items)); !done) return done;
    std::string names = "id, position", marks = "?, ?", sets = "position = excluded.position",
                differs = "position IS NOT excluded.position";
    for (const std::string& c : columns) {
        names += ", " + c;
        marks += ", ?";
        sets += fmt::format(", {0} = excluded.{0}", c);
        differs += fmt::format(" OR {0} IS NOT excluded.{0}", c);
    }
    auto s = db.prepare(
        fmt::format("INSERT INTO {0} ({1}) VALUES ({2}) ON CONFLICT (id) DO UPDATE SET {3} WHERE {4}", table,
                    names, marks, sets, differs));
    if (!s) return tl::unexpected(s.error());
    std::int64_t position = 0;
    for (const T& item : items) {
        s->bind(1, item.id);
        s->bind(2, position++);
        if (auto done = bind(*s, item); !done) return done;
    }
    return {};
}

Expected<void> save_all(Database& db, const Project& project) {
    for (const auto& unique :
         {unique_ids(ids_of(project.sensors), "sensor"), unique_ids(ids_of(project.robots), "robot"),
          unique_ids(ids_of(project.calibrations), "calibration"), unique_ids(ids_of(project.spots), "spot"),
          unique_ids(ids_of(project.regions), "region")})
        if (!unique) return unique;

    auto name = db.prepare(
        "INSERT INTO project (id, name, created_utc) VALUES (1, ?, ?) "
        "ON CONFLICT (id) DO UPDATE SET name = excluded.name WHERE name IS NOT excluded.name");
    if (!name) return tl::unexpected(name.error());
    if (auto text = dump_document(project.name, "project name"); !text) return tl::unexpected(text.error());
    name->bind(1, project.name);
    name->bind(2, utc_now());
    if (auto done = name->run(); !done) return done;

    auto part = db.prepare(
        "INSERT INTO part (id, body, mesh) VALUES (1, ?, ?) ON CONFLICT (id) DO UPDATE SET body = "
        "excluded.body, "
        "mesh = excluded.mesh WHERE body IS NOT excluded.body OR mesh IS NOT excluded.mesh");
    if (!part) return tl::unexpected(part.error());
    auto part_text = row_text(project.part, "part", kRow);
    if (!part_text) return tl::unexpected(part_text.error());
    part->bind(1, *part_text);
    part->bind(2, std::span<const std::byte>(project.part.mesh_ply));
    if (auto done = part->run(); !done) return done;

    const auto device = [](const char* kind) {
        return [kind](Statement& s, const auto& item) -> Expected<void> {
            auto text = row_text(item, fmt::format("{} {}", kind, item.id), kRow);
            if (!text) return tl::unexpected(text.error());
            s.bind(3, item.driver);
            s.bind(4, *text);
            return s.run();
        };
    };
    if (auto done = save_rows(db, "sensors", {"driver", "body"}, project.sensors, device("sensor")); !done)
        return done;
    if (auto done = save_rows(db, "robots", {"driver", "body"}, project.robots, device("robot")); !done)
        return done;
    auto calibrations =
        save_rows(db, "calibrations", {"sensor_id", "robot_id", "created_utc", "verdict", "body"},
                  project.calibrations, [](Statement& s, const Calibration& c) -> Expected<void> {
                      auto text = row_text(c, "calibration " + c.id, kRow);
                      if (!text) return tl::unexpected(text.error());
                      s.bind(3, c.sensor_id);
                      s.bind(4, c.robot_id);
                      s.bind(5, c.created_utc);
                      s.bind(6, c.verdict);
                      s.bind(7, *text);
                      return s.run();
                  });
    if (!calibrations) return calibrations;
    auto spots =
        save_rows(db, "spots", {"sensor_id", "robot_id", "body", "reference_profile", "template_profile"},
                  project.spots, [](Statement& s, const Spot& spot) -> Expected<void> {
                      auto text = row_text(spot, "spot " + spot.id, kRow);
                      if (!text) return tl::unexpected(text.error());
                      auto reference = pack_profile(spot.reference_profile);
                      auto model = pack_profile(spot.feature.template_profile);
                      for (const auto* blob : {&reference, &model})
                          if (!*blob) {
                              Error error = blob->error();
                              error.where = "spot " + spot.id;
                              return tl::unexpected(error);
                          }
                      s.bind(3, spot.sensor_id);
                      s.bind(4, spot.robot_id);
                      s.bind(5, *text);
                      s.bind(6, std::span<const std::byte>(*reference));
                      s.bind(7, std::span<const std::byte>(*model));
                      return s.run();
                  });
    if (!spots) return spots;
    return save_rows(db, "regions", {"frame_name", "body"}, project.regions,
                     [](Statement& s, const Region& region) -> Expected<void> {
                         auto text = row_text(region, "region " + region.id, kRow);
                         if (!text) return tl::unexpected(text.error());
                         s.bind(3, region.frame_name);
                         s.bind(4, *text);
                         return s.run();
                     });
}

// Calls `read` for each row; stops at its first Error.
template <class Read>
Expected<void> for_each_row(Statement& s, Read read) {
    for (;;) {
        auto row = s.step();
        if (!row) return tl::unexpected(row.error());
        if (!*row) return {};
        Expected<void> done = read(s);
        if (done) done = s.row_ok();
        if (!done) {
            s.reset();
            return done;
        }
    }
}

template <class T>
Expected<void> load_rows(Database& db, const char* sql, const char* kind, std::vector<T>& items) {
    auto s = db.prepare(sql);  // id, body[, reference_profile, template_profile]
    if (!s) return tl::unexpected(s.error());
    return for_each_row(*s, [&](Statement& row) -> Expected<void> {
        const std::string id = row.text(0), where = fmt::format("{} {}", kind, id);
        auto value = row_value<T>(row.text(1), where, db.path(), kRow);
        if (!value) return tl::unexpected(value.error());
        if (value->id != id)
            return file_error("an entry stands under another's id", db.path() + ": " + where);
        if constexpr (std::is_same_v<T, Spot>) {
            auto reference = unpack_profile(row.blob(2), db.path() + ": " + where);
            if (!reference) return tl::unexpected(reference.error());
            auto model = unpack_profile(row.blob(3), db.path() + ": " + where);
            if (!model) return tl::unexpected(model.error());
            value->reference_profile = std::move(*reference);
            value->feature.template_profile = std::move(*model);
        }
        items.push_back(std::move(*value));
        return {};
    });
}

Expected<std::int64_t> setup_id(Database& db, const Project& setup) {
    Project slim = setup;
    slim.part.mesh_ply.clear();
    for (Calibration& c : slim.calibrations) {
        c.raw = nlohmann::json::object();
        c.result = nlohmann::json::object();
    }
    auto text = row_text(slim, "setup of the run", kSetup);
    if (!text) return tl::unexpected(text.error());
    const std::int64_t crc = crc_of(*text);
    auto find = db.prepare("SELECT id FROM setups WHERE crc = ? AND body = ?");
    if (!find) return tl::unexpected(find.error());
    find->bind(1, crc);
    find->bind(2, *text);
    auto row = find->step();
    if (!row) return tl::unexpected(row.error());
    if (*row) {
        const std::int64_t id = find->integer(0);
        find->reset();
        return id;
    }
    auto insert = db.prepare("INSERT INTO setups (crc, body) VALUES (?, ?)");
    if (!insert) return tl::unexpected(insert.error());
    insert->bind(1, crc);
    insert->bind(2, *text);
    if (auto done = insert->run(); !done) return tl::unexpected(done.error());
    return db.last_rowid();
}

Expected<void> insert_event(Database& db, const EventRecord& event, std::int64_t run) {
    for (const std::string* text : {&event.utc, &event.subject, &event.text})
        if (auto utf8 = dump_document(*text, "event"); !utf8) return tl::unexpected(utf8.error());
    auto s = db.prepare("INSERT INTO events (utc, run, kind, subject, text) VALUES (?, ?, ?, ?, ?)");
    if (!s) return tl::unexpected(s.error());
    s->bind(1, event.utc.empty() ? utc_now() : event.utc);
    s->bind(2, run);
    s->bind(3, to_string(event.kind));
    s->bind(4, event.subject);
    s->bind(5, event.text);
    return s->run();
}

Expected<void> insert_regions(Database& db, const RunRecord& run, std::int64_t number) {
    auto s = db.prepare(
        "INSERT INTO run_regions (run, position, region_id, gate_passed, body) VALUES (?, ?, ?, ?, ?)");
    if (!s) return tl::unexpected(s.error());
    for (std::size_t i = 0; i < run.regions.size(); ++i) {
        const RegionRecord& region = run.regions[i];
        auto text = row_text(region, "region " + region.region_id, kResult);
        if (!text) return tl::unexpected(text.error());
        s->bind(1, number);
        s->bind(2, static_cast<std::int64_t>(i));
        s->bind(3, region.region_id);
        s->bind(4, std::int64_t{region.gate_passed});
        s->bind(5, *text);
        if (auto done = s->run(); !done) return done;
    }
    return {};
}

Expected<void> insert_captures(Database& db, const RunRecord& run, std::int64_t number) {
    auto blobs = pack_captures(run.captures);
    if (!blobs) return tl::unexpected(blobs.error());
    auto s = db.prepare("INSERT INTO captures (run, chunk, captures, data) VALUES (?, ?, ?, ?)");
    if (!s) return tl::unexpected(s.error());
    for (std::size_t i = 0; i < blobs->size(); ++i) {
        s->bind(1, number);
        s->bind(2, static_cast<std::int64_t>(i));
        s->bind(3, std::int64_t{(*blobs)[i].captures});
        s->bind(4, std::span<const std::byte>((*blobs)[i].bytes));
        if (auto done = s->run(); !done) return done;
    }
    auto image = db.prepare(
        "INSERT INTO images (run, capture, width, height, bit_depth, crc, data) VALUES (?, ?, ?, ?, ?, ?, "
        "?)");
    if (!image) return tl::unexpected(image.error());
    for (std::size_t i = 0; i < run.captures.size(); ++i) {
        if (!run.captures[i].image) continue;
        const StoredImage& stored = *run.captures[i].image;
        const StripeImage view = stored.view();
        if (view.empty() || stored.pixels.size() != view.row_bytes * static_cast<std::size_t>(view.height))
            return input_error("the image's pixels do not fill its size",
                               "capture of spot " + run.captures[i].spot_id);
        image->bind(1, number);
        image->bind(2, static_cast<std::int64_t>(i));
        image->bind(3, std::int64_t{stored.width});
        image->bind(4, std::int64_t{stored.height});
        image->bind(5, std::int64_t{stored.bit_depth});
        image->bind(6, std::int64_t{crc_of(std::span<const std::byte>(stored.pixels))});
        image->bind(7, std::span<const std::byte>(stored.pixels));
        if (auto done = image->run(); !done) return done;
    }
    return {};
}

Expected<void> load_captures(Database& db, RunRecord& run) {
    const std::string where = fmt::format("{}: run {}", db.path(), run.number);
    auto s = db.prepare("SELECT captures, data FROM captures WHERE run = ? ORDER BY chunk");
    if (!s) return tl::unexpected(s.error());
    s->bind(1, run.number);
    auto read = for_each_row(*s, [&](Statement& row) -> Expected<void> {
        const std::size_t before = run.captures.size();
        if (auto done = unpack_captures(row.blob(1), where, run.captures); !done) return done;
        if (static_cast<std::int64_t>(run.captures.size() - before) != row.integer(0))
            return file_error("a block holds another number of profiles than it says", where);
        return {};
    });
    if (!read) return read;
    auto image = db.prepare("SELECT capture, width, height, bit_depth, crc, data FROM images WHERE run = ?");
    if (!image) return tl::unexpected(image.error());
    image->bind(1, run.number);
    return for_each_row(*image, [&](Statement& row) -> Expected<void> {
        const std::int64_t capture = row.integer(0), width = row.integer(1), height = row.integer(2),
                           depth = row.integer(3);
        const auto data = row.blob(5);
        if (capture < 0 || capture >= static_cast<std::int64_t>(run.captures.size()) || width < 1 ||
            height < 1 || width > 65536 || height > 65536 ||
            (depth != 8 && depth != 10 && depth != 12 && depth != 16) ||
            data.size() != static_cast<std::size_t>(width * height * (depth > 8 ? 2 : 1)))
            return file_error("an image does not fit its description", where);
        if (crc_of(data) != row.integer(4))
            return file_error("the checksum of an image is wrong: the file is damaged", where);
        run.captures[static_cast<std::size_t>(capture)].image =
            StoredImage{static_cast<int>(width), static_cast<int>(height), static_cast<int>(depth),
                        std::vector<std::byte>(data.begin(), data.end())};
        return {};
    });
}

template <class T>
Expected<void> load_results(Database& db, const char* sql, std::int64_t number, std::vector<T>& items) {
    auto s = db.prepare(sql);
    if (!s) return tl::unexpected(s.error());
    s->bind(1, number);
    return for_each_row(*s, [&](Statement& row) -> Expected<void> {
        auto value =
            row_value<T>(row.text(1), fmt::format("run {}: {}", number, row.text(0)), db.path(), kResult);
        if (!value) return tl::unexpected(value.error());
        items.push_back(std::move(*value));
        return {};
    });
}

// SQLite pads a last page that is cut; the header says how long the file must be. Call after the first read,
// which rolls a killed writer's journal back.
Expected<void> check_size(Database& db, const fs::path& path) {
    auto pages = db.integer("PRAGMA page_count");
    if (!pages) return tl::unexpected(pages.error());
    auto page_bytes = db.integer("PRAGMA page_size");
    if (!page_bytes) return tl::unexpected(page_bytes.error());
    std::error_code code;
    const auto bytes = fs::file_size(path, code);
    if (code || bytes % static_cast<std::uintmax_t>(*page_bytes) != 0 ||
        bytes / static_cast<std::uintmax_t>(*page_bytes) < static_cast<std::uintmax_t>(*pages))
        return file_error("the project file is cut short", path.string(),
                          "take the last good copy from the backup");
    return {};
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
        return file_error(fmt::format("the file cannot be made ({})", std::strerror(code)), path.string());
    }
    sync_folder(path);
    return {};
}

fs::path beside(const fs::path& path, const char* what) {
    return fs::path(path.string() + fmt::format(".{}-{}", what, ::getpid()));
}

void remove_with_journal(const fs::path& path) {
    std::error_code ignored;
    fs::remove(path, ignored);
    fs::remove(path.string() + "-journal", ignored);
}

// The file that `create` would replace: must be ours or empty, and gives up its journal, which must never
// meet the file that takes its name.
Expected<void> prepare_replacing(const fs::path& path) {
    std::error_code code;
    if (fs::is_regular_file(path, code) && fs::file_size(path, code) == 0) return {};
    auto old = Database::open(path.string(), SQLITE_OPEN_READWRITE);
    if (!old) return tl::unexpected(old.error());
    auto id = old->integer("PRAGMA application_id");
    if (!id) return tl::unexpected(id.error());
    if (*id != kApplicationId)
        return file_error("the file exists and is no project file", path.string(), "choose another name");
    return old->execute("BEGIN EXCLUSIVE; ROLLBACK");
}

// Brings an older file up to date on a copy, which takes the name of the original when it has passed.
Expected<void> migrate_file(Database& original, const fs::path& path) {
    const fs::path made = beside(path, "migrating");
    remove_with_journal(made);
    // Holds off other writers; the copy is read through a second connection, which this lock lets pass.
    if (auto locked = original.execute("BEGIN IMMEDIATE"); !locked) return locked;
    const auto work = [&]() -> Expected<void> {
        auto source = Database::open(path.string(), SQLITE_OPEN_READONLY);
        if (!source) return tl::unexpected(source.error());
        auto copy = Database::open(made.string(), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
        if (!copy) return tl::unexpected(copy.error());
        if (auto done = source->copy_to(*copy); !done) return done;
        if (auto done = migrate(*copy); !done) return done;
        return check_structure(*copy, current_version());
    };
    auto done = work();
    if (done) done = put_in_place(made, path, true);
    if (!done) remove_with_journal(made);
    (void)original.execute("ROLLBACK");
    return done;
}

}  // namespace

struct ProjectFile::Impl {
    fs::path path;
    mutable Database db;
    Impl(fs::path p, Database d) : path(std::move(p)), db(std::move(d)) {}
};

ProjectFile::ProjectFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ProjectFile::ProjectFile(ProjectFile&&) noexcept = default;
ProjectFile& ProjectFile::operator=(ProjectFile&&) noexcept = default;
ProjectFile::~ProjectFile() = default;
const fs::path& ProjectFile::path() const {
    return impl_->path;
}

Expected<ProjectFile> ProjectFile::create(const fs::path& path, const Project& project, bool replace) {
    std::error_code code;
    const bool exists = fs::exists(path, code);
    if (fs::is_directory(path, code)) return file_error("this is a folder", path.string(), "name a file");
    if (exists && !replace)
        return file_error("the file exists already", path.string(), "choose another name");
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    if (!fs::is_directory(folder, code))
        return file_error("the folder does not exist", folder.string(), "make it first");
    const fs::path made = beside(path, "new");
    remove_with_journal(made);
    const auto work = [&]() -> Expected<void> {
        auto db = Database::open(made.string(), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
        if (!db) return tl::unexpected(db.error());
        if (auto done = migrate(*db); !done) return done;
        auto transaction = Transaction::begin(*db);
        if (!transaction) return tl::unexpected(transaction.error());
        if (auto done = save_all(*db, project); !done) return done;
        return transaction->commit();
    };
    auto done = work();
    if (done && exists) done = prepare_replacing(path);
    if (done && !exists) fs::remove(path.string() + "-journal", code);  // of a file that was deleted by hand
    if (!done) {
        remove_with_journal(made);
        return tl::unexpected(done.error());
    }
    if (auto placed = put_in_place(made, path, replace); !placed) return tl::unexpected(placed.error());
    return open(path);
}

Expected<ProjectFile> ProjectFile::open(const fs::path& path, FileAccess access) {
    std::error_code code;
    if (!fs::exists(path, code)) return file_error("the file does not exist", path.string());
    if (!fs::is_regular_file(path, code))
        return file_error("this is no file", path.string(), "choose a .seam file");
    if (fs::file_size(path, code) == 0)
        return file_error("the file is empty", path.string(), "choose a .seam file");
    const bool writing = access == FileAccess::read_write;
    if (!writing && fs::exists(path.string() + "-journal", code)) {
        // A killed writer left its journal; a read-only connection may not roll it back.
        if (auto healing = Database::open(path.string(), SQLITE_OPEN_READWRITE))
            (void)healing->integer("PRAGMA user_version");
    }
    for (int round = 0;; ++round) {
        auto db = Database::open(path.string(), writing ? SQLITE_OPEN_READWRITE : SQLITE_OPEN_READONLY);
        if (!db) return tl::unexpected(db.error());
        auto version = check_identity(*db);
        if (!version) return tl::unexpected(version.error());
        if (auto whole = check_size(*db, path); !whole) return tl::unexpected(whole.error());
        if (auto sound = check_structure(*db, *version); !sound) return tl::unexpected(sound.error());
        if (*version < current_version()) {
            if (!writing) {
                auto memory = Database::open(":memory:", SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
                if (!memory) return tl::unexpected(memory.error());
                if (auto done = db->copy_to(*memory); !done) return tl::unexpected(done.error());
                if (auto done = migrate(*memory); !done) return tl::unexpected(done.error());
                return ProjectFile(std::make_unique<Impl>(path, std::move(*memory)));
            }
            if (auto done = migrate_file(*db, path); !done) return tl::unexpected(done.error());
            if (round == 0) continue;
            return file_error("the project file could not be brought up to date", path.string());
        }
        if (writing)
            if (auto mode = db->execute("PRAGMA journal_mode = DELETE"); !mode)
                return tl::unexpected(mode.error());
        return ProjectFile(std::make_unique<Impl>(path, std::move(*db)));
    }
}

Expected<Project> ProjectFile::load() const {
    Database& db = impl_->db;
    // One read transaction: another process's save is seen whole or not at all.
    if (auto begun = db.execute("BEGIN"); !begun) return tl::unexpected(begun.error());
    const auto read = [&]() -> Expected<Project> {
        Project project;
        auto name = db.prepare("SELECT name FROM project");
        if (!name) return tl::unexpected(name.error());
        auto named = for_each_row(*name, [&](Statement& row) -> Expected<void> {
            project.name = row.text(0);
            return {};
        });
        if (!named) return tl::unexpected(named.error());
        auto part = db.prepare("SELECT body, mesh FROM part");
        if (!part) return tl::unexpected(part.error());
        auto parted = for_each_row(*part, [&](Statement& row) -> Expected<void> {
            auto value = row_value<PartSetup>(row.text(0), "part", db.path(), kRow);
            if (!value) return tl::unexpected(value.error());
            project.part = std::move(*value);
            const auto mesh = row.blob(1);
            project.part.mesh_ply.assign(mesh.begin(), mesh.end());
            return {};
        });
        if (!parted) return tl::unexpected(parted.error());
        for (const auto& done :
             {load_rows(db, "SELECT id, body FROM sensors ORDER BY position", "sensor", project.sensors),
              load_rows(db, "SELECT id, body FROM robots ORDER BY position", "robot", project.robots),
              load_rows(db, "SELECT id, body FROM calibrations ORDER BY position", "calibration",
                        project.calibrations),
              load_rows(db,
                        "SELECT id, body, reference_profile, template_profile FROM spots ORDER BY position",
                        "spot", project.spots),
              load_rows(db, "SELECT id, body FROM regions ORDER BY position", "region", project.regions)})
            if (!done) return tl::unexpected(done.error());
        return project;
    };
    auto project = read();
    (void)db.execute("ROLLBACK");
    return project;
}

Expected<void> ProjectFile::save(const Project& project) {
    auto transaction = Transaction::begin(impl_->db);
    if (!transaction) return tl::unexpected(transaction.error());
    if (auto done = save_all(impl_->db, project); !done) return done;
    return transaction->commit();
}

Expected<std::int64_t> ProjectFile::append_run(const RunRecord& run, const Project& setup) {
    Database& db = impl_->db;
    auto transaction = Transaction::begin(db);
    if (!transaction) return tl::unexpected(transaction.error());
    auto setup_number = setup_id(db, setup);
    if (!setup_number) return setup_number;
    for (const std::string* text : {&run.part_id, &run.started_utc, &run.finished_utc, &run.message})
        if (auto utf8 = dump_document(*text, "run"); !utf8) return tl::unexpected(utf8.error());
    auto s = db.prepare(
        "INSERT INTO runs (part_id, started_utc, finished_utc, push, status, message, setup) VALUES (?, ?, "
        "?, ?, ?, ?, ?)");
    if (!s) return tl::unexpected(s.error());
    s->bind(1, run.part_id);
    s->bind(2, run.started_utc);
    s->bind(3, run.finished_utc);
    s->bind(4, std::int64_t{run.push});
    s->bind(5, to_string(run.status));
    s->bind(6, run.message);
    s->bind(7, *setup_number);
    if (auto done = s->run(); !done) return tl::unexpected(done.error());
    const std::int64_t number = db.last_rowid();
    auto spot =
        db.prepare("INSERT INTO run_spots (run, position, spot_id, status, body) VALUES (?, ?, ?, ?, ?)");
    if (!spot) return tl::unexpected(spot.error());
    for (std::size_t i = 0; i < run.spots.size(); ++i) {
        auto text = row_text(run.spots[i], "spot " + run.spots[i].spot_id, kResult);
        if (!text) return tl::unexpected(text.error());
        spot->bind(1, number);
        spot->bind(2, static_cast<std::int64_t>(i));
        spot->bind(3, run.spots[i].spot_id);
        spot->bind(4, to_string(run.spots[i].status));
        spot->bind(5, *text);
        if (auto done = spot->run(); !done) return tl::unexpected(done.error());
    }
    if (auto done = insert_regions(db, run, number); !done) return tl::unexpected(done.error());
    if (auto done = insert_captures(db, run, number); !done) return tl::unexpected(done.error());
    for (const EventRecord& event : run.events)
        if (auto done = insert_event(db, event, number); !done) return tl::unexpected(done.error());
    if (auto done = transaction->commit(); !done) return tl::unexpected(done.error());
    return number;
}

Expected<void> ProjectFile::update_run(const RunRecord& run) {
    Database& db = impl_->db;
    auto transaction = Transaction::begin(db);
    if (!transaction) return tl::unexpected(transaction.error());
    auto s = db.prepare(
        "UPDATE runs SET finished_utc = ?, status = ?, message = ? WHERE number = ? RETURNING number");
    if (!s) return tl::unexpected(s.error());
    s->bind(1, run.finished_utc);
    s->bind(2, to_string(run.status));
    s->bind(3, run.message);
    s->bind(4, run.number);
    auto row = s->step();
    if (!row) return tl::unexpected(row.error());
    if (!*row) return input_error(fmt::format("there is no run {}", run.number), impl_->path.string());
    if (auto done = s->run(); !done) return done;
    auto remove = db.prepare("DELETE FROM run_regions WHERE run = ?");
    if (!remove) return tl::unexpected(remove.error());
    remove->bind(1, run.number);
    if (auto done = remove->run(); !done) return done;
    if (auto done = insert_regions(db, run, run.number); !done) return done;
    return transaction->commit();
}

Expected<std::int64_t> ProjectFile::append_event(const EventRecord& event) {
    if (auto done = insert_event(impl_->db, event, event.run); !done) return tl::unexpected(done.error());
    return impl_->db.last_rowid();
}

Expected<std::vector<RunSummary>> ProjectFile::runs() const {
    auto s = impl_->db.prepare(
        "SELECT number, part_id, started_utc, finished_utc, push, status, message, setup, "
        "(SELECT count(*) FROM run_spots WHERE run = number), "
        "(SELECT ifnull(sum(captures), 0) FROM captures WHERE run = number) FROM runs ORDER BY number");
    if (!s) return tl::unexpected(s.error());
    std::vector<RunSummary> runs;
    auto read = for_each_row(*s, [&](Statement& row) -> Expected<void> {
        RunSummary run;
        run.number = row.integer(0);
        run.part_id = row.text(1);
        run.started_utc = row.text(2);
        run.finished_utc = row.text(3);
        run.push = row.integer(4) != 0;
        const auto status = run_status_from(row.text(5));
        if (!status)
            return file_error("a run has an unknown status",
                              fmt::format("{}: run {}", impl_->path.string(), run.number));
        run.status = *status;
        run.message = row.text(6);
        run.setup = row.integer(7);
        run.spots = static_cast<int>(row.integer(8));
        run.captures = static_cast<int>(row.integer(9));
        runs.push_back(std::move(run));
        return {};
    });
    if (!read) return tl::unexpected(read.error());
    return runs;
}

Expected<RunRecord> ProjectFile::load_run(std::int64_t number, bool with_captures) const {
    Database& db = impl_->db;
    auto s = db.prepare(
        "SELECT part_id, started_utc, finished_utc, push, status, message FROM runs WHERE number = ?");
    if (!s) return tl::unexpected(s.error());
    s->bind(1, number);
    RunRecord run;
    auto read = for_each_row(*s, [&](Statement& row) -> Expected<void> {
        run.number = number;
        run.part_id = row.text(0);
        run.started_utc = row.text(1);
        run.finished_utc = row.text(2);
        run.push = row.integer(3) != 0;
        const auto status = run_status_from(row.text(4));
        if (!status)
            return file_error("the run has an unknown status",
                              fmt::format("{}: run {}", impl_->path.string(), number));
        run.status = *status;
        run.message = row.text(5);
        return {};
    });
    if (!read) return tl::unexpected(read.error());
    if (run.number != number || number < 1)
        return input_error(fmt::format("there is no run {}", number), impl_->path.string());
    if (auto done = load_results(db, "SELECT spot_id, body FROM run_spots WHERE run = ? ORDER BY position",
                                 number, run.spots);
        !done)
        return tl::unexpected(done.error());
    if (auto done =
            load_results(db, "SELECT region_id, body FROM run_regions WHERE run = ? ORDER BY position",
                         number, run.regions);
        !done)
        return tl::unexpected(done.error());
    if (with_captures)
        if (auto done = load_captures(db, run); !done) return tl::unexpected(done.error());
    auto events_of_run = events(number);
    if (!events_of_run) return tl::unexpected(events_of_run.error());
    run.events = std::move(*events_of_run);
    return run;
}

Expected<Project> ProjectFile::load_setup(std::int64_t setup) const {
    auto s = impl_->db.prepare("SELECT body FROM setups WHERE id = ?");
    if (!s) return tl::unexpected(s.error());
    s->bind(1, setup);
    auto row = s->step();
    if (!row) return tl::unexpected(row.error());
    if (!*row) return file_error(fmt::format("setup {} is missing", setup), impl_->path.string());
    const std::string text = s->text(0);
    s->reset();
    return row_value<Project>(text, fmt::format("setup {}", setup), impl_->path.string(), kSetup);
}

Expected<Project> ProjectFile::load_run_setup(std::int64_t number) const {
    auto s = impl_->db.prepare("SELECT setup FROM runs WHERE number = ?");
    if (!s) return tl::unexpected(s.error());
    s->bind(1, number);
    auto row = s->step();
    if (!row) return tl::unexpected(row.error());
    if (!*row) return input_error(fmt::format("there is no run {}", number), impl_->path.string());
    const std::int64_t setup = s->integer(0);
    s->reset();
    return load_setup(setup);
}

Expected<std::vector<EventRecord>> ProjectFile::events(std::int64_t run) const {
    auto s = impl_->db.prepare(
        run ? "SELECT id, utc, run, kind, subject, text FROM events WHERE run = ? ORDER BY id"
            : "SELECT id, utc, run, kind, subject, text FROM events ORDER BY id");
    if (!s) return tl::unexpected(s.error());
    if (run) s->bind(1, run);
    std::vector<EventRecord> list;
    auto read = for_each_row(*s, [&](Statement& row) -> Expected<void> {
        EventRecord event;
        event.id = row.integer(0);
        event.utc = row.text(1);
        event.run = row.integer(2);
        const auto kind = event_kind_from(row.text(3));
        if (!kind) return file_error("an event has an unknown kind", impl_->path.string());
        event.kind = *kind;
        event.subject = row.text(4);
        event.text = row.text(5);
        list.push_back(std::move(event));
        return {};
    });
    if (!read) return tl::unexpected(read.error());
    return list;
}

Expected<void> ProjectFile::delete_run(std::int64_t number) {
    auto s = impl_->db.prepare("DELETE FROM runs WHERE number = ?");
    if (!s) return tl::unexpected(s.error());
    s->bind(1, number);
    return s->run();
}

std::vector<Error> ProjectFile::check() const {
    std::vector<Error> findings;
    Database& db = impl_->db;
    auto integrity = db.prepare("PRAGMA integrity_check(20)");
    if (!integrity) return {integrity.error()};
    auto read = for_each_row(*integrity, [&](Statement& row) -> Expected<void> {
        if (const std::string line = row.text(0); line != "ok")
            findings.push_back(Error{ErrorKind::file, line, impl_->path.string(),
                                     "take the last good copy from the backup"});
        return {};
    });
    if (!read) findings.push_back(read.error());
    if (auto structure = check_structure(db, current_version()); !structure)
        findings.push_back(structure.error());
    if (auto project = load(); !project) findings.push_back(project.error());
    if (auto all = events(); !all) findings.push_back(all.error());
    auto list = runs();
    if (!list) {
        findings.push_back(list.error());
        return findings;
    }
    std::set<std::int64_t> setups;
    for (const RunSummary& run : *list) {
        if (auto record = load_run(run.number); !record) findings.push_back(record.error());
        if (setups.insert(run.setup).second)
            if (auto setup = load_setup(run.setup); !setup) findings.push_back(setup.error());
    }
    return findings;
}

}  // namespace seamwright
