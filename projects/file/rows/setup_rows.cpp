// What of a project a run was made with.

#include <fmt/format.h>

#include "projects/file/project_file_detail.h"
#include "projects/file/row_checksum.h"
#include "projects/model/part_types.h"

namespace seamwright {

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

}  // namespace seamwright
