#include "projects/file/schema.h"

#include <fmt/format.h>

#include <array>
#include <map>
#include <mutex>

#include "projects/file/chain/chain.h"
#include "projects/file/row_checksum.h"

namespace seamwright {
namespace {

constexpr const char* kVersion1 = R"sql(
CREATE TABLE project (
    id INTEGER PRIMARY KEY CHECK (id = 1),
    name TEXT NOT NULL,
    created_utc TEXT NOT NULL
) STRICT;
CREATE TABLE part (
    id INTEGER PRIMARY KEY CHECK (id = 1),
    body TEXT NOT NULL,
    mesh BLOB NOT NULL
) STRICT;
CREATE TABLE sensors (
    id TEXT PRIMARY KEY NOT NULL,
    position INTEGER NOT NULL,
    driver TEXT NOT NULL,
    body TEXT NOT NULL
) STRICT;
CREATE TABLE robots (
    id TEXT PRIMARY KEY NOT NULL,
    position INTEGER NOT NULL,
    driver TEXT NOT NULL,
    body TEXT NOT NULL
) STRICT;
CREATE TABLE calibrations (
    id TEXT PRIMARY KEY NOT NULL,
    position INTEGER NOT NULL,
    sensor_id TEXT NOT NULL,
    robot_id TEXT NOT NULL,
    created_utc TEXT NOT NULL,
    verdict TEXT NOT NULL,
    body TEXT NOT NULL
) STRICT;
CREATE TABLE spots (
    id TEXT PRIMARY KEY NOT NULL,
    position INTEGER NOT NULL,
    sensor_id TEXT NOT NULL,
    robot_id TEXT NOT NULL,
    body TEXT NOT NULL,
    reference_profile BLOB NOT NULL,
    template_profile BLOB NOT NULL
) STRICT;
CREATE TABLE regions (
    id TEXT PRIMARY KEY NOT NULL,
    position INTEGER NOT NULL,
    frame_name TEXT NOT NULL,
    body TEXT NOT NULL
) STRICT;
CREATE TABLE setups (
    id INTEGER PRIMARY KEY,
    crc INTEGER NOT NULL,
    body TEXT NOT NULL
) STRICT;
CREATE INDEX setups_by_crc ON setups (crc);
CREATE TABLE runs (
    number INTEGER PRIMARY KEY AUTOINCREMENT,
    part_id TEXT NOT NULL,
    started_utc TEXT NOT NULL,
    finished_utc TEXT NOT NULL,
    push INTEGER NOT NULL CHECK (push IN (0, 1)),
    status TEXT NOT NULL,
    message TEXT NOT NULL,
    setup INTEGER NOT NULL REFERENCES setups (id)
) STRICT;
CREATE TABLE run_spots (
    run INTEGER NOT NULL REFERENCES runs (number) ON DELETE CASCADE,
    position INTEGER NOT NULL,
    spot_id TEXT NOT NULL,
    status TEXT NOT NULL,
    body TEXT NOT NULL,
    PRIMARY KEY (run, position)
) STRICT, WITHOUT ROWID;
CREATE TABLE run_regions (
    run INTEGER NOT NULL REFERENCES runs (number) ON DELETE CASCADE,
    position INTEGER NOT NULL,
    region_id TEXT NOT NULL,
    gate_passed INTEGER NOT NULL CHECK (gate_passed IN (0, 1)),
    body TEXT NOT NULL,
    PRIMARY KEY (run, position)
) STRICT, WITHOUT ROWID;
CREATE TABLE captures (
    id INTEGER PRIMARY KEY,
    run INTEGER NOT NULL REFERENCES runs (number) ON DELETE CASCADE,
    chunk INTEGER NOT NULL,
    captures INTEGER NOT NULL,
    data BLOB NOT NULL,
    UNIQUE (run, chunk)
) STRICT;
CREATE TABLE events (
    id INTEGER PRIMARY KEY AUTOINCREMENT,
    utc TEXT NOT NULL,
    run INTEGER NOT NULL,
    kind TEXT NOT NULL,
    subject TEXT NOT NULL,
    text TEXT NOT NULL
) STRICT;
)sql";

// Raw camera images of captures, packed rows.
constexpr const char* kVersion2 = R"sql(
CREATE TABLE images (
    id INTEGER PRIMARY KEY,
    run INTEGER NOT NULL REFERENCES runs (number) ON DELETE CASCADE,
    capture INTEGER NOT NULL,
    width INTEGER NOT NULL,
    height INTEGER NOT NULL,
    bit_depth INTEGER NOT NULL,
    crc INTEGER NOT NULL,
    data BLOB NOT NULL,
    UNIQUE (run, capture)
) STRICT;
CREATE INDEX events_by_run ON events (run);
)sql";

// What the project asks of itself, and what was proven, with the setup it was proven with.
constexpr const char* kVersion3 = R"sql(
CREATE TABLE requirements (
    id INTEGER PRIMARY KEY CHECK (id = 1),
    body TEXT NOT NULL
) STRICT;
CREATE TABLE evidence (
    id INTEGER PRIMARY KEY AUTOINCREMENT,
    utc TEXT NOT NULL,
    kind TEXT NOT NULL,
    subject TEXT NOT NULL,
    setup INTEGER NOT NULL REFERENCES setups (id),
    body TEXT NOT NULL
) STRICT;
)sql";

// Panel jobs with the profiles that were taught, as JSON; a panel job's run beside the path runs.
constexpr const char* kVersion4 = R"sql(
CREATE TABLE panel_jobs (
    id TEXT PRIMARY KEY NOT NULL,
    position INTEGER NOT NULL,
    frame_name TEXT NOT NULL,
    body TEXT NOT NULL
) STRICT;
CREATE TABLE run_panels (
    run INTEGER PRIMARY KEY REFERENCES runs (number) ON DELETE CASCADE,
    job_id TEXT NOT NULL,
    gate_passed INTEGER NOT NULL CHECK (gate_passed IN (0, 1)),
    body TEXT NOT NULL
) STRICT;
)sql";

constexpr std::int32_t kChecksums = 5;  // the first version with them
// Every row says what it should be (row_checksum.h). A run's status knows "pushed" and "not_taken" from here
// on, its pushes the robot and what became of its permission to run.
constexpr const char* kVersion5 = R"sql(
ALTER TABLE project ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
ALTER TABLE requirements ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
ALTER TABLE part ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
ALTER TABLE sensors ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
ALTER TABLE robots ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
ALTER TABLE calibrations ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
ALTER TABLE spots ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
ALTER TABLE regions ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
ALTER TABLE panel_jobs ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
ALTER TABLE setups ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
ALTER TABLE runs ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
ALTER TABLE run_spots ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
ALTER TABLE run_regions ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
ALTER TABLE run_panels ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
ALTER TABLE events ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
ALTER TABLE evidence ADD COLUMN checksum INTEGER NOT NULL DEFAULT 0;
UPDATE project SET checksum = row_checksum(id, name, created_utc);
UPDATE requirements SET checksum = row_checksum(id, body);
UPDATE part SET checksum = row_checksum(id, body, mesh);
UPDATE sensors SET checksum = row_checksum(id, position, driver, body);
UPDATE robots SET checksum = row_checksum(id, position, driver, body);
UPDATE calibrations SET checksum = row_checksum(id, position, sensor_id, robot_id, created_utc, verdict, body);
UPDATE spots SET checksum = row_checksum(id, position, sensor_id, robot_id, body, reference_profile, template_profile);
UPDATE regions SET checksum = row_checksum(id, position, frame_name, body);
UPDATE panel_jobs SET checksum = row_checksum(id, position, frame_name, body);
UPDATE setups SET checksum = row_checksum(id, crc, body);
UPDATE runs SET checksum = row_checksum(number, part_id, started_utc, finished_utc, push, status, message, setup);
UPDATE run_spots SET checksum = row_checksum(run, position, spot_id, status, body);
UPDATE run_regions SET checksum = row_checksum(run, position, region_id, gate_passed, body);
UPDATE run_panels SET checksum = row_checksum(run, job_id, gate_passed, body);
UPDATE events SET checksum = row_checksum(id, utc, run, kind, subject, text);
UPDATE evidence SET checksum = row_checksum(id, utc, kind, subject, setup, body);
)sql";

// In the rows' bodies, which no statement changes: the requirements of the acceptance, a region's kept offsets, a
// run's acting one, plans of studies among the evidence. A program that knows none of them refuses the file by its
// version instead of stumbling over a field.
constexpr const char* kVersion6 = "";

// PLCs and brokers beside the station. And, in the spots' bodies, where a reference comes from and the drawing that it was
// made from: a program that knew nothing of it would push by what nobody has confirmed.
constexpr const char* kVersion7 = R"sql(
CREATE TABLE line (
    id TEXT PRIMARY KEY NOT NULL,
    position INTEGER NOT NULL,
    protocol TEXT NOT NULL,
    body TEXT NOT NULL,
    checksum INTEGER NOT NULL
) STRICT;
)sql";

// Part types, and of which one a run is. In the bodies of spots and regions, whose they are: a program that knew nothing of
// it would measure all of them at once.
constexpr const char* kVersion8 = R"sql(
CREATE TABLE part_types (
    id TEXT PRIMARY KEY NOT NULL,
    position INTEGER NOT NULL,
    body TEXT NOT NULL,
    checksum INTEGER NOT NULL
) STRICT;
CREATE TABLE run_types (
    run INTEGER PRIMARY KEY REFERENCES runs (number) ON DELETE CASCADE,
    type_id TEXT NOT NULL,
    checksum INTEGER NOT NULL
) STRICT;
)sql";

// How the parts of a region bend. A program that knew nothing of it would write the rigid path where a
// person has switched on the bent one.
constexpr const char* kVersion9 = R"sql(
CREATE TABLE elastic (
    id TEXT PRIMARY KEY NOT NULL,
    position INTEGER NOT NULL,
    body TEXT NOT NULL,
    checksum INTEGER NOT NULL
) STRICT;
)sql";

// The drift watch and its points. A program that knew nothing of it would push after a step, and take nothing off where a
// person has switched compensation on. Scans of the part: a cloud each, in the robot's base.
constexpr const char* kVersion10 = R"sql(
CREATE TABLE drift_watch (
    id TEXT PRIMARY KEY NOT NULL,
    position INTEGER NOT NULL,
    body TEXT NOT NULL,
    checksum INTEGER NOT NULL
) STRICT;
CREATE TABLE drift_points (
    id INTEGER PRIMARY KEY AUTOINCREMENT,
    run INTEGER NOT NULL,
    body TEXT NOT NULL,
    checksum INTEGER NOT NULL DEFAULT 0
) STRICT;
CREATE TABLE scans (
    id INTEGER PRIMARY KEY AUTOINCREMENT,
    name TEXT NOT NULL UNIQUE,
    utc TEXT NOT NULL,
    sensor_id TEXT NOT NULL,
    robot_id TEXT NOT NULL,
    path TEXT NOT NULL,
    profiles INTEGER NOT NULL,
    points INTEGER NOT NULL,
    cloud BLOB NOT NULL,
    checksum INTEGER NOT NULL
) STRICT;
)sql";

// The sensor's settings by spot stand in its body. A program that knew nothing of them would measure with those of
// another spot.
constexpr const char* kVersion11 = "";

// Who may do what, and the chain of all that was done (chain.h), which old files begin here. A program that knew nothing of
// it would let everybody do everything, and leave the chain behind. What holds the part: the fixture.
constexpr const char* kVersion12 = R"sql(
CREATE TABLE users (
    id TEXT PRIMARY KEY NOT NULL,
    role TEXT NOT NULL,
    password TEXT NOT NULL,
    created_utc TEXT NOT NULL,
    checksum INTEGER NOT NULL
) STRICT;
CREATE TABLE chain (
    number INTEGER PRIMARY KEY,
    utc TEXT NOT NULL,
    person TEXT NOT NULL,
    kind TEXT NOT NULL,
    subject TEXT NOT NULL,
    digest BLOB NOT NULL,
    note TEXT NOT NULL,
    hash BLOB NOT NULL
) STRICT;
CREATE INDEX chain_by_subject ON chain (kind, subject);
CREATE TABLE fixture (
    id TEXT PRIMARY KEY NOT NULL,
    position INTEGER NOT NULL,
    body TEXT NOT NULL,
    checksum INTEGER NOT NULL
) STRICT;
)sql";
constexpr std::int32_t kChained = 12;  // the first version with a chain

// Finished runs that a fleet's database has not taken yet (outbox/outbox.h): all that an older file holds.
constexpr const char* kVersion13 = R"sql(
CREATE TABLE outbox (
    run INTEGER PRIMARY KEY NOT NULL,
    revision INTEGER NOT NULL,
    message TEXT NOT NULL,
    checksum INTEGER NOT NULL
) STRICT;
INSERT INTO outbox SELECT number, ifnull((SELECT max(chain.number) FROM chain WHERE kind = 'run' AND
    subject = CAST(runs.number AS TEXT)), 0), '', 0 FROM runs WHERE finished_utc <> '';
UPDATE outbox SET checksum = row_checksum(run, revision, message);
)sql";

// The contours that paths were corrected online by. A program that knew nothing of them would leave a run without what it
// is computed from.
constexpr const char* kVersion14 = R"sql(
CREATE TABLE guides (
    hash TEXT PRIMARY KEY NOT NULL,
    name TEXT NOT NULL,
    utc TEXT NOT NULL,
    csv TEXT NOT NULL,
    checksum INTEGER NOT NULL
) STRICT;
)sql";

// The fleet that the results go to.
constexpr const char* kVersion15 = R"sql(
CREATE TABLE fleet (
    id TEXT PRIMARY KEY NOT NULL,
    position INTEGER NOT NULL,
    body TEXT NOT NULL,
    checksum INTEGER NOT NULL
) STRICT;
)sql";

constexpr std::array<Migration, 15> kMigrations{{{1, kVersion1},
                                                 {2, kVersion2},
                                                 {3, kVersion3},
                                                 {4, kVersion4},
                                                 {5, kVersion5},
                                                 {6, kVersion6},
                                                 {7, kVersion7},
                                                 {8, kVersion8},
                                                 {9, kVersion9},
                                                 {10, kVersion10},
                                                 {11, kVersion11},
                                                 {12, kVersion12},
                                                 {13, kVersion13},
                                                 {14, kVersion14},
                                                 {15, kVersion15}}};

// The tables of a fresh file of that version; made once for each version, since making them costs more than
// checking a file does.
Expected<Database::Tables> tables_of(std::int32_t version) {
    static std::mutex mutex;
    static std::map<std::int32_t, Database::Tables> known;
    const std::lock_guard lock(mutex);
    if (const auto found = known.find(version); found != known.end()) return found->second;
    SEAM_TRY(auto fresh,
             Database::open(":memory:", SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, kProjectFile));
    SEAM_OK(migrate(fresh, version));
    auto tables = fresh.tables();
    if (tables) known.emplace(version, *tables);
    return tables;
}

}  // namespace

std::span<const Migration> migrations() {
    return kMigrations;
}
std::int32_t current_version() {
    return kMigrations.back().version;
}

Expected<void> migrate(Database& db, std::int32_t until) {
    SEAM_TRY(auto version, db.integer("PRAGMA user_version"));
    SEAM_TRY(auto transaction, Transaction::begin(db));
    for (const Migration& step : kMigrations) {
        if (step.version <= version || step.version > until) continue;
        SEAM_OK(db.execute(step.sql));
        SEAM_OK(db.execute(fmt::format("PRAGMA user_version = {}", step.version)));
        if (step.version == kChained) SEAM_OK(begin_chain(db, static_cast<std::int32_t>(version)));
    }
    SEAM_OK(db.execute(fmt::format("PRAGMA application_id = {}", kApplicationId)));
    return transaction.commit();
}

Expected<std::int32_t> check_identity(Database& db) {
    SEAM_TRY(auto id, db.integer("PRAGMA application_id"));
    if (id == kCaptureApplicationId)
        return file_error("this is a recorded capture, no project", db.path(),
                          "name it in the settings of a sensor of driver \"replay\": {\"file\": ...}");
    if (id != kApplicationId)
        return file_error("this is another program's database, no project file", db.path(),
                          "choose a .seam file");
    SEAM_TRY(auto version, db.integer("PRAGMA user_version"));
    if (version > current_version())
        return file_error(
            Text("the project file has version {}, this program knows up to {}", version, current_version()),
            db.path(), "open it with a newer Seamwright");
    if (version < 1) return file_error("the project file has no valid version", db.path());
    return static_cast<std::int32_t>(version);
}

Expected<void> check_structure(Database& db, std::int32_t version) {
    const auto damaged = [&](const Text& finding) {
        return file_error(Text("the project file is damaged ({})", finding), db.path(),
                          "take the last good copy from the backup");
    };
    SEAM_TRY(const auto wanted, tables_of(version));
    SEAM_TRY(const auto found, db.tables());
    if (found != wanted) return damaged("its tables are not those of a project");

    SEAM_TRY(auto check, db.prepare("PRAGMA integrity_check(1)"));
    auto row = check.step();
    if (!row) return tl::unexpected(row.error());
    if (const std::string answer = *row ? check.text(0) : "no answer"; answer != "ok") return damaged(answer);
    check.reset();
    SEAM_TRY(auto keys, db.prepare("PRAGMA foreign_key_check"));
    row = keys.step();
    if (!row) return tl::unexpected(row.error());
    if (*row) return damaged("a row refers to one that is not there");
    keys.reset();
    if (version >= kChecksums)
        for (const ChecksummedTable& table : checksummed_tables())
            if (version >= table.since) SEAM_OK(check_rows(db, table.name));
    return {};
}

}  // namespace seamwright
