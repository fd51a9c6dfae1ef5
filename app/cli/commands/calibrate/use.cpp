// seamwright use: a stored calibration put in use at its sensor, as the desk's Calibrate page does.

#include <fmt/format.h>

#include <algorithm>

#include "app/cli/arguments/calibration_argument.h"
#include "app/cli/command.h"
#include "app/cli/sign_in.h"
#include "projects/calibrate/session/use.h"
#include "projects/file/project_file.h"
#include "projects/measure/measure.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct UseArguments {
    std::string file, calibration, calibration_id, sensor;
    bool list = false, none = false;
};

const Calibration* find_calibration(const Project& project, const std::string& id) {
    const auto at = std::find_if(project.calibrations.begin(), project.calibrations.end(),
                                 [&](const Calibration& c) { return c.id == id; });
    return at == project.calibrations.end() ? nullptr : &*at;
}

Answer list(const Project& project) {
    Answer answer;
    answer.json = {{"status", "ok"}, {"calibrations", json::array()}, {"sensors", json::array()}};
    for (const Calibration& c : project.calibrations) {
        const SensorSetup* sensor = find_sensor(project, c.sensor_id);
        const bool used = sensor && sensor->calibration_id == c.id;
        // As the desk says on the calibration's card: it was made with another device than is there.
        const bool other =
            sensor && !sensor->identity.serial.empty() && !(sensor->identity == c.sensor_identity);
        answer.json["calibrations"].push_back({{"id", c.id},
                                               {"sensor", c.sensor_id},
                                               {"robot", c.robot_id},
                                               {"method", c.method},
                                               {"verdict", name_of(c.verdict)},
                                               {"created_utc", c.created_utc},
                                               {"source", c.source},
                                               {"in_use", used},
                                               {"other_device", other}});
        answer.text += fmt::format("{} {:<18} sensor {:<8} {:<13} {:<12} {}{}\n", used ? "*" : " ", c.id,
                                   c.sensor_id, c.method, name_of(c.verdict), c.created_utc,
                                   other ? "  made with another device: pushes are refused" : "");
    }
    for (const SensorSetup& s : project.sensors) {
        answer.json["sensors"].push_back(
            {{"id", s.id}, {"calibration", s.calibration_id.empty() ? json() : json(s.calibration_id)}});
        if (s.calibration_id.empty()) answer.text += fmt::format("sensor {}: no calibration in use\n", s.id);
    }
    if (project.calibrations.empty()) answer.text += "the project holds no calibration\n";
    return answer;
}

// Of another file, as one more of the project; its id is free there.
Expected<std::string> take(Project& project, const UseArguments& a) {
    SensorSetup* sensor = nullptr;
    for (SensorSetup& s : project.sensors)
        if (s.id == a.sensor || (a.sensor.empty() && project.sensors.size() == 1)) sensor = &s;
    if (!sensor)
        return usage_error(a.sensor.empty() ? Text("the project has {} sensors", project.sensors.size())
                                            : Text("the project has no sensor \"{}\"", a.sensor),
                           "--sensor", "say which one the calibration is of");
    const Calibration* base = calibration_of(project, sensor->id);
    SEAM_TRY(auto c, read_calibration(a.calibration, a.calibration_id, base));
    // What a project stores says of which devices it is; the gate compares them with those that are there.
    const bool stored = !c.sensor_id.empty();
    c.sensor_id = sensor->id;
    if (!stored) {
        c.sensor_identity = sensor->identity;
        const RobotSetup* robot = base ? find_robot(project, base->robot_id) : nullptr;
        if (!robot && project.robots.size() == 1) robot = &project.robots.front();
        if (robot) {
            c.robot_id = robot->id;
            c.robot_identity = robot->identity;
        }
    } else if (!find_robot(project, c.robot_id) && project.robots.size() == 1) {
        c.robot_id = project.robots.front().id;
    }
    const std::string wanted = c.id;
    for (int n = 2; find_calibration(project, c.id); ++n) c.id = fmt::format("{}-{}", wanted, n);
    project.calibrations.push_back(std::move(c));
    return project.calibrations.back().id;
}

bool names_a_file(const std::string& calibration) {
    return calibration.ends_with(".seam") || calibration.ends_with(".json") || calibration.ends_with(".lut");
}

// How it is taken back.
std::string undo_of(const UseArguments& a, const CalibrationUse& use) {
    return use.before.empty() ? fmt::format("seamwright use {} --none --sensor {}", a.file, use.sensor_id)
                              : fmt::format("seamwright use {} --calibration {}", a.file, use.before);
}

Answer told(const UseArguments& a, const CalibrationUse& use, const Calibration* in_use) {
    Answer answer;
    const bool changed = use.before != use.after;
    answer.json = {{"status", changed ? "changed" : "unchanged"},
                   {"sensor", use.sensor_id},
                   {"before", use.before.empty() ? json() : json(use.before)},
                   {"calibration", use.after.empty() ? json() : json(use.after)},
                   {"verdict", in_use ? json(name_of(in_use->verdict)) : json()},
                   {"working_point_mm", use.difference ? json(use.working_point_mm) : json()},
                   {"spots", json::array()},
                   {"undo", changed ? json(undo_of(a, use)) : json()}};
    answer.text = fmt::format("sensor {}: {} in use", use.sensor_id,
                              use.after.empty() ? "no calibration" : "calibration " + use.after);
    if (!changed) {
        answer.text += " already\n";
        return answer;
    }
    answer.text += use.before.empty() ? "\n" : fmt::format(" instead of {}\n", use.before);
    if (const auto& d = use.difference) {
        answer.json["difference"] = {{"largest_mm", d->largest_mm},
                                     {"mean_mm", d->mean_mm},
                                     {"shift_mm", d->shift_mm},
                                     {"turn_deg", d->turn_deg},
                                     {"points", d->points}};
        answer.text += d->points == 0
                           ? "  the two see nothing in common\n"
                           : fmt::format(
                                 "  the same point lies up to {:.3f} mm elsewhere on the flange (mean {:.3f} "
                                 "mm); sensor shifted {:.3f} mm, turned {:.4f} deg\n",
                                 d->largest_mm, d->mean_mm, d->shift_mm, d->turn_deg);
    }
    for (const MovedWorkingPoint& s : use.spots) {
        answer.json["spots"].push_back({{"id", s.spot_id}, {"moved_mm", s.moved_mm}});
        answer.text += fmt::format("  spot {:<12} working point moves {:.3f} mm\n", s.spot_id, s.moved_mm);
    }
    answer.text += "  what was proven with the one before is stale: see `seamwright check`\n";
    answer.text += fmt::format("  back: {}\n", undo_of(a, use));
    return answer;
}

Expected<Answer> use_command(const UseArguments& a) {
    if (a.list || (a.calibration.empty() && !a.none)) {
        SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
        SEAM_TRY(const auto project, file.load());
        return list(project);
    }
    SEAM_TRY(auto file, open_to_edit(a.file));
    SEAM_TRY(auto project, file.load());
    std::string id = a.none ? "" : a.calibration, sensor = a.sensor;
    if (!a.none && !find_calibration(project, id) && names_a_file(id)) {
        SEAM_TRY(id, take(project, a));
    } else if (!a.calibration_id.empty()) {
        return usage_error("it names one of another file", "--calibration-id",
                           "give --calibration FILE with it");
    }
    if (sensor.empty()) {
        const Calibration* c = find_calibration(project, id);
        if (!a.none && !c)
            return input_error(Text("there is no calibration \"{}\"", id), a.file, "see --list");
        if (a.none && project.sensors.size() != 1)
            return usage_error(Text("the project has {} sensors", project.sensors.size()), "--none",
                               "say which one with --sensor");
        sensor = c ? c->sensor_id : project.sensors.front().id;
    }
    SEAM_TRY(const auto use, calibration_use(project, sensor, id));
    for (SensorSetup& s : project.sensors)
        if (s.id == sensor) s.calibration_id = id;
    if (use.before != use.after) {
        SEAM_OK(file.save(project));
        const Text note = id.empty() ? Text("no calibration in use any more, before: {}", use.before)
                                     : Text("calibration {} in use, before: {}", id,
                                            use.before.empty() ? Text("none") : Text(use.before));
        SEAM_OK(file.append_event({0, {}, 0, EventKind::note, sensor, note}));
    }
    return told(a, use, calibration_of(project, sensor));
}

}  // namespace

void add_use(CommandLine& line) {
    auto a = std::make_shared<UseArguments>();
    CLI::App* command = line.add(
        "use",
        "Put a stored calibration in use at its sensor, and say how far the working points move. Without "
        "--calibration\nthe list. One of another project, an answer of `calibrate` or a table is kept in the "
        "project "
        "first. A calibration\nthat is poor or undetermined is refused. The spots stay as taught: after an "
        "exchange of "
        "the sensor see `reteach`.",
        "seamwright use door_left.seam --list\n"
        "  seamwright use door_left.seam --calibration tcp-sphere-2\n"
        "  seamwright use door_left.seam --calibration other.seam --calibration-id tcp-sphere-4 --sensor A\n"
        "  seamwright use door_left.seam --none --sensor A");
    command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    add_sign_in(command);
    auto* calibration =
        command
            ->add_option("--calibration", a->calibration,
                         "Which: its id, or a file to take it from (.seam, .json of `calibrate`, .lut)")
            ->type_name("ID|FILE");
    command->add_option("--calibration-id", a->calibration_id, "Which of the other project's calibrations")
        ->type_name("ID")
        ->needs(calibration);
    command->add_option("--sensor", a->sensor, "At which sensor (the calibration's own)")->type_name("ID");
    auto* none = command->add_flag("--none", a->none, "No calibration is in use any more");
    none->excludes(calibration);
    command->add_flag("--list", a->list, "The stored calibrations; * is in use")
        ->excludes(calibration)
        ->excludes(none);
    line.on(command, [a] { return use_command(*a); });
}

}  // namespace seamwright::cli
