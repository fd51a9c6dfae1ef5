#pragma once
// *.seam: one project in one SQLite file.
//
// Identity: application_id "Seam" (0x5365616D), user_version = number of the last migration (schema.h).
// Opening refuses, with one sentence (ErrorKind::file): what is no SQLite database, another program's, a
// newer version's, truncated or damaged (SQLite's own check, foreign keys, a row that contradicts its
// checksum (row_checksum.h), tables that differ from what the migrations make, so that triggers or views
// somebody planted never run). What a link leads to is the project; the link stays.
//
// Place: a file whose name leads to another file by now, or to none, is not written to any more: every save_*
// and append_* is an Error (file) then. So a push, whose attempt is recorded first, sends nothing.
//
// Crash safety: rollback journal, synchronous = FULL. Every save_*/append_* is one transaction; a process
// killed at any instant leaves the last committed state, which the next open restores from the journal beside
// the file (FILE.seam-journal; move both together). Only while devices are connected (keep_write_ahead) is
// the journal a write-ahead log, FILE.seam-wal: a commit then costs one sync instead of four, which is what a
// robot waits for. All that was committed is moved from the log into the file after every run and every save.
// A new file is made under another name in the same folder and renamed when complete. Migrations run on a
// copy that replaces the file when it has passed the checks.
//
// Contents: one row per sensor, robot, calibration, spot, region, panel job (key columns + JSON in
// project_json.h's form, doubles exact, profiles as blobs of profile_blob.h); a run is one row with its
// spots, regions, and captures packed into blobs of about 1 MiB, and refers to the setup it was made with
// (the project as JSON, stored once per content), so that it can be computed again after the project was
// edited. Evidence (evidence.h) refers to its setup in the same way.
//
// Who: a file may have users (users.h). Then what writes to it asks may() of the person who is signed in, here and nowhere
// else, and refuses with a sentence (ErrorKind::usage). Everything that is written is an entry of the chain too
// (chain/chain.h); a file that was changed behind its back is read, but nobody works with it (ErrorKind::file).

#include <filesystem>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/text.h"
#include "projects/file/chain/chain.h"
#include "projects/file/outbox/outbox.h"
#include "projects/file/run_values.h"
#include "projects/model/evidence.h"
#include "projects/model/project.h"
#include "projects/model/run.h"
#include "projects/model/users.h"

namespace seamwright {

struct RowChange;  // project_file_detail.h

// Of a sensor, robot, calibration, spot, region or panel job, in signs (id_length.h): a robot's text (RAPID: 80)
// and the name of a file that is made of it hold so much and some words more.
inline constexpr std::size_t kLongestId = 64;

enum class FileAccess { read_write, read_only };

// What a list of runs shows; cheap.
struct RunSummary {
    std::int64_t number = 0;
    std::string part_id, started_utc, finished_utc;
    std::string type_id;  // empty: of a project without part types
    bool push = false;
    RunStatus status = RunStatus::ok;
    Text message;
    int spots = 0, captures = 0;
    std::int64_t setup = 0;  // runs with equal numbers were made with the same setup
};

// A scan of the part that is kept with the project; no part of a run's setup.
struct StoredScan {
    std::string name;                 // one of a kind in the file, at most kLongestId signs
    std::string utc;                  // when it was kept, ISO 8601; empty: now
    std::string sensor_id, robot_id;  // empty: not known (a run's)
    std::string path;                 // how it was made, for people: "spots T1, T2", "run 3"
    std::int64_t profiles = 0, points = 0;
    std::vector<std::byte> cloud_ply;  // binary PLY, millimetres, robot's base; not in a list
};
inline constexpr std::size_t kLargestScan = std::size_t{512} << 20;  // bytes of cloud_ply

// The contour that a path was corrected online by (projects/ahead/follow.h), as its table stood; kept as long as the file,
// so that a run can be computed again. No part of a run's setup: the run's event names its hash.
struct StoredGuide {
    std::string name;  // of its file, for people; several guides may have one
    std::string csv;   // to the byte
    std::string utc;   // when it was kept first, ISO 8601
    std::string hash;  // SHA-256 of csv, hex, lower case
};
inline constexpr std::size_t kLargestGuide = std::size_t{64} << 20;  // bytes of csv

// The project a run is made with, as its record refers to it: made before the robot waits for it.
class RunSetup {
  public:
    // Refuses what a project file cannot hold, as save() does.
    static Expected<RunSetup> of(const Project& project);

  private:
    friend class ProjectFile;
    std::string text_;
    std::int64_t crc_ = 0;
};

// One thread at a time. Several processes may have a file open; a writer waits up to 5 s for another's lock.
// What of a run under way is in the file.
struct StoredMeasurements {
    std::size_t captures = 0;
    std::set<std::size_t> spots;  // positions in RunRecord::spots
    // Of the rows that hold the captures, see chain/chain.h.
    std::vector<Digest> capture_rows = {}, image_rows = {};
};

// An event's row as it stands, its text in the form of stored_text.h.
struct StoredEvent {
    std::int64_t id = 0, run = 0;
    std::string utc, kind, subject, text;
};

// A row of the project that another program, or another connection of this one, has changed.
struct EditOfOthers {
    std::string table, id;  // "regions", "R1"
    std::string person;     // who made the last edit; empty: nobody was signed in
};
Text said_of(const EditOfOthers& edit);

// Somebody who gave his password: other connections to the same file act for him with it (ProjectFile::act_for).
class SignedIn {
  public:
    const Person& person() const { return person_; }

  private:
    friend class ProjectFile;
    Person person_;
    std::string row_, identity_;
};

// Error (input): empty, longer than kLongestId, a sign that is not seen (controls, marks of direction), a space or dash at
// its ends.
Expected<void> check_user_name(const std::string& name);
// For a service: 256 random bits in figures. Error (file): the computer gives none.
Expected<std::string> random_password();

class ProjectFile {
  public:
    // Makes a file holding `project`. An existing file is refused unless `replace`, and then only if it is
    // empty or a Seamwright file.
    static Expected<ProjectFile> create(const std::filesystem::path& path, const Project& project,
                                        bool replace = false);
    // An older file is brought up to date: in place for read_write, in memory for read_only.
    static Expected<ProjectFile> open(const std::filesystem::path& path,
                                      FileAccess access = FileAccess::read_write);
    ProjectFile(ProjectFile&&) noexcept;
    ProjectFile& operator=(ProjectFile&&) noexcept;
    ~ProjectFile();

    const std::filesystem::path& path() const;

    // From rollback journal to write-ahead log and back, see above. Without effect on a file that is open for
    // reading, and when another process keeps it as it is: nothing depends on it but the time a commit takes.
    void keep_write_ahead(bool on);
    // Moves what was committed from the log into the file.
    void checkpoint();
    // The whole file, runs and all, as last committed, to another path; an existing file there is replaced if
    // create() would replace it.
    Expected<void> copy_to(const std::filesystem::path& path) const;

    Expected<Project> load() const;
    // Only rows that changed are written. Refuses (input) two entities of one id, empty ids and new ones of
    // more than kLongestId signs, and what check_part_types() does.
    // What other programs have changed since the first load() (or create()) of this ProjectFile is never undone: a row that
    // `project` holds as it was then stays as they left it, and one that both have changed is refused (input), with nothing
    // written.
    Expected<void> save(const Project& project);
    // Rows that others have changed since then; none where it was never loaded. Cheap where nothing was edited.
    Expected<std::vector<EditOfOthers>> edits_of_others() const;
    // load(), from which on others' edits count.
    Expected<Project> load_anew();

    // A whole run. Returns its number; events of the record get it too.
    Expected<std::int64_t> append_run(const RunRecord& run, const Project& setup);
    // A run as it comes, so that little is left to store when the robot waits for the verdict: its row first
    // (number, part, times, status, message), then again and again the captures and the spots that have one
    // since `stored`, at last all the rest.
    Expected<std::int64_t> begin_run(const RunRecord& run, const RunSetup& setup);
    Expected<void> append_measured(const RunRecord& run, StoredMeasurements& stored);
    Expected<void> finish_run(const RunRecord& run, const StoredMeasurements& stored);
    // Replaces the outcome of a run (times, status, message, regions, panel); spots, captures and events
    // stay.
    Expected<void> update_run(const RunRecord& run);
    // Returns the event's id.
    Expected<std::int64_t> append_event(const EventRecord& event);

    Expected<std::vector<RunSummary>> runs() const;
    // The numbers of many runs, oldest first, without loading any.
    Expected<std::vector<RunValues>> run_values(const RunValuesWanted& wanted = {}) const;
    // `with_captures` false leaves out the raw data.
    Expected<RunRecord> load_run(std::int64_t number, bool with_captures = true) const;
    // The project as it was when the run was made, without mesh and calibration raw data.
    Expected<Project> load_run_setup(std::int64_t number) const;
    Expected<Project> load_setup(std::int64_t setup) const;
    // The number of this setup, as runs and evidence made with `project` refer to it.
    Expected<std::int64_t> setup_of(const Project& project);
    // Newest last; run 0 = all.
    Expected<std::vector<EventRecord>> events(std::int64_t run = 0) const;
    Expected<void> delete_run(std::int64_t number);

    // --- outbox (outbox/outbox.h): finished runs that no fleet has taken yet, oldest first
    Expected<std::int64_t> queued() const;
    // At most so many behind `after_run`.
    Expected<std::vector<QueuedRun>> queued_runs(std::int64_t after_run, std::int64_t most) const;
    // What is to be published of it: the run itself may be deleted then. Nothing where it has changed meanwhile.
    Expected<void> keep_message(const QueuedRun& run, const std::string& message);
    // They are in the database; one that has changed meanwhile stays queued.
    Expected<void> published(std::span<const QueuedRun> runs);

    // What was proven, with the project it was proven with; kept when its runs are deleted. Returns its id.
    Expected<std::int64_t> append_evidence(const Evidence& evidence, const Project& setup);
    // Those with an id above `after`, oldest first.
    Expected<std::vector<Evidence>> evidence(std::int64_t after = 0) const;

    // Points of the drift watch: kept when their runs are deleted. Returns the point's id.
    Expected<std::int64_t> append_drift_point(const DriftPoint& point);
    // The watch alone, as the file has it now: a person may acknowledge while another program measures.
    Expected<std::optional<DriftWatch>> load_drift_watch() const;
    // The newest ones and, however old, those of a step, oldest first; 0 = all.
    Expected<std::vector<DriftPoint>> drift_points(std::int64_t newest = 0) const;

    // Error (input): no name or one that is too long or in the file already, no cloud, one above kLargestScan.
    Expected<void> append_scan(const StoredScan& scan);
    Expected<std::vector<StoredScan>> scans() const;  // oldest first, without their clouds
    // Error (input) where there is none of that name.
    Expected<StoredScan> load_scan(const std::string& name) const;
    Expected<void> delete_scan(const std::string& name);

    // What is kept already stays as it is, by its hash. Answers it with hash and time. Error (input): no csv, or one above
    // kLargestGuide.
    Expected<StoredGuide> keep_guide(const std::string& name, const std::string& csv);
    Expected<std::vector<StoredGuide>> guides() const;  // oldest first
    // By its hash, the first 8 figures of it or more, or by its name: the newest one. Error (input) where there is none.
    Expected<StoredGuide> load_guide(const std::string& called) const;

    // --- users; the first one is an administrator, and the last administrator stays while there are others
    Expected<std::vector<User>> users() const;  // none: nobody is asked
    Expected<void> add_user(const std::string& name, Role role, const std::string& password);
    Expected<void> remove_user(const std::string& name);
    Expected<void> set_role(const std::string& name, Role role);
    // His own, or anybody's by an administrator.
    Expected<void> set_password(const std::string& name, const std::string& password);
    // Takes a tenth of a second or more (argon2id). Error (usage): the password is wrong, or it is too soon after three
    // wrong ones (5 s, doubled with each, at most 5 min), whatever program tried them. Error (file): the chain is broken.
    Expected<SignedIn> sign_in(const std::string& name, const std::string& password);
    // Of a copy of the file too. Error (usage): of another project, or the user was changed meanwhile.
    Expected<void> act_for(const SignedIn& who);
    Expected<void> sign_out(const Text& why = "signed out");
    void forget_person();  // without an entry: another connection wrote it
    const std::optional<Person>& person() const;
    // Error: why not, and who may. His role is read anew each time.
    Expected<void> may(Deed deed) const;

    // Entries above `after`, oldest first, at most `most` (0: all).
    Expected<std::vector<StoredEvent>> stored_events() const;
    Expected<std::vector<ChainEntry>> chain(std::int64_t after = 0, std::int64_t most = 0) const;
    // Empty: every entry follows from the one before, and the file is as they say.
    Expected<std::vector<Error>> check_chain() const;

    // The long check: check_chain, SQLite's integrity_check, foreign keys, every row decoded, every blob's checksum. Empty
    // = sound.
    std::vector<Error> check() const;

  private:
    Expected<std::set<std::string>> rows_of_others(const Project& project);
    Expected<void> see_saved(const std::vector<RowChange>& changes);
    Expected<std::int64_t> setup_id(const RunSetup& setup);
    Expected<std::int64_t> insert_run(const RunRecord& run, const RunSetup& setup);
    Expected<void> chain_run(std::int64_t number);
    Expected<void> may_push_with(const RunSetup& setup, const std::string& type_id);
    Expected<void> chain_user(const std::string& name, const std::string& what);
    Expected<std::int64_t> append_event_row(const EventRecord& event);  // within a transaction
    Expected<void> note_user(const std::string& name, const Text& text);
    struct Impl;
    explicit ProjectFile(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace seamwright
