#include <fmt/format.h>

#include <array>
#include <set>

#include "devices/capture/profile_blob.h"
#include "projects/file/outbox/outbox.h"
#include "projects/file/project_file_detail.h"
#include "projects/file/row_checksum.h"
#include "projects/file/schema.h"
#include "projects/model/part_types.h"

namespace seamwright {
namespace {

Expected<std::int64_t> insert_event(Database& db, const std::string& person, const EventRecord& event,
                                    std::int64_t run) {
    SEAM_TRY(auto s, db.prepare("INSERT INTO events (utc, run, kind, subject, text) VALUES (?, ?, ?, ?, ?)"));
    s.bind(1, event.utc.empty() ? utc_now() : utf8_text(event.utc));
    s.bind(2, run);
    s.bind(3, to_string(event.kind));
    s.bind(4, utf8_text(event.subject));
    s.bind(5, stored_text(event.text));
    SEAM_OK(s.run());
    const std::int64_t id = db.last_rowid();
    SEAM_OK(seal_row(db, "events", "id", id));
    SEAM_TRY(const Digest digest, row_digest(db, "events", id));
    SEAM_OK(append_chain(db, person, "event", fmt::format_int(id).c_str(), digest));
    return id;
}

Expected<void> insert_regions(Database& db, const RunRecord& run, std::int64_t number) {
    SEAM_TRY(auto s, db.prepare("INSERT INTO run_regions (run, position, region_id, gate_passed, body, "
                                "checksum) VALUES (?1, ?2, ?3, "
                                "?4, ?5, row_checksum(?1, ?2, ?3, ?4, ?5))"));
    for (std::size_t i = 0; i < run.regions.size(); ++i) {
        const RegionRecord& region = run.regions[i];
        SEAM_TRY(auto text, row_text(region, "region " + region.region_id, kResult));
        s.bind(1, number);
        s.bind(2, static_cast<std::int64_t>(i));
        s.bind(3, region.region_id);
        s.bind(4, std::int64_t{region.gate_passed});
        s.bind(5, text);
        SEAM_OK(s.run());
    }
    return {};
}

Expected<void> insert_panel(Database& db, const RunRecord& run, std::int64_t number) {
    if (!run.panel) return {};
    SEAM_TRY(auto text, row_text(*run.panel, "panel job " + run.panel->job_id, kResult));
    SEAM_TRY(auto s,
             db.prepare(
                 "INSERT INTO run_panels (run, job_id, gate_passed, body, checksum) VALUES (?1, ?2, ?3, ?4, "
                 "row_checksum(?1, ?2, ?3, ?4))"));
    s.bind(1, number);
    s.bind(2, run.panel->job_id);
    s.bind(3, std::int64_t{run.panel->gate_passed});
    s.bind(4, text);
    return s.run();
}

// Behind those captures of the run that are `stored`; adds the digests of the rows it makes.
Expected<void> insert_captures(Database& db, std::span<const Capture> all, std::int64_t number,
                               StoredMeasurements& stored) {
    const auto captures = all.subspan(stored.captures);
    SEAM_TRY(auto blobs, pack_captures(captures));
    SEAM_TRY(auto chunks, db.prepare("SELECT ifnull(max(chunk) + 1, 0) FROM captures WHERE run = ?"));
    chunks.bind(1, number);
    SEAM_OK(chunks.step());
    const std::int64_t first_chunk = chunks.integer(0);
    chunks.reset();
    SEAM_TRY(auto s, db.prepare("INSERT INTO captures (run, chunk, captures, data) VALUES (?, ?, ?, ?)"));
    for (std::size_t i = 0; i < blobs.size(); ++i) {
        s.bind(1, number);
        s.bind(2, first_chunk + static_cast<std::int64_t>(i));
        s.bind(3, std::int64_t{blobs[i].captures});
        s.bind(4, std::span<const std::byte>(blobs[i].bytes));
        SEAM_OK(s.run());
        const std::array<std::int64_t, 3> front{number, first_chunk + static_cast<std::int64_t>(i),
                                                std::int64_t{blobs[i].captures}};
        stored.capture_rows.push_back(blob_row_digest("captures", front, blobs[i].bytes));
    }
    SEAM_TRY(auto image, db.prepare("INSERT INTO images (run, capture, width, height, bit_depth, crc, data) "
                                    "VALUES (?, ?, ?, ?, ?, ?, "
                                    "?)"));
    for (std::size_t i = 0; i < captures.size(); ++i) {
        if (!captures[i].image) continue;
        const StoredImage& raw = *captures[i].image;
        const StripeImage view = raw.view();
        if (view.empty() || raw.pixels.size() != view.row_bytes * static_cast<std::size_t>(view.height))
            return input_error("the image's pixels do not fill its size",
                               Text("capture of spot {}", captures[i].spot_id));
        image.bind(1, number);
        image.bind(2, static_cast<std::int64_t>(stored.captures + i));
        image.bind(3, std::int64_t{raw.width});
        image.bind(4, std::int64_t{raw.height});
        image.bind(5, std::int64_t{raw.bit_depth});
        image.bind(6, std::int64_t{crc_of(std::span<const std::byte>(raw.pixels))});
        image.bind(7, std::span<const std::byte>(raw.pixels));
        SEAM_OK(image.run());
        const std::array<std::int64_t, 5> front{number, static_cast<std::int64_t>(stored.captures + i),
                                                std::int64_t{raw.width}, std::int64_t{raw.height},
                                                std::int64_t{raw.bit_depth}};
        stored.image_rows.push_back(blob_row_digest("images", front, raw.pixels));
    }
    stored.captures += captures.size();
    return {};
}

// Those spots that `wanted` says by their position.
template <class Wanted>
Expected<void> insert_spots(Database& db, const RunRecord& run, std::int64_t number, const Wanted& wanted) {
    SEAM_TRY(auto spot, db.prepare("INSERT INTO run_spots (run, position, spot_id, status, body, checksum) "
                                   "VALUES (?1, ?2, ?3, ?4, ?5, "
                                   "row_checksum(?1, ?2, ?3, ?4, ?5))"));
    for (std::size_t i = 0; i < run.spots.size(); ++i) {
        if (!wanted(i)) continue;
        SEAM_TRY(auto text, row_text(run.spots[i], "spot " + run.spots[i].spot_id, kResult));
        spot.bind(1, number);
        spot.bind(2, static_cast<std::int64_t>(i));
        spot.bind(3, run.spots[i].spot_id);
        spot.bind(4, to_string(run.spots[i].status));
        spot.bind(5, text);
        SEAM_OK(spot.run());
    }
    return {};
}

// What a run's row refers to, but for what is stored.
Expected<void> insert_rest(Database& db, const std::string& person, const RunRecord& run, std::int64_t number,
                           StoredMeasurements stored) {
    const auto open = [&](std::size_t i) { return stored.spots.count(i) == 0; };
    SEAM_OK(insert_spots(db, run, number, open));
    SEAM_OK(insert_regions(db, run, number));
    SEAM_OK(insert_panel(db, run, number));
    SEAM_OK(insert_captures(db, run.captures, number, stored));
    if (!stored.capture_rows.empty() || !stored.image_rows.empty())
        SEAM_OK(append_chain(db, person, "captures", fmt::format_int(number).c_str(),
                             captures_digest(stored.capture_rows, stored.image_rows)));
    for (const EventRecord& event : run.events) SEAM_OK(insert_event(db, person, event, number));
    return {};
}

Expected<void> load_captures(Database& db, RunRecord& run) {
    const std::string where = fmt::format("{}: run {}", db.path(), run.number);
    SEAM_TRY(auto s, db.prepare("SELECT captures, data FROM captures WHERE run = ? ORDER BY chunk"));
    s.bind(1, run.number);
    auto read = for_each_row(s, [&](Statement& row) -> Expected<void> {
        const std::size_t before = run.captures.size();
        SEAM_OK(unpack_captures(row.blob(1), where, run.captures));
        if (static_cast<std::int64_t>(run.captures.size() - before) != row.integer(0))
            return file_error("a block holds another number of profiles than it says", where);
        return {};
    });
    if (!read) return read;
    SEAM_TRY(auto image,
             db.prepare("SELECT capture, width, height, bit_depth, crc, data FROM images WHERE run = ?"));
    image.bind(1, run.number);
    return for_each_row(image, [&](Statement& row) -> Expected<void> {
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
    SEAM_TRY(auto s, db.prepare(sql));
    s.bind(1, number);
    return for_each_row(s, [&](Statement& row) -> Expected<void> {
        SEAM_TRY(auto value,
                 row_value<T>(row.text(1), Text("run {}: {}", number, row.text(0)), db.path(), kResult));
        items.push_back(std::move(value));
        return {};
    });
}

}  // namespace

Expected<RunSetup> RunSetup::of(const Project& project) {
    Project slim = project;
    slim.part.mesh_ply.clear();
    slim.requirements.acceptance = {};
    slim.line.clear();
    slim.drift.reset();
    slim.fixture.reset();
    slim.fleet.reset();
    std::erase_if(slim.elastic, [](const RegionModes& modes) { return !modes.on; });
    for (Calibration& c : slim.calibrations) {
        c.raw = nlohmann::json::object();
        c.result = nlohmann::json::object();
    }
    SEAM_TRY(auto text, row_text(slim, "setup of the run", kSetup));
    RunSetup setup;
    setup.crc_ = crc_of(text);
    setup.text_ = std::move(text);
    return setup;
}

// The row of this setup, made when there is none yet.
Expected<std::int64_t> ProjectFile::setup_id(const RunSetup& setup) {
    Database& db = impl_->db;
    SEAM_TRY(auto find, db.prepare("SELECT id FROM setups WHERE crc = ? AND body = ?"));
    find.bind(1, setup.crc_);
    find.bind(2, setup.text_);
    SEAM_TRY(auto row, find.step());
    if (row) {
        const std::int64_t id = find.integer(0);
        find.reset();
        return id;
    }
    SEAM_TRY(auto insert, db.prepare("INSERT INTO setups (crc, body) VALUES (?, ?)"));
    insert.bind(1, setup.crc_);
    insert.bind(2, setup.text_);
    SEAM_OK(insert.run());
    const std::int64_t id = db.last_rowid();
    SEAM_OK(seal_row(db, "setups", "id", id));
    SEAM_TRY(const Digest digest, row_digest(db, "setups", id));
    SEAM_OK(append_chain(db, impl_->name(), "setup", fmt::format_int(id).c_str(), digest));
    return id;
}

Expected<std::int64_t> ProjectFile::setup_of(const Project& project) {
    SEAM_TRY(const auto setup, RunSetup::of(project));
    SEAM_TRY(auto transaction, Transaction::begin(impl_->db));
    auto id = setup_id(setup);
    if (!id) return id;
    SEAM_OK(transaction.commit());
    return id;
}

// The rows of the run as they stand. Within the caller's transaction.
Expected<void> ProjectFile::chain_run(std::int64_t number) {
    SEAM_TRY(const Digest digest, run_digest(impl_->db, number));
    return append_chain(impl_->db, impl_->name(), "run", fmt::format_int(number).c_str(), digest);
}

// Who may not teach pushes with the project as it was saved, not with what stands on his screen. Who answered of the
// devices is no part of it: the gate compares that.
Expected<void> ProjectFile::may_push_with(const RunSetup& setup, const std::string& type_id) {
    Impl& i = *impl_;
    if (!i.person || allows(i.person->role, Deed::teach)) return {};
    SEAM_TRY(const std::int64_t edit,
             i.db.integer("SELECT ifnull(max(number), 0) FROM chain WHERE kind = 'project'"));
    const Digest asked = sha256(setup.text_);
    if (edit == i.pushed_edit && asked == i.pushed_setup) return {};
    const auto plain = [](Project project) {
        for (SensorSetup& s : project.sensors) s.identity = {};
        for (RobotSetup& r : project.robots) r.identity = {};
        return RunSetup::of(project);
    };
    SEAM_TRY(const auto stored, load_rows_of(i.db));
    SEAM_TRY(const auto saved, plain(type_id.empty() ? stored : of_type(stored, type_id)));
    SEAM_TRY(const auto wanted, row_value<Project>(setup.text_, "setup of the run", i.path.string(), kSetup));
    SEAM_TRY(const auto given, plain(wanted));
    if (given.text_ != saved.text_)
        return usage_error(Text("what {} would push with is not the saved project", i.person->name),
                           i.path.string(), "an engineer has to save it first");
    i.pushed_edit = edit;
    i.pushed_setup = asked;
    return {};
}

// Within the caller's transaction.
Expected<std::int64_t> ProjectFile::insert_run(const RunRecord& run, const RunSetup& setup) {
    if (run.push) {
        SEAM_OK(may(Deed::push));
        SEAM_OK(may_push_with(setup, run.type_id));
    }
    auto setup_number = setup_id(setup);
    if (!setup_number) return setup_number;
    SEAM_TRY(auto s, impl_->db.prepare("INSERT INTO runs (part_id, started_utc, finished_utc, push, status, "
                                       "message, setup) VALUES (?, ?, "
                                       "?, ?, ?, ?, ?)"));
    s.bind(1, utf8_text(run.part_id));
    s.bind(2, utf8_text(run.started_utc));
    s.bind(3, utf8_text(run.finished_utc));
    s.bind(4, std::int64_t{run.push});
    s.bind(5, to_string(run.status));
    s.bind(6, stored_text(run.message));
    s.bind(7, *setup_number);
    SEAM_OK(s.run());
    const std::int64_t number = impl_->db.last_rowid();
    SEAM_OK(seal_row(impl_->db, "runs", "number", number));
    if (run.type_id.empty()) return number;
    SEAM_TRY(auto type, impl_->db.prepare("INSERT INTO run_types (run, type_id, checksum) VALUES (?1, ?2, "
                                          "row_checksum(?1, ?2))"));
    type.bind(1, number);
    type.bind(2, utf8_text(run.type_id));
    SEAM_OK(type.run());
    return number;
}

Expected<std::int64_t> ProjectFile::append_run(const RunRecord& run, const Project& setup) {
    SEAM_TRY(const auto text, RunSetup::of(setup));
    SEAM_TRY(auto transaction, Transaction::begin(impl_->db));
    auto number = insert_run(run, text);
    if (!number) return number;
    SEAM_OK(insert_rest(impl_->db, impl_->name(), run, *number, {}));
    SEAM_OK(chain_run(*number));
    SEAM_OK(queue_run(impl_->db, *number));
    SEAM_OK(transaction.commit());
    return number;
}

Expected<std::int64_t> ProjectFile::begin_run(const RunRecord& run, const RunSetup& setup) {
    SEAM_TRY(auto transaction, Transaction::begin(impl_->db));
    auto number = insert_run(run, setup);
    if (!number) return number;
    SEAM_OK(chain_run(*number));
    SEAM_OK(transaction.commit());
    return number;
}

Expected<void> ProjectFile::append_measured(const RunRecord& run, StoredMeasurements& stored) {
    StoredMeasurements then = stored;
    const auto measured = [&](std::size_t i) {
        return run.spots[i].capture >= 0 && then.spots.insert(i).second;
    };
    SEAM_TRY(auto transaction, Transaction::begin(impl_->db));
    SEAM_OK(insert_captures(impl_->db, run.captures, run.number, then));
    SEAM_OK(insert_spots(impl_->db, run, run.number, measured));
    // Of a judged run the raw data had their entry; a panel is measured again once it has been moved.
    if (!run.finished_utc.empty()) {
        SEAM_TRY(const auto digest, stored_captures_digest(impl_->db, run.number));
        SEAM_OK(
            append_chain(impl_->db, impl_->name(), "captures", fmt::format_int(run.number).c_str(), digest));
    }
    SEAM_OK(chain_run(run.number));
    SEAM_OK(transaction.commit());
    stored = std::move(then);
    return {};
}

Expected<void> ProjectFile::finish_run(const RunRecord& run, const StoredMeasurements& stored) {
    SEAM_TRY(auto transaction, Transaction::begin(impl_->db));
    SEAM_TRY(auto s, impl_->db.prepare("UPDATE runs SET part_id = ?, finished_utc = ?, status = ?, message = "
                                       "? WHERE number = ? RETURNING "
                                       "number"));
    s.bind(1, utf8_text(run.part_id));
    s.bind(2, utf8_text(run.finished_utc));
    s.bind(3, to_string(run.status));
    s.bind(4, stored_text(run.message));
    s.bind(5, run.number);
    SEAM_TRY(auto row, s.step());
    if (!row) return input_error(Text("there is no run {}", run.number), impl_->path.string());
    SEAM_OK(s.run());
    SEAM_OK(seal_row(impl_->db, "runs", "number", run.number));
    SEAM_OK(insert_rest(impl_->db, impl_->name(), run, run.number, stored));
    SEAM_OK(chain_run(run.number));
    SEAM_OK(queue_run(impl_->db, run.number));
    return transaction.commit();
}

Expected<void> ProjectFile::update_run(const RunRecord& run) {
    Database& db = impl_->db;
    SEAM_TRY(auto transaction, Transaction::begin(db));
    SEAM_TRY(
        auto s,
        db.prepare(
            "UPDATE runs SET finished_utc = ?, status = ?, message = ? WHERE number = ? RETURNING number"));
    s.bind(1, utf8_text(run.finished_utc));
    s.bind(2, to_string(run.status));
    s.bind(3, stored_text(run.message));
    s.bind(4, run.number);
    SEAM_TRY(auto row, s.step());
    if (!row) return input_error(Text("there is no run {}", run.number), impl_->path.string());
    SEAM_OK(s.run());
    SEAM_OK(seal_row(db, "runs", "number", run.number));
    for (const char* outcome :
         {"DELETE FROM run_regions WHERE run = ?", "DELETE FROM run_panels WHERE run = ?"}) {
        SEAM_TRY(auto remove, db.prepare(outcome));
        remove.bind(1, run.number);
        SEAM_OK(remove.run());
    }
    SEAM_OK(insert_regions(db, run, run.number));
    SEAM_OK(insert_panel(db, run, run.number));
    SEAM_OK(chain_run(run.number));
    SEAM_OK(queue_run(db, run.number));
    return transaction.commit();
}

Expected<std::int64_t> ProjectFile::append_event(const EventRecord& event) {
    SEAM_TRY(auto transaction, Transaction::begin(impl_->db));
    SEAM_TRY(const std::int64_t id, append_event_row(event));
    SEAM_OK(transaction.commit());
    return id;
}

Expected<std::int64_t> ProjectFile::append_event_row(const EventRecord& event) {
    return insert_event(impl_->db, impl_->name(), event, event.run);
}

Expected<std::int64_t> ProjectFile::append_drift_point(const DriftPoint& point) {
    Database& db = impl_->db;
    SEAM_TRY(auto transaction, Transaction::begin(db));
    SEAM_TRY(auto text, row_text(point, "drift watch", kResult));
    SEAM_TRY(auto s, db.prepare("INSERT INTO drift_points (run, body) VALUES (?, ?)"));
    s.bind(1, point.run);
    s.bind(2, text);
    SEAM_OK(s.run());
    const std::int64_t id = db.last_rowid();
    SEAM_OK(seal_row(db, "drift_points", "id", id));
    SEAM_TRY(const Digest digest, row_digest(db, "drift_points", id));
    SEAM_OK(append_chain(db, impl_->name(), "drift point", fmt::format_int(id).c_str(), digest));
    SEAM_OK(transaction.commit());
    return id;
}

Expected<std::optional<DriftWatch>> ProjectFile::load_drift_watch() const {
    SEAM_OK(check_rows(impl_->db, "drift_watch"));
    SEAM_TRY(auto s, impl_->db.prepare("SELECT body FROM drift_watch ORDER BY position LIMIT 1"));
    std::optional<DriftWatch> watch;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        SEAM_TRY(watch, row_value<DriftWatch>(row.text(0), "drift watch", impl_->path.string(), kRow));
        return {};
    }));
    return watch;
}

Expected<std::vector<DriftPoint>> ProjectFile::drift_points(std::int64_t newest) const {
    SEAM_OK(check_rows(impl_->db, "drift_points"));
    SEAM_TRY(
        auto s,
        impl_->db.prepare(
            "SELECT id, body FROM drift_points WHERE id IN (SELECT id FROM drift_points ORDER BY id DESC "
            "LIMIT ?) OR json_extract(body, '$.step') ORDER BY id"));
    s.bind(1, newest > 0 ? newest : -1);
    std::vector<DriftPoint> points;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        SEAM_TRY(auto point, row_value<DriftPoint>(row.text(1), Text("drift point {}", row.integer(0)),
                                                   impl_->path.string(), kResult));
        point.id = row.integer(0);
        points.push_back(std::move(point));
        return {};
    }));
    return points;
}

Expected<std::int64_t> ProjectFile::append_evidence(const Evidence& evidence, const Project& setup) {
    // A run without a screen is noted by itself; what else is proven is the work of who sets the cell up.
    if (!std::holds_alternative<HeadlessRun>(evidence.what)) SEAM_OK(may(Deed::teach));
    SEAM_TRY(auto with, RunSetup::of(setup));
    Database& db = impl_->db;
    SEAM_TRY(auto transaction, Transaction::begin(db));
    auto setup_number = setup_id(with);
    if (!setup_number) return setup_number;
    const std::string kind(kind_of(evidence));
    SEAM_TRY(auto text,
             std::visit([&](const auto& what) { return row_text(what, "evidence: " + kind, kResult); },
                        evidence.what));
    SEAM_TRY(auto s,
             db.prepare("INSERT INTO evidence (utc, kind, subject, setup, body) VALUES (?, ?, ?, ?, ?)"));
    const auto* frozen = std::get_if<FrozenContour>(&evidence.what);
    const auto* passes = std::get_if<TriggerPasses>(&evidence.what);
    const auto* returns = std::get_if<RobotReturns>(&evidence.what);
    const auto* plan = std::get_if<StudyPlan>(&evidence.what);
    s.bind(1, evidence.utc.empty() ? utc_now() : utf8_text(evidence.utc));
    s.bind(2, kind);
    s.bind(3, frozen    ? utf8_text(frozen->spot_id)
              : passes  ? utf8_text(passes->spot_id)
              : returns ? utf8_text(returns->robot_id)
              : plan    ? utf8_text(plan->region_id)
                        : std::string());
    s.bind(4, *setup_number);
    s.bind(5, text);
    SEAM_OK(s.run());
    const std::int64_t id = db.last_rowid();
    SEAM_OK(seal_row(db, "evidence", "id", id));
    SEAM_TRY(const Digest digest, row_digest(db, "evidence", id));
    SEAM_OK(append_chain(db, impl_->name(), "evidence", fmt::format_int(id).c_str(), digest, kind));
    SEAM_OK(transaction.commit());
    return id;
}

Expected<std::vector<Evidence>> ProjectFile::evidence(std::int64_t after) const {
    SEAM_OK(check_rows(impl_->db, "evidence"));
    SEAM_TRY(auto s,
             impl_->db.prepare("SELECT id, utc, kind, setup, body FROM evidence WHERE id > ? ORDER BY id"));
    s.bind(1, after);
    std::vector<Evidence> list;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        Evidence e;
        e.id = row.integer(0);
        e.utc = row.text(1);
        e.setup = row.integer(3);
        const std::string kind = row.text(2), body = row.text(4);
        const Text where("evidence {}", e.id);
        const auto read_as = [&]<class T>(T*) -> Expected<void> {
            SEAM_TRY(auto value, row_value<T>(body, where, impl_->path.string(), kResult));
            e.what = std::move(value);
            return {};
        };
        Expected<void> done = kind == kFrozenContour   ? read_as(static_cast<FrozenContour*>(nullptr))
                              : kind == kZeroShift     ? read_as(static_cast<ZeroShift*>(nullptr))
                              : kind == kKnownShift    ? read_as(static_cast<KnownShift*>(nullptr))
                              : kind == kHeadlessRun   ? read_as(static_cast<HeadlessRun*>(nullptr))
                              : kind == kRobotReturns  ? read_as(static_cast<RobotReturns*>(nullptr))
                              : kind == kTriggerPasses ? read_as(static_cast<TriggerPasses*>(nullptr))
                              : kind == kStudyPlan     ? read_as(static_cast<StudyPlan*>(nullptr))
                                                       : file_error("an evidence is of unknown kind",
                                                                    joined(impl_->path.string(), ": ", where));
        if (done) list.push_back(std::move(e));
        return done;
    }));
    return list;
}

Expected<std::vector<RunSummary>> ProjectFile::runs() const {
    for (const char* table : {"runs", "run_types"}) SEAM_OK(check_rows(impl_->db, table));
    SEAM_TRY(auto s, impl_->db.prepare(
                         "SELECT number, part_id, started_utc, finished_utc, push, status, message, setup, "
                         "(SELECT count(*) FROM run_spots WHERE run = number), (SELECT ifnull(sum(captures), "
                         "0) FROM captures WHERE run = number), ifnull((SELECT type_id FROM run_types WHERE "
                         "run = number), '') FROM runs ORDER BY number"));
    std::vector<RunSummary> runs;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        RunSummary run;
        run.number = row.integer(0);
        run.part_id = row.text(1);
        run.started_utc = row.text(2);
        run.finished_utc = row.text(3);
        run.push = row.integer(4) != 0;
        const auto status = run_status_from(row.text(5));
        if (!status)
            return file_error("a run has an unknown status",
                              Text("{}: run {}", impl_->path.string(), run.number));
        run.status = *status;
        run.message = text_from_stored(row.text(6));
        run.setup = row.integer(7);
        run.spots = static_cast<int>(row.integer(8));
        run.captures = static_cast<int>(row.integer(9));
        run.type_id = row.text(10);
        runs.push_back(std::move(run));
        return {};
    }));
    return runs;
}

Expected<RunRecord> ProjectFile::load_run(std::int64_t number, bool with_captures) const {
    Database& db = impl_->db;
    SEAM_OK(check_rows(db, "runs", "number", number));
    for (const char* table : {"run_spots", "run_regions", "run_panels", "run_types"})
        SEAM_OK(check_rows(db, table, "run", number));
    SEAM_TRY(
        auto s,
        db.prepare(
            "SELECT part_id, started_utc, finished_utc, push, status, message, ifnull((SELECT type_id FROM "
            "run_types WHERE run = number), '') FROM runs WHERE number = ?"));
    s.bind(1, number);
    RunRecord run;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        run.number = number;
        run.part_id = row.text(0);
        run.started_utc = row.text(1);
        run.finished_utc = row.text(2);
        run.push = row.integer(3) != 0;
        const auto status = run_status_from(row.text(4));
        if (!status)
            return file_error("the run has an unknown status",
                              Text("{}: run {}", impl_->path.string(), number));
        run.status = *status;
        run.message = text_from_stored(row.text(5));
        run.type_id = row.text(6);
        return {};
    }));
    if (run.number != number || number < 1)
        return input_error(Text("there is no run {}", number), impl_->path.string());
    if (auto done = load_results(db, "SELECT spot_id, body FROM run_spots WHERE run = ? ORDER BY position",
                                 number, run.spots);
        !done)
        return tl::unexpected(done.error());
    if (auto done =
            load_results(db, "SELECT region_id, body FROM run_regions WHERE run = ? ORDER BY position",
                         number, run.regions);
        !done)
        return tl::unexpected(done.error());
    std::vector<PanelRecord> panels;
    if (auto done = load_results(db, "SELECT job_id, body FROM run_panels WHERE run = ?", number, panels);
        !done)
        return tl::unexpected(done.error());
    if (!panels.empty()) run.panel = std::move(panels.front());
    if (with_captures) SEAM_OK(load_captures(db, run));
    SEAM_TRY(auto events_of_run, events(number));
    run.events = std::move(events_of_run);
    return run;
}

Expected<Project> ProjectFile::load_setup(std::int64_t setup) const {
    SEAM_OK(check_rows(impl_->db, "setups", "id", setup));
    SEAM_TRY(auto s, impl_->db.prepare("SELECT body FROM setups WHERE id = ?"));
    s.bind(1, setup);
    SEAM_TRY(auto row, s.step());
    if (!row) return file_error(Text("setup {} is missing", setup), impl_->path.string());
    const std::string text = s.text(0);
    s.reset();
    return row_value<Project>(text, Text("setup {}", setup), impl_->path.string(), kSetup);
}

Expected<Project> ProjectFile::load_run_setup(std::int64_t number) const {
    SEAM_OK(check_rows(impl_->db, "runs", "number", number));
    SEAM_TRY(auto s, impl_->db.prepare("SELECT setup FROM runs WHERE number = ?"));
    s.bind(1, number);
    SEAM_TRY(auto row, s.step());
    if (!row) return input_error(Text("there is no run {}", number), impl_->path.string());
    const std::int64_t setup = s.integer(0);
    s.reset();
    return load_setup(setup);
}

Expected<std::vector<EventRecord>> ProjectFile::events(std::int64_t run) const {
    SEAM_OK(check_rows(impl_->db, "events", run ? "run" : nullptr, run));
    SEAM_TRY(auto s, impl_->db.prepare(fmt::format(
                         "SELECT id, utc, run, kind, subject, text, ifnull((SELECT person FROM chain WHERE "
                         "chain.kind = 'event' AND chain.subject = CAST(events.id AS TEXT)), '') FROM events "
                         "{}ORDER BY id",
                         run ? "WHERE run = ? " : "")));
    if (run) s.bind(1, run);
    std::vector<EventRecord> list;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        EventRecord event;
        event.id = row.integer(0);
        event.utc = row.text(1);
        event.run = row.integer(2);
        const auto kind = event_kind_from(row.text(3));
        if (!kind) return file_error("an event has an unknown kind", impl_->path.string());
        event.kind = *kind;
        event.subject = row.text(4);
        event.text = text_from_stored(row.text(5));
        event.person = row.text(6);
        list.push_back(std::move(event));
        return {};
    }));
    return list;
}

Expected<void> ProjectFile::delete_run(std::int64_t number) {
    SEAM_TRY(auto transaction, Transaction::begin(impl_->db));
    SEAM_OK(may(Deed::remove));
    SEAM_TRY(auto s, impl_->db.prepare("DELETE FROM runs WHERE number = ?"));
    s.bind(1, number);
    const auto before = sqlite3_total_changes(impl_->db.handle());
    SEAM_OK(s.run());
    if (sqlite3_total_changes(impl_->db.handle()) == before) return {};
    SEAM_OK(append_chain(impl_->db, impl_->name(), "run", fmt::format_int(number).c_str(), {}));
    SEAM_OK(forget_queued(impl_->db, number));
    return transaction.commit();
}

Expected<std::vector<ChainEntry>> ProjectFile::chain(std::int64_t after, std::int64_t most) const {
    SEAM_TRY(auto s,
             impl_->db.prepare("SELECT number, utc, person, kind, subject, digest, note, hash FROM chain "
                               "WHERE number > ? ORDER BY number LIMIT ?"));
    s.bind(1, after);
    s.bind(2, most > 0 ? most : -1);
    std::vector<ChainEntry> entries;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        entries.push_back({row.integer(0), row.text(1), row.text(2), row.text(3), row.text(4),
                           hex(row.blob(5)), row.text(6), hex(row.blob(7))});
        return {};
    }));
    return entries;
}

Expected<std::vector<StoredEvent>> ProjectFile::stored_events() const {
    SEAM_TRY(auto s, impl_->db.prepare("SELECT id, run, utc, kind, subject, text FROM events ORDER BY id"));
    std::vector<StoredEvent> list;
    SEAM_OK(for_each_row(s, [&](Statement& row) -> Expected<void> {
        list.push_back({row.integer(0), row.integer(1), row.text(2), row.text(3), row.text(4), row.text(5)});
        return {};
    }));
    return list;
}

Expected<std::vector<Error>> ProjectFile::check_chain() const {
    return seamwright::check_chain(impl_->db);
}

std::vector<Error> ProjectFile::check() const {
    std::vector<Error> findings;
    Database& db = impl_->db;
    if (auto chained = check_chain(); !chained)
        findings.push_back(chained.error());
    else
        findings = std::move(*chained);
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
    std::set<std::int64_t> setups;
    const auto check_setup = [&](std::int64_t number) {
        if (!setups.insert(number).second) return;
        if (auto setup = load_setup(number); !setup) findings.push_back(setup.error());
    };
    if (auto proven = evidence(); !proven)
        findings.push_back(proven.error());
    else
        for (const Evidence& e : *proven) check_setup(e.setup);
    if (auto points = drift_points(); !points) findings.push_back(points.error());
    for (const char* table : {"scans", "guides"})
        if (auto kept = check_rows(db, table); !kept) findings.push_back(kept.error());
    auto list = runs();
    if (!list) {
        findings.push_back(list.error());
        return findings;
    }
    for (const RunSummary& run : *list) {
        if (auto record = load_run(run.number); !record) findings.push_back(record.error());
        check_setup(run.setup);
    }
    return findings;
}

}  // namespace seamwright
