#include "widgets/desk/desk.h"

#include <QTimer>
#include <algorithm>

#include "devices/exchange/files.h"
#include "devices/exchange/pose_json.h"
#include "devices/registry.h"
#include "devices/simulated/scene/mesh_file.h"
#include "projects/calibrate/session/session.h"
#include "projects/calibrate/session/use.h"
#include "projects/file/project_json.h"
#include "projects/measure/fields.h"
#include "projects/measure/measure.h"
#include "projects/model/part_types.h"
#include "widgets/shown_text.h"

namespace seamwright {
namespace {

Expected<void> check_id(const std::string& id) {
    if (id.empty()) return input_error("the name is empty", {}, "give it a name");
    if (id.size() > 64) return input_error("the name is longer than 64 signs", {}, "shorten it");
    return {};
}

template <class T>
Expected<void> valid(const Project&, const T&) {
    return {};
}
Expected<void> known_devices(const Project& project, const Spot& spot) {
    if (!find_sensor(project, spot.sensor_id))
        return input_error(Text("the sensor \"{}\" is not in the project", spot.sensor_id),
                           Text("spot {}", spot.id), "choose one of the project's");
    if (!find_robot(project, spot.robot_id))
        return input_error(Text("the robot \"{}\" is not in the project", spot.robot_id),
                           Text("spot {}", spot.id), "choose one of the project's");
    return {};
}
template <>
Expected<void> valid<Spot>(const Project& project, const Spot& spot) {
    SEAM_OK(known_devices(project, spot));
    SEAM_OK(pose_from_matrix(spot.base_from_flange.matrix(), "spot " + spot.id));
    return validate_fields(spot);
}
template <>
Expected<void> valid<Region>(const Project& project, const Region& region) {
    for (const std::string& id : region.spot_ids)
        if (!find_spot(project, id))
            return input_error(Text("there is no spot \"{}\"", id), Text("region {}", region.id));
    if (std::none_of(region.free.begin(), region.free.end(), [](bool f) { return f; }))
        return input_error("no degree of freedom is free", Text("region {}", region.id),
                           "leave at least one free");
    SEAM_OK(pose_from_matrix(region.base_from_frame.matrix(), "region " + region.id));
    return validate_fields(region);
}
template <>
Expected<void> valid<SensorSetup>(const Project&, const SensorSetup& sensor) {
    const auto& drivers = sensor_drivers();
    if (std::none_of(drivers.begin(), drivers.end(), [&](const auto& d) { return d.name == sensor.driver; }))
        return input_error(Text("the driver \"{}\" is not known", sensor.driver),
                           Text("sensor {}", sensor.id));
    return validate_fields(sensor);
}
template <>
Expected<void> valid<RobotSetup>(const Project&, const RobotSetup& robot) {
    const auto& drivers = robot_drivers();
    if (std::none_of(drivers.begin(), drivers.end(), [&](const auto& d) { return d.name == robot.driver; }))
        return input_error(Text("the driver \"{}\" is not known", robot.driver), Text("robot {}", robot.id));
    return {};
}

// Why a thing may not go.
template <class T>
Expected<void> removable(const Project& project, const std::string& id) {
    for (const Spot& spot : project.spots) {
        if constexpr (std::is_same_v<T, SensorSetup>)
            if (spot.sensor_id == id)
                return input_error(Text("spot {} uses it", spot.id), Text("sensor {}", id),
                                   "give the spot another sensor first");
        if constexpr (std::is_same_v<T, RobotSetup>)
            if (spot.robot_id == id)
                return input_error(Text("spot {} uses it", spot.id), Text("robot {}", id),
                                   "give the spot another robot first");
    }
    return {};
}

std::string now_utc() {
    return utc_now();
}

// Who is in trouble, by name.
std::vector<Text> troubles(const StationState& state) {
    std::vector<Text> names;
    for (const SensorState& s : state.sensors)
        if (!s.trouble.empty()) names.push_back(Text("sensor {}", s.id));
    for (const RobotState& r : state.robots)
        if (!r.trouble.empty()) names.push_back(Text("robot {}", r.id));
    return names;
}

constexpr int kLookAgainMs = 2000;

}  // namespace

Desk::Desk(QObject* parent) : QObject(parent), worker_(live_) {
    connect(&undo_, &QUndoStack::cleanChanged, this, [this] {
        if (modified() != was_modified_) emit modified_changed(was_modified_ = modified());
        if (!modified()) drop_kept();  // undone to what was saved
    });
    connect(&selection_, &Selection::changed, this, &Desk::set_recipes);
    connect(&recovery_writer_, &RecoveryWriter::written, this, [this] {
        if (recovery_writer_.kept()) emit recovery_written();  // else a newer one is under way
    });
    connect(&recovery_writer_, &RecoveryWriter::trouble, this, &Desk::trouble);
    connect(&worker_, &StationWorker::failed, this, [this](const QString& sentence) {
        note(EventKind::device, "studio", sentence.toStdString());
        emit trouble(sentence);
    });
    connect(&worker_, &StationWorker::state_changed, this, [this](std::shared_ptr<const StationState> state) {
        const bool changes = state->connected != state_->connected;
        if (state->connection != state_->connection || !state->connected) attended_.clear();
        const bool healthier = troubles(*state) != troubles(*state_);
        state_ = std::move(state);
        if (healthier && !changes) derive();
        // Connected anew, with a robot more, is connected before and after.
        if (state_->connected) take_identities(*state_);
        if (changes) {
            note(EventKind::device, "studio",
                 state_->connected ? "devices connected" : "devices disconnected");
            set_recipes();
            derive();
        }
        emit station_changed();
    });
    const auto run_ended = [this](const auto&) {
        derive();
        emit runs_changed();
        emit events_changed();
    };
    connect(&worker_, &StationWorker::measured, this, run_ended);
    connect(&worker_, &StationWorker::panel_measured, this, run_ended);
    connect(&worker_, &StationWorker::panel_learnt, this, run_ended);
    connect(&worker_, &StationWorker::proven, this, [this] {
        derive();
        emit events_changed();
    });
    auto* look = new QTimer(this);
    connect(look, &QTimer::timeout, this, &Desk::look_again);
    look->start(kLookAgainMs);
    derive();
}

Desk::~Desk() {
    undo_.disconnect(this);  // it clears itself at its end; what is unsaved stays kept
    worker_.close();
}

std::filesystem::path Desk::path() const {
    return file_ ? file_->path() : std::filesystem::path();
}

Editor Desk::editor() {
    return [this](const std::function<void(Project&)>& change) {
        change(project_);
        changed();
    };
}

void Desk::changed() {
    if (file_) {
        if (!recovery_) recovery_writer_.write(project_);  // never over what waits for an answer
        worker_.use(project_);
    }
    if (modified() != was_modified_) emit modified_changed(was_modified_ = modified());
    // A selected thing that is gone is not selected any more.
    if (!selection_.spot().empty() && index_of<Spot>(project_, selection_.spot()) < 0)
        selection_.select_spot("");
    if (!selection_.region().empty() && index_of<Region>(project_, selection_.region()) < 0)
        selection_.select_region("");
    select_measured_type();
    set_recipes();
    derive();
    emit project_changed();
}

// One of the project's: what is measured without a type in a project with types is refused.
void Desk::select_measured_type() {
    const auto& types = project_.part_types;
    if (!find_type(project_, selection_.part_type()))
        selection_.select_part_type(types.empty() ? "" : types.front().id);
}

void Desk::take_over(ProjectFile file, Project project) {
    file_.emplace(std::move(file));
    person_ = file_->person();
    if (!person_) signed_in_.reset();
    import_.drop();
    project_ = std::move(project);
    facts_ = {};
    undo_.clear();
    restored_ = false;
    state_ = std::make_shared<const StationState>();
    attended_.clear();
    recovery_writer_.open(file_->path());
    worker_.open(file_->path(), project_);
    worker_.act_for(signed_in_);
    selection_.select_spot(project_.spots.empty() ? "" : project_.spots.front().id);
    selection_.select_region(project_.regions.empty() ? "" : project_.regions.front().id);
    selection_.select_sensor(project_.sensors.empty() ? "" : project_.sensors.front().id);
    select_measured_type();
    was_modified_ = false;
    set_recipes();
    derive();
    emit opened();
    emit person_changed();
    emit modified_changed(false);
    emit project_changed();
    emit runs_changed();
    emit events_changed();
}

void Desk::drop_kept() {
    if (file_ && !recovery_) recovery_writer_.clear();
}

void Desk::keep_newest() {
    if (modified() && !recovery_) recovery_writer_.write(project_);
    recovery_writer_.flush();
}

Expected<void> Desk::create(const std::filesystem::path& path, const Project& project) {
    if (file_ && path == file_->path()) close();
    SEAM_TRY(auto use, FileUse::take(path, FileUse::For::desk));
    SEAM_TRY(auto file, ProjectFile::create(path, project, true));
    if (auto aside = CalibrationSession::put_aside(path); !aside) emit trouble(shown_error(aside.error()));
    discard_recovery(path);
    drop_kept();
    recovery_.reset();
    take_over(std::move(file), project);
    use_ = std::move(use);
    return {};
}

Expected<void> Desk::open(const std::filesystem::path& path) {
    std::optional<FileUse> use;
    if (!file_ || path != file_->path()) {
        SEAM_TRY(auto taken, FileUse::take(path, FileUse::For::desk));
        use = std::move(taken);
    }
    SEAM_TRY(auto file, ProjectFile::open(path));
    SEAM_TRY(auto project, file.load());
    // Edits that were not saved in the project that is left are given up; before the look at what a crash
    // left, because both may be one file.
    drop_kept();
    recovery_writer_.flush();
    auto found = find_recovery(path, project);
    sign_out("signed out: the project was opened anew");
    recovery_.reset();
    QString told;
    if (found) {
        recovery_ = std::move(*found);
    } else if (const auto aside = set_aside_recovery(path)) {
        told = tr("The unsaved edits of an earlier session cannot be read (%1). They were set aside as %2.")
                   .arg(shown(found.error().what), QString::fromStdString(aside->filename().string()));
    } else {
        told = tr("The unsaved edits of an earlier session cannot be read (%1). They stand in the way of "
                  "those of "
                  "this session, which are not kept against a crash: %2")
                   .arg(shown(found.error().what), shown_error(aside.error()));
    }
    take_over(std::move(file), std::move(project));
    if (use) use_ = std::move(*use);
    if (!told.isEmpty()) {
        note(EventKind::note, "studio", told.toStdString());
        emit trouble(told);
    }
    return {};
}

void Desk::restore() {
    if (!recovery_ || !file_) return;
    project_ = std::move(recovery_->project);
    recovery_.reset();
    restored_ = true;
    undo_.clear();
    note(EventKind::note, "studio", "unsaved edits of an earlier session restored");
    changed();
}

void Desk::forget_recovery() {
    recovery_.reset();
    if (!file_) return;
    if (modified())
        recovery_writer_.write(project_);
    else
        recovery_writer_.clear();
}

Expected<void> Desk::save() {
    if (!file_) return usage_error("no project is open", {}, "open or make one");
    // An older state left behind by a crash after the save would be offered as unsaved edits; one that equals
    // what was saved is not.
    keep_newest();
    SEAM_OK(file_->save(project_));
    restored_ = false;
    undo_.setClean();
    drop_kept();
    if (modified() != was_modified_) emit modified_changed(was_modified_ = modified());
    return {};
}

Expected<void> Desk::save_as(const std::filesystem::path& path) {
    if (!file_) return usage_error("no project is open", {}, "open or make one");
    if (path == file_->path()) return save();
    if (worker_.busy())
        return usage_error("a measurement is running", path.string(), "wait for its end or cancel it");
    SEAM_TRY(auto use, FileUse::take(path, FileUse::For::desk));
    keep_newest();
    // The old file keeps what was saved there; runs go along.
    const auto target = behind_links(path);
    const auto part = std::filesystem::path(target.string() + ".part");
    std::error_code failed;
    SEAM_OK(file_->copy_to(part));
    {
        SEAM_TRY(auto copy, ProjectFile::open(part));
        if (signed_in_) SEAM_OK(copy.act_for(*signed_in_));
        SEAM_OK(copy.save(project_));
    }
    discard_recovery(path);  // of a file that is replaced; must not meet the one that takes its name
    std::filesystem::rename(part, target, failed);
    if (failed) return file_error(Text("the file cannot be replaced: {}", failed.message()), path.string());
    drop_kept();
    recovery_writer_.flush();
    if (auto copied = CalibrationSession::copy_all(file_->path(), path); !copied)
        emit trouble(shown_error(copied.error()));
    SEAM_TRY(auto file, ProjectFile::open(path));
    if (signed_in_) SEAM_OK(file.act_for(*signed_in_));
    const std::string spot = selection_.spot(), region = selection_.region();
    const bool connected = state_->connected;
    recovery_.reset();
    take_over(std::move(file), project_);
    use_ = std::move(use);
    selection_.select_spot(spot);
    selection_.select_region(region);
    if (connected) worker_.connect_devices();
    return {};
}

void Desk::close() {
    sign_out("signed out: the project was closed");
    worker_.close();
    drop_kept();
    recovery_writer_.close();
    file_.reset();
    use_.reset();
    recovery_.reset();
    project_ = {};
    facts_ = {};
    undo_.clear();
    restored_ = false;
    derive();
    emit opened();
    emit project_changed();
}

// --------------------------------------------------------------------------------------------------- who

bool Desk::asks_who() const {
    return !users().empty();
}

std::vector<User> Desk::users() const {
    if (!file_) return {};
    auto users = file_->users();
    return users ? std::move(*users) : std::vector<User>{};
}

Expected<void> Desk::sign_in(const std::string& name, const std::string& password) {
    if (!file_) return usage_error("no project is open", {}, "open or make one");
    SEAM_TRY(auto signed_in, file_->sign_in(name, password));
    person_ = signed_in.person();
    signed_in_ = std::move(signed_in);
    worker_.act_for(signed_in_);
    emit person_changed();
    emit events_changed();
    return {};
}

void Desk::sign_out(const Text& why) {
    if (!person_) return;
    worker_.act_for(std::nullopt);
    if (file_)
        if (auto out = file_->sign_out(why); !out) {
            file_->forget_person();
            emit trouble(shown_error(out.error()));
        }
    person_.reset();
    signed_in_.reset();
    emit person_changed();
    emit events_changed();
}

Expected<void> Desk::may(Deed deed) const {
    if (!file_) return {};
    return file_->may(deed);
}

// ------------------------------------------------------------------------------------------------- edits

void Desk::push(std::unique_ptr<DeskCommand> edit) {
    if (!together_) return undo_.push(edit.release());
    edit->apply(project_);
    together_->push_back(std::move(edit));
}

Expected<void> Desk::together(const QString& text, const std::function<Expected<void>()>& edits) {
    together_.emplace();
    const Expected<void> done = edits();
    auto made = std::make_unique<CmdTogether>(editor(), std::move(*together_), text);
    together_.reset();
    made->revert(project_);
    if (done && !made->empty()) undo_.push(made.release());
    return done;
}

template <class T>
Expected<void> Desk::add(T thing, int at) {
    SEAM_OK(may(Deed::teach));
    SEAM_OK(check_id(thing.id));
    if (index_of<T>(project_, thing.id) >= 0)
        return input_error(Text("the name \"{}\" is used already", thing.id), {}, "choose another");
    SEAM_OK(valid<T>(project_, thing));
    const std::size_t size = list_of<T>(project_).size();
    const std::size_t where = at < 0 ? size : std::min(size, static_cast<std::size_t>(at));
    push(std::make_unique<CmdAdd<T>>(editor(), std::move(thing), where));
    return {};
}

template <class T>
Expected<void> Desk::remove(const std::string& id) {
    SEAM_OK(may(Deed::teach));
    const int at = index_of<T>(project_, id);
    if (at < 0) return input_error(Text("there is no \"{}\"", id));
    SEAM_OK(removable<T>(project_, id));
    push(std::make_unique<CmdRemove<T>>(editor(), project_, static_cast<std::size_t>(at)));
    return {};
}

template <class T>
Expected<void> Desk::rename(const std::string& from, const std::string& to) {
    SEAM_OK(may(Deed::teach));
    const int at = index_of<T>(project_, from);
    if (at < 0) return input_error(Text("there is no \"{}\"", from));
    if (from == to) return {};
    SEAM_OK(check_id(to));
    if (index_of<T>(project_, to) >= 0)
        return input_error(Text("the name \"{}\" is used already", to), {}, "choose another");
    const bool spot = std::is_same_v<T, Spot> && selection_.spot() == from;
    const bool region = std::is_same_v<T, Region> && selection_.region() == from;
    const bool sensor = std::is_same_v<T, SensorSetup> && selection_.sensor() == from;
    push(std::make_unique<CmdRename<T>>(editor(), static_cast<std::size_t>(at), from, to));
    if (spot) selection_.select_spot(to);
    if (region) selection_.select_region(to);
    if (sensor) selection_.select_sensor(to);
    return {};
}

template <class T>
Expected<void> Desk::move(const std::string& id, int to) {
    SEAM_OK(may(Deed::teach));
    const int at = index_of<T>(project_, id);
    if (at < 0) return input_error(Text("there is no \"{}\"", id));
    const int last = static_cast<int>(list_of<T>(project_).size()) - 1;
    to = std::clamp(to, 0, last);
    if (to == at) return {};
    push(std::make_unique<CmdMove<T>>(editor(), id, static_cast<std::size_t>(at),
                                      static_cast<std::size_t>(to)));
    return {};
}

template <class T>
Expected<void> Desk::edit(const T& after, const QString& what) {
    SEAM_OK(may(Deed::teach));
    const int at = index_of<T>(project_, after.id);
    if (at < 0) return input_error(Text("there is no \"{}\"", after.id));
    const T& before = list_of<T>(project_)[static_cast<std::size_t>(at)];
    if (to_json_document(before) == to_json_document(after)) return {};
    SEAM_OK(valid<T>(project_, after));
    push(std::make_unique<CmdEdit<T>>(editor(), before, after, static_cast<std::size_t>(at), what));
    return {};
}

template <class T>
std::string Desk::free_id(const std::string& prefix) const {
    for (int n = 1;; ++n) {
        std::string id = prefix + std::to_string(n);
        if (index_of<T>(project_, id) < 0) return id;
    }
}

#define SEAMWRIGHT_DESK_EDITS(T)                                                     \
    template Expected<void> Desk::add<T>(T, int);                                    \
    template Expected<void> Desk::remove<T>(const std::string&);                     \
    template Expected<void> Desk::rename<T>(const std::string&, const std::string&); \
    template Expected<void> Desk::move<T>(const std::string&, int);                  \
    template Expected<void> Desk::edit<T>(const T&, const QString&);                 \
    template std::string Desk::free_id<T>(const std::string&) const;
SEAMWRIGHT_DESK_EDITS(Spot)
SEAMWRIGHT_DESK_EDITS(Region)
SEAMWRIGHT_DESK_EDITS(SensorSetup)
SEAMWRIGHT_DESK_EDITS(RobotSetup)
#undef SEAMWRIGHT_DESK_EDITS
template Expected<void> Desk::add<Calibration>(Calibration, int);
template std::string Desk::free_id<Calibration>(const std::string&) const;

Expected<void> Desk::set_spot_enabled(const std::string& id, bool enabled) {
    const int at = index_of<Spot>(project_, id);
    if (at < 0) return input_error(Text("there is no spot \"{}\"", id));
    if (project_.spots[static_cast<std::size_t>(at)].enabled == enabled) return {};
    push(std::make_unique<CmdSpotEnable>(editor(), id, static_cast<std::size_t>(at), enabled));
    return {};
}

Expected<void> Desk::set_spot_field(const SpotId& id, const std::string& field, double value) {
    const Spot* spot = find_spot(project_, id.text());
    if (!spot) return input_error(Text("there is no spot \"{}\"", id.text()));
    Spot after = *spot;
    SEAM_OK(set_field(after, field, value));
    return edit(after, QString::fromStdString(field));
}

Expected<void> Desk::set_sensor_field(const SensorId& id, const std::string& field, double value) {
    const SensorSetup* sensor = find_sensor(project_, id.text());
    if (!sensor) return input_error(Text("there is no sensor \"{}\"", id.text()));
    SensorSetup after = *sensor;
    SEAM_OK(set_field(after, field, value));
    return edit(after, QString::fromStdString(field));
}

Expected<void> Desk::set_region_field(const RegionId& id, const std::string& field, double value) {
    const int at = index_of<Region>(project_, id.text());
    if (at < 0) return input_error(Text("there is no region \"{}\"", id.text()));
    Region after = project_.regions[static_cast<std::size_t>(at)];
    SEAM_OK(set_field(after, field, value));
    return edit(after, QString::fromStdString(field));
}

Expected<void> Desk::use_calibration(const SensorId& sensor_id, const CalibrationId& calibration_id) {
    const int at = index_of<SensorSetup>(project_, sensor_id.text());
    if (at < 0) return input_error(Text("there is no sensor \"{}\"", sensor_id.text()));
    const SensorSetup& sensor = project_.sensors[static_cast<std::size_t>(at)];
    if (sensor.calibration_id == calibration_id.text()) return {};
    SEAM_OK(calibration_use(project_, sensor_id.text(), calibration_id.text()));
    push(std::make_unique<CmdCalibrationUse>(editor(), sensor, static_cast<std::size_t>(at),
                                             calibration_id.text()));
    return {};
}

Expected<void> Desk::take_calibrations(std::vector<Calibration> made, bool use) {
    QStringList ids;
    for (const Calibration& c : made) ids << QString::fromStdString(c.id);
    const QString text =
        ids.size() == 1 ? use ? DeskCommand::tr("Use calibration %1") : DeskCommand::tr("Keep calibration %1")
        : use ? DeskCommand::tr("Use calibrations %1")
                        : DeskCommand::tr("Keep calibrations %1");
    return together(text.arg(ids.join(", ")), [&]() -> Expected<void> {
        for (Calibration& c : made) {
            const std::string id = c.id, sensor = c.sensor_id;
            SEAM_OK(add(std::move(c)));
            if (!use) continue;
            SEAM_OK(use_calibration(SensorId(sensor), CalibrationId(id)));
        }
        return {};
    });
}

Expected<void> Desk::edit_part(const PartSetup& after, const QString& text) {
    SEAM_OK(may(Deed::teach));
    if (to_json_document(project_.part) == to_json_document(after) &&
        project_.part.mesh_ply == after.mesh_ply)
        return {};
    SEAM_OK(pose_from_matrix(after.base_from_workobject.matrix(), "part"));
    push(std::make_unique<CmdPartEdit>(editor(), project_.part, after, text));
    return {};
}

void Desk::import_part(const std::filesystem::path& path, const std::string& unit,
                       std::function<void(const Expected<void>&)> told) {
    const auto read = [path, unit]() -> Expected<std::vector<std::byte>> {
        SEAM_TRY(const auto mesh, load_mesh(path, unit));
        return ply_bytes(mesh);
    };
    const auto take = [this, path](Expected<std::vector<std::byte>> ply) -> Expected<void> {
        if (!ply) return tl::unexpected(std::move(ply.error()));
        PartSetup after = project_.part;
        after.mesh_ply = std::move(*ply);
        after.mesh_source = path.string();
        if (after.name.empty()) after.name = path.stem().string();
        return edit_part(
            after, DeskCommand::tr("Import part %1").arg(QString::fromStdString(path.filename().string())));
    };
    import_.run(read, [take, told = std::move(told)](Expected<std::vector<std::byte>> ply) {
        told(take(std::move(ply)));
    });
}

Expected<void> Desk::rename_project(const std::string& name) {
    SEAM_OK(may(Deed::teach));
    if (name == project_.name) return {};
    push(std::make_unique<CmdProjectRename>(editor(), project_.name, name));
    return {};
}

Expected<void> Desk::set_requirement(const std::string& field, double value) {
    SEAM_OK(may(Deed::limits));
    Requirements after = project_.requirements;
    SEAM_OK(set_field(after, field, value));
    if (to_json_document(after) == to_json_document(project_.requirements)) return {};
    push(std::make_unique<CmdRequirementsEdit>(editor(), project_.requirements, after));
    return {};
}

Expected<void> Desk::edit_acceptance(const AcceptanceRequirements& after) {
    SEAM_OK(may(Deed::limits));
    if (after == project_.requirements.acceptance) return {};
    SEAM_OK(validate_fields(after));
    Requirements all = project_.requirements;
    all.acceptance = after;
    push(std::make_unique<CmdRequirementsEdit>(editor(), project_.requirements, all));
    return {};
}

Expected<void> Desk::edit_project(const std::function<void(Project&)>& change, const QString& text) {
    SEAM_OK(may(Deed::teach));
    Project after = project_;
    change(after);
    push(std::make_unique<CmdProjectReplace>(editor(), project_, std::move(after), text));
    return {};
}

Expected<std::vector<MovedSpot>> Desk::reteach(const Exchange& exchange) {
    SEAM_TRY(auto retaught, after_exchange(project_, exchange));
    push(std::make_unique<CmdProjectReplace>(editor(), project_, std::move(retaught.project),
                                             DeskCommand::tr("Take up again after an exchange")));
    return std::move(retaught.spots);
}

Expected<void> Desk::place_simulated_part(const Pose& displacement, double bend_mm, double twist_mm) {
    const nlohmann::json part = {
        {"displacement", pose_json(displacement)}, {"bend_mm", bend_mm}, {"twist_mm", twist_mm}};
    return together(DeskCommand::tr("Place the simulated part"), [&]() -> Expected<void> {
        const auto place = [&](auto all) -> Expected<void> {  // a copy: the edits change the list
            for (auto& setup : all) {
                if (!is_simulated_cell(setup.driver)) continue;
                setup.settings["part"] = part;
                SEAM_OK(edit(setup));
            }
            return {};
        };
        SEAM_OK(place(project_.sensors));
        return place(project_.robots);
    });
}

// ------------------------------------------------------------------------------------------ what is known

void Desk::take_identities(const StationState& state) {
    bool news = false;
    for (const SensorState& s : state.sensors)
        for (SensorSetup& setup : project_.sensors)
            if (setup.id == s.id && !(setup.identity == s.identity)) setup.identity = s.identity, news = true;
    for (const RobotState& r : state.robots)
        for (RobotSetup& setup : project_.robots)
            if (setup.id == r.id && !(setup.identity == r.identity)) setup.identity = r.identity, news = true;
    if (!news) return;
    // Who answered is no edit: nobody undoes it. It is saved with the next save, and the station knows it.
    worker_.use(project_);
    emit project_changed();
}

void Desk::set_recipes() {
    const Spot* selected = find_spot(project_, selection_.spot());
    for (const SensorSetup& sensor : project_.sensors) {
        LiveRecipe recipe;
        recipe.peaks = sensor.peaks;
        recipe.filter = sensor.filter;
        for (const Calibration& c : project_.calibrations)
            if (c.id == sensor.calibration_id) recipe.model = c.model;
        if (selected && selected->sensor_id == sensor.id) {
            recipe.feature = selected->feature;
            recipe.taught = selected->reference_profile;
            recipe.taught_at_mm = {selected->reference_mm.x(), selected->reference_mm.z()};
        }
        live_.set_recipe(sensor.id, recipe);
    }
}

void Desk::derive() {
    facts_.sensors.emplace();
    facts_.robots.emplace();
    for (const SensorState& s : state_->sensors)
        facts_.sensors->push_back({s.id, state_->connected, s.trouble});
    for (const RobotState& r : state_->robots) facts_.robots->push_back({r.id, state_->connected, r.trouble});
    if (file_)
        if (auto known = gather(*file_, facts_); !known) emit trouble(shown_error(known.error()));
    checks_ = checklist(project_, facts_);
    steps_ = steps_of(checks_, language_);
    emit checklist_changed();
}

// What another program, the headless runner, has put into the file.
void Desk::look_again() {
    if (!file_ || worker_.busy()) return;
    const auto newer = file_->evidence(facts_.evidence.empty() ? 0 : facts_.evidence.back().id);
    if (!newer || newer->empty()) return;
    derive();
    emit runs_changed();
    emit events_changed();
}

void Desk::set_language(Language language) {
    language_ = language;
    derive();
}

Expected<void> Desk::record(const Evidence& evidence) {
    if (!file_) return usage_error("no project is open", {}, "open or make one");
    SEAM_OK(file_->append_evidence(evidence, project_));
    derive();
    return {};
}

Expected<std::vector<RunSummary>> Desk::runs() const {
    if (!file_) return std::vector<RunSummary>{};
    return file_->runs();
}

Expected<RunRecord> Desk::run(std::int64_t number) const {
    if (!file_) return usage_error("no project is open");
    return file_->load_run(number, false);
}

Expected<std::vector<EventRecord>> Desk::events() const {
    if (!file_) return std::vector<EventRecord>{};
    return file_->events();
}

Expected<void> Desk::delete_run(std::int64_t number) {
    if (!file_) return usage_error("no project is open");
    auto deleted = file_->delete_run(number);
    derive();
    emit runs_changed();
    return deleted;
}

void Desk::note(EventKind kind, const std::string& subject, const Text& text) {
    if (!file_) return;
    if (auto id = file_->append_event({0, now_utc(), 0, kind, subject, text}); !id)
        emit trouble(shown_error(id.error()));
    emit events_changed();
}

}  // namespace seamwright
