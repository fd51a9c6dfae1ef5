// Edits: each is validated, one step of undo, or an Error and nothing.

#include <algorithm>

#include "devices/exchange/pose_json.h"
#include "devices/registry.h"
#include "devices/simulated/scene/mesh_file.h"
#include "projects/calibrate/session/session.h"
#include "projects/calibrate/session/use.h"
#include "projects/file/id_length.h"
#include "projects/file/project_json.h"
#include "projects/measure/fields.h"
#include "projects/measure/measure.h"
#include "projects/station/check.h"
#include "widgets/desk/desk.h"
#include "widgets/shown_text.h"

namespace seamwright {
namespace {

Expected<void> check_id(const std::string& id) {
    if (id.empty()) return input_error("the name is empty", {}, "give it a name");
    if (is_too_long(id)) return input_error("the name is longer than 64 signs", {}, "shorten it");
    return {};
}

// As the file asks for it with the next save.
template <class T>
constexpr Deed kDeedOf = std::is_same_v<T, Region> ? Deed::limits : Deed::teach;

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

// Of what is named newly: a project that came with it is told by check(), and its other edits are free.
template <class T>
Expected<void> frame_is_free(const Project&, const T&, const T* = nullptr) {
    return {};
}
template <>
Expected<void> frame_is_free<Region>(const Project& project, const Region& region, const Region* before) {
    if (before && before->frame_name == region.frame_name) return {};
    return frame_of_its_own(project, region);
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

}  // namespace

Editor Desk::editor() {
    return [this](const std::function<void(Project&)>& change) {
        change(project_);
        changed();
    };
}

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
    SEAM_OK(may(kDeedOf<T>));
    SEAM_OK(check_id(thing.id));
    if (index_of<T>(project_, thing.id) >= 0)
        return input_error(Text("the name \"{}\" is used already", thing.id), {}, "choose another");
    SEAM_OK(valid<T>(project_, thing));
    SEAM_OK(frame_is_free<T>(project_, thing));
    const std::size_t size = list_of<T>(project_).size();
    const std::size_t where = at < 0 ? size : std::min(size, static_cast<std::size_t>(at));
    push(std::make_unique<CmdAdd<T>>(editor(), std::move(thing), where));
    return {};
}

template <class T>
Expected<void> Desk::remove(const std::string& id) {
    SEAM_OK(may(kDeedOf<T>));
    const int at = index_of<T>(project_, id);
    if (at < 0) return input_error(Text("there is no \"{}\"", id));
    SEAM_OK(removable<T>(project_, id));
    push(std::make_unique<CmdRemove<T>>(editor(), project_, static_cast<std::size_t>(at)));
    return {};
}

// What was captured of a device lies beside the project under its name.
template <class T>
void Desk::device_renamed(const std::string& from, const std::string& to) {
    Expected<void> followed;
    if constexpr (std::is_same_v<T, SensorSetup>) {
        std::vector<std::string> others;
        for (const SensorSetup& s : project_.sensors)
            if (s.id != from && s.id != to) others.push_back(s.id);
        followed = CalibrationSession::rename_sensor(path(), from, to, others);
        emit sensor_renamed(from, to);
    } else {
        followed = CalibrationSession::rename_robot(path(), from, to);
        emit robot_renamed(from, to);
    }
    if (!followed) emit trouble(shown_error(followed.error()));
}

template <class T>
Expected<void> Desk::rename(const std::string& from, const std::string& to) {
    SEAM_OK(may(kDeedOf<T>));
    const int at = index_of<T>(project_, from);
    if (at < 0) return input_error(Text("there is no \"{}\"", from));
    if (from == to) return {};
    SEAM_OK(check_id(to));
    if (index_of<T>(project_, to) >= 0)
        return input_error(Text("the name \"{}\" is used already", to), {}, "choose another");
    const bool spot = std::is_same_v<T, Spot> && selection_.spot() == from;
    const bool region = std::is_same_v<T, Region> && selection_.region() == from;
    const bool sensor = std::is_same_v<T, SensorSetup> && selection_.sensor() == from;
    typename CmdRename<T>::Told told;
    if constexpr (std::is_same_v<T, SensorSetup> || std::is_same_v<T, RobotSetup>)
        told = [this](const std::string& old_name, const std::string& new_name) {
            device_renamed<T>(old_name, new_name);
        };
    push(std::make_unique<CmdRename<T>>(editor(), static_cast<std::size_t>(at), from, to, std::move(told)));
    if (spot) selection_.select_spot(to);
    if (region) selection_.select_region(to);
    if (sensor) selection_.select_sensor(to);
    return {};
}

template <class T>
Expected<void> Desk::move(const std::string& id, int to) {
    SEAM_OK(may(kDeedOf<T>));
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
    SEAM_OK(may(kDeedOf<T>));
    const int at = index_of<T>(project_, after.id);
    if (at < 0) return input_error(Text("there is no \"{}\"", after.id));
    const T& before = list_of<T>(project_)[static_cast<std::size_t>(at)];
    if (to_json_document(before) == to_json_document(after)) return {};
    SEAM_OK(valid<T>(project_, after));
    SEAM_OK(frame_is_free<T>(project_, after, &before));
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
    SEAM_OK(may(Deed::teach));
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
    SEAM_OK(may(Deed::teach));
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
    if (const auto allowed = may(Deed::teach); !allowed) return told(allowed);
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
    SEAM_OK(may(Deed::teach));
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

}  // namespace seamwright
