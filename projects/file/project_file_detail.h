#pragma once
// Shared by the parts of the project file: project_file.cpp (making, opening, migrating), project_check.cpp, users.cpp, and
// rows/ with a file for each kind of row.

#include <fmt/format.h>
#include <zlib.h>

#include <array>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "devices/capture/sqlite.h"
#include "devices/exchange/json_fields.h"
#include "projects/file/project_file.h"
#include "projects/file/project_json.h"

namespace seamwright {

// What belongs to a run holds names and messages that devices chose.
struct RowForm {
    ArchiveOptions archive;
    bool of_a_run;
};
inline constexpr RowForm kRow{{.profiles = false, .rigid_poses = true},  // profiles have columns of their own
                              false};
inline constexpr RowForm kPanelRow{{.profiles = true, .rigid_poses = true}, false};
inline constexpr RowForm kSetup{{.profiles = true, .rigid_poses = true}, true};
inline constexpr RowForm kResult{{.profiles = true, .rigid_poses = false}, true};

inline std::uint32_t crc_of(std::span<const std::byte> bytes) {
    return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}
inline std::uint32_t crc_of(std::string_view text) {
    return crc_of(std::as_bytes(std::span(text)));
}

// Text of a value that must be readable again; the Error is the caller's input. Devices may name themselves
// and write messages in any bytes, so what belongs to a run is made UTF-8 instead of refused.
template <class T>
Expected<std::string> row_text(const T& value, const std::string& where, const RowForm& form) {
    const nlohmann::json document = to_json_document(value, form.archive);
    SEAM_OK(from_json_document<T>(document, where, form.archive));
    // A row also stands a few steps down in the setup of a run and in an export, which are read with the same
    // limit.
    constexpr std::size_t kAroundRow = 4;
    if (json_depth(document) > kDeepestJson - (form.of_a_run ? 0 : kAroundRow))
        return input_error(Text("the JSON is nested deeper than {}", kDeepestJson - kAroundRow), where);
    auto text =
        form.of_a_run ? Expected<std::string>(dump_messages(document)) : dump_document(document, where);
    if (text && text->size() > kTextFileLimit)
        return input_error(Text("the entry is longer than {} MiB", kTextFileLimit >> 20), where);
    return text;
}

template <class T>
Expected<T> row_value(const std::string& text, const Text& where, const std::string& path,
                      const RowForm& form) {
    const auto document = parse_json(text, where.english());
    if (!document)
        return file_error("an entry of the project file cannot be read", joined(path, ": ", where));
    auto value = from_json_document<T>(*document, where.english(), form.archive);
    if (!value) {
        Error error = value.error();
        error.kind = ErrorKind::file;
        error.within(path);
        return tl::unexpected(std::move(error));
    }
    return value;
}

// Calls `read` for each row; stops at its first Error.
template <class Read>
Expected<void> for_each_row(Statement& s, Read read) {
    for (;;) {
        SEAM_TRY(auto row, s.step());
        if (!row) return {};
        Expected<void> done = read(s);
        if (done) done = s.row_ok();
        if (!done) {
            s.reset();
            return done;
        }
    }
}

// rows/project_rows.cpp; within the caller's transaction. Says what it changed, in the words of the chain's entries.
struct RowChange {
    std::string table, id;
    bool gone = false;
    std::string note;  // what of its body
};
// The tables of the project itself.
inline constexpr std::array<const char*, 15> kProjectTables{
    "project",    "requirements", "part",       "sensors", "robots",      "calibrations", "spots", "regions",
    "panel_jobs", "line",         "part_types", "elastic", "drift_watch", "fixture",      "fleet"};
// What the chain calls a row of them.
inline std::string subject_of(std::string_view table, std::string_view id) {
    return fmt::format("{} {}", table, id);
}
// Rows whose subject is `kept` stay as they are.
Expected<std::vector<RowChange>> save_rows_of(Database& db, const Project& project,
                                              const std::set<std::string>& kept = {});
Expected<void> chain_changes(Database& db, const std::string& person, const std::vector<RowChange>& changes);
Expected<Project> load_rows_of(Database& db);

// rows/event_rows.cpp; within the caller's transaction.
Expected<std::int64_t> insert_event(Database& db, const std::string& person, const EventRecord& event,
                                    std::int64_t run);
// rows/capture_rows.cpp; within the caller's transaction. Behind those captures of the run that are `stored`; adds the
// digests of the rows it makes.
Expected<void> insert_captures(Database& db, std::span<const Capture> all, std::int64_t number,
                               StoredMeasurements& stored);
Expected<void> load_captures(Database& db, RunRecord& run);

// The project's rows as this connection loaded or saved them.
struct SeenProject {
    std::map<std::string, std::int64_t> rows;  // checksums by subject
    std::int64_t looked = 0;                   // the chain's entry up to which was looked for edits
    bool edited = false;                       // there is one that is not this connection's
};

struct ProjectFile::Impl {
    std::filesystem::path path;
    mutable Database db;
    std::optional<Person> person = {};
    std::optional<Error> trouble = {};  // why nobody works with the file
    // The last edit and the setup that a push was found to be as saved with.
    std::int64_t pushed_edit = -1;
    Digest pushed_setup = {};
    mutable std::optional<SeenProject> seen = {};  // absent: the project was not loaded
    Expected<void> see_project() const;
    Expected<bool> may_be_edited() const;
    std::string name() const { return person ? person->name : std::string(); }
    Impl(std::filesystem::path p, Database d) : path(std::move(p)), db(std::move(d)) {}
};

}  // namespace seamwright
