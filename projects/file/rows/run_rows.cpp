#include <fmt/format.h>

#include "projects/file/outbox/outbox.h"
#include "projects/file/project_file_detail.h"
#include "projects/file/row_checksum.h"

namespace seamwright {
namespace {

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

// The rows of the run as they stand. Within the caller's transaction.
Expected<void> ProjectFile::chain_run(std::int64_t number) {
    SEAM_TRY(const Digest digest, run_digest(impl_->db, number));
    return append_chain(impl_->db, impl_->name(), "run", fmt::format_int(number).c_str(), digest);
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

}  // namespace seamwright
