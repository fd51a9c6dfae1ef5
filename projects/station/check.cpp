#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/correction/nuisance.h"
#include "core/features/kinds/feature_registry.h"
#include "devices/capture/capture.h"
#include "devices/line/line_link.h"
#include "devices/registry.h"
#include "devices/ur/program.h"
#include "projects/drift/drift_point.h"
#include "projects/gate/safety_gate.h"
#include "projects/measure/fields.h"
#include "projects/measure/measure.h"
#include "projects/model/part_types.h"
#include "projects/model/project.h"
#include "projects/station/acquire.h"
#include "projects/station/check.h"
#include "projects/station/light/spot_light.h"

namespace seamwright {
namespace {

constexpr double kSlowest_mm_s = 0.1;  // controllers take four decimals of m/s

// What a finding makes unsafe.
enum class Concern {
    setup,      // nothing by itself: the run says what it cannot do
    measuring,  // how the robot moves while it measures
    passing,    // where it is exposed in motion
    push        // what it does afterwards in the frames
};

class Findings {
  public:
    // What the findings from here on concern.
    void concern(Concern c) { concern_ = c; }
    void add(Text where, Text what, Text mend = {}) {
        add(Error{ErrorKind::input, std::move(what), std::move(where), std::move(mend)});
    }
    void add(Error error) { list.emplace_back(concern_, std::move(error)); }
    void unless(bool ok, const Text& where, Text what, Text mend = {}) {
        if (!ok) add(where, std::move(what), std::move(mend));
    }
    void rigid(const Pose& pose, const Text& where) {
        if (auto checked = pose_from_matrix(pose.matrix(), where.english(), 1e-6); !checked)
            add(checked.error());
    }
    std::vector<std::pair<Concern, Error>> list;

  private:
    Concern concern_ = Concern::setup;
};

template <class T>
void check_ids(const std::vector<T>& items, const char* kind, Findings& findings) {
    std::set<std::string> seen;
    for (const T& item : items) {
        findings.unless(!item.id.empty(), fmt::format("{}s", kind), Text("a {} has no id", kind),
                        "give it a name");
        findings.unless(seen.insert(item.id).second, fmt::format("{} {}", kind, item.id),
                        "the id is used twice", "rename one");
    }
}

template <class T>
bool known(const std::vector<T>& items, const std::string& id) {
    for (const T& item : items)
        if (item.id == id) return true;
    return false;
}

bool positive(double v) {
    return std::isfinite(v) && v > 0;
}

void check_profile(const Profile& profile, const Text& where, Findings& findings) {
    const std::size_t n = profile.x_mm.size();
    findings.unless(profile.z_mm.size() == n &&
                        (profile.intensity.empty() || profile.intensity.size() == n) &&
                        (profile.segment.empty() || profile.segment.size() == n),
                    where, "the columns of the profile differ in length");
}

void check_calibration(const Calibration& c, Findings& findings) {
    const Text where("calibration {}", c.id);
    findings.rigid(c.flange_from_sensor, joined(where, "", ".flange_from_sensor"));
    findings.unless(c.covariance.allFinite(), where,
                    "the covariance holds a value that is not a finite number");
    findings.unless(!c.covariance.allFinite() || correction::semidefinite(c.covariance), where,
                    "the covariance is none: not symmetric, or negative in some direction");
    if (!serves(c.verdict))
        findings.add(where,
                     Text("its verdict is {}, nothing measured with it can be pushed", name_of(c.verdict)),
                     "calibrate again");
    if (c.nozzle) {
        findings.rigid(c.nozzle->flange_from_nozzle, joined(where, "", ".nozzle.flange_from_nozzle"));
        findings.unless(
            correction::semidefinite(c.nozzle->covariance_mm2) && c.nozzle->degrees >= 1 &&
                c.nozzle->off_programmed_mm >= 0,
            where,
            "the covariance of the nozzle is none: not finite, not symmetric, or negative in some "
            "direction",
            "calibrate the nozzle again");
    }
    if (!c.model) return;
    findings.rigid(c.model->camera_from_laser, joined(where, "", ".camera_from_laser"));
    if (!c.model->table)
        findings.unless(positive(c.model->camera.fx) && positive(c.model->camera.fy), where,
                        "the camera's focal length is not positive");
}

void check_sensor(const Project& project, const SensorSetup& sensor, Findings& findings) {
    const Text where("sensor {}", sensor.id);
    findings.unless(!sensor.driver.empty(), where, "it has no driver", "choose one of `seamwright devices`");
    if (sensor.calibration_id.empty()) {
        findings.add(where, "it has no calibration, nothing measured with it can be pushed", "calibrate it");
        return;
    }
    for (const Calibration& c : project.calibrations) {
        if (c.id != sensor.calibration_id) continue;
        findings.unless(c.sensor_id.empty() || c.sensor_id == sensor.id, where,
                        Text("its calibration {} was made for sensor {}", c.id, c.sensor_id),
                        "calibrate this sensor");
        findings.unless(sensor.identity.serial.empty() || sensor.identity == c.sensor_identity, where,
                        Text("the connected sensor {} is not the one of calibration {} ({})",
                             sensor.identity.serial, c.id, c.sensor_identity.serial),
                        "calibrate again after exchanging a sensor");
        return;
    }
    findings.add(where, Text("its calibration \"{}\" is not in the project", sensor.calibration_id));
}

bool has_trigger_input(const std::string& driver) {
    const auto& drivers = sensor_drivers();
    const auto known =
        std::find_if(drivers.begin(), drivers.end(), [&](const auto& d) { return d.name == driver; });
    if (known == drivers.end()) return false;
    const SettingTable& settings = known->settings();
    return std::any_of(settings.begin(), settings.end(),
                       [](const SettingInfo& s) { return s.name == "hardware_trigger"; });
}

// The telegram of the robot's arrival, our answer and the camera's command take tens of milliseconds, each time others: at
// 100 mm/s millimetres of travel, which no jitter window covers unless it was measured so (measure_trigger.h sets the latency
// and the spots' jitter). A device of ours knows its own place.
// Only of sensors that a wire can fire: what a file or a session delivers was exposed where it says.
void check_trigger(const Project& project, const Spot& spot, const Text& where, Findings& findings) {
    const SensorSetup* sensor = find_sensor(project, spot.sensor_id);
    const RobotSetup* robot = find_robot(project, spot.robot_id);
    if (!sensor || !robot || !has_trigger_input(sensor->driver) || is_own_device(robot->driver)) return;
    if (spot.enabled) findings.concern(Concern::passing);
    findings.unless(
        spot.stop_at_trigger || hardware_triggered(*sensor) || robot->trigger_latency_ms != 0, where,
        Text(
            "its sensor {} is triggered by software while the robot passes: where it is exposed is not known",
            sensor->id),
        "wire the robot's output to the sensor and set \"hardware_trigger\", stand still at the trigger, or "
        "measure it "
        "(measure-trigger)");
}

// The program of Universal Robots stands at the entry. Another brand's runs through it at travelling speed.
void check_run_up(const Project& project, const Spot& spot, const Text& where, Findings& findings) {
    const RobotSetup* robot = find_robot(project, spot.robot_id);
    if (!robot || robot->driver != "ur-rtde" || !spot.enabled || spot.stop_at_trigger) return;
    const double needed_mm = spot.speed_mm_s * spot.speed_mm_s / (2 * kUrAcceleration_mm_s2);
    findings.unless(needed_mm <= spot.entry_mm, where,
                    Text("over an entry of {} mm the robot does not reach the speed of {} mm/s",
                         spot.entry_mm, spot.speed_mm_s),
                    Text("give an entry of {:.0f} mm or less speed", std::ceil(needed_mm)));
}

void check_spot(const Project& project, const Spot& spot, Findings& findings) {
    const Text where("spot {}", spot.id);
    findings.unless(known(project.sensors, spot.sensor_id), where,
                    Text("its sensor \"{}\" is not in the project", spot.sensor_id));
    findings.unless(known(project.robots, spot.robot_id), where,
                    Text("its robot \"{}\" is not in the project", spot.robot_id));
    if (spot.enabled) findings.concern(Concern::measuring);
    findings.rigid(spot.base_from_flange, joined(where, "", ".base_from_flange"));
    for (std::size_t i = 0; i < spot.via.size(); ++i)
        findings.rigid(spot.via[i], fmt::format("{}.via[{}]", where, i));
    findings.unless(spot.speed_mm_s >= kSlowest_mm_s && spot.speed_mm_s <= 5000, where,
                    Text("the speed of {} mm/s is not plausible ({}..5000)", spot.speed_mm_s, kSlowest_mm_s));
    findings.unless(std::isfinite(spot.entry_mm) && spot.entry_mm >= 0 && std::isfinite(spot.exit_mm) &&
                        spot.exit_mm >= 0 && spot.entry_mm <= 1000 && spot.exit_mm <= 1000,
                    where, "entry and exit must be between 0 and 1000 mm");
    check_trigger(project, spot, where, findings);
    findings.concern(Concern::setup);
    check_run_up(project, spot, where, findings);
    if (auto finder = make_feature_finder(spot.feature); !finder)
        findings.add(joined(where, "", ".feature"), finder.error().what, finder.error().mend);
    findings.unless(spot.reference_mm.allFinite(), where, "the reference is not a finite point",
                    "teach it again");
    findings.unless(spot.weights.allFinite() && spot.weights.minCoeff() >= 0, where,
                    "the weights must be finite and not negative");
    findings.unless(spot.weights.maxCoeff() > 0, where, "no direction has a weight",
                    "give x or z the weight 1");
    findings.unless(positive(spot.sigma_mm) && spot.sigma_mm <= 10, where,
                    Text("sigma of {} mm is not plausible (0..10)", spot.sigma_mm));
    findings.unless(std::isfinite(spot.jitter_mm) && spot.jitter_mm >= 0 && spot.jitter_mm <= 100, where,
                    Text("the jitter window of {} mm is not plausible (0..100)", spot.jitter_mm));
    check_profile(spot.reference_profile, joined(where, "", ".reference_profile"), findings);
    check_profile(spot.feature.template_profile, joined(where, "", ".template_profile"), findings);
    if (const SensorSetup* sensor = find_sensor(project, spot.sensor_id))
        if (auto sound = check_light(spot, *sensor); !sound) findings.add(sound.error());
    if (spot.curve)
        findings.unless(spot.curve->x_coefficients.allFinite() && spot.curve->z_coefficients.allFinite() &&
                            spot.curve->valid_from_mm <= spot.curve->valid_to_mm,
                        where, "the contour curve is not usable", "teach it again");
    bool used = false;
    for (const Region& region : project.regions)
        for (const std::string& id : region.spot_ids) used = used || id == spot.id;
    // What the drift watch looks at stands still: no region may use it.
    used = used || is_drift_reference(project, spot);
    findings.unless(used || !spot.enabled, where, "no region uses it", "add it to a region or switch it off");
}

// One part is of one type.
Expected<void> not_both_write(const Region& other, const Region& region) {
    if (other.type_id != region.type_id || !same_frame(other.frame_name, region.frame_name)) return {};
    return input_error(Text("region {} writes the same frame {}", other.id, other.frame_name),
                       Text("region {}", region.id), "give each region its own frame");
}

void check_region(const Project& project, const Region& region, Findings& findings) {
    const Text where("region {}", region.id);
    std::set<std::string> seen;
    int enabled = 0;
    std::set<std::string> robots;
    double observed = 0;
    for (const std::string& id : region.spot_ids) {
        findings.unless(seen.insert(id).second, where, Text("spot {} is named twice", id));
        const Spot* spot = find_spot(project, id);
        if (!spot) {
            findings.add(where, Text("spot \"{}\" is not in the project", id));
            continue;
        }
        findings.unless(spot->enabled || !spot->required, where,
                        Text("its required spot {} is switched off", id));
        if (!spot->enabled) continue;
        ++enabled;
        robots.insert(spot->robot_id);
        for (int axis = 0; axis < 3; ++axis) observed += spot->weights[axis] > 0;
    }
    const auto free = std::count(region.free.begin(), region.free.end(), true);
    findings.unless(free > 0, where, "no degree of freedom is free");
    findings.unless(enabled > 0, where, "it has no enabled spot");
    if (enabled > 0)
        findings.unless(
            observed >= static_cast<double>(free), where,
            Text("{} observed coordinates cannot determine {} degrees of freedom", observed, free),
            "add spots in other orientations");
    findings.concern(Concern::push);
    findings.unless(robots.size() <= 1, where,
                    "its spots belong to several robots, one frame cannot serve them",
                    "make one region per robot");
    for (const Text& none : limits_that_are_none(region)) findings.add(where, none);
    findings.unless(!region.frame_name.empty(), where,
                    "it names no frame on the controller, nothing can be pushed");
    findings.rigid(region.base_from_frame, joined(where, "", ".base_from_frame"));
    for (const Region& other : project.regions) {
        if (&other == &region) break;
        if (auto own = not_both_write(other, region); !own) findings.add(own.error());
    }
    findings.concern(Concern::setup);
}

void check_place(const Project& project, const PanelJob& job, const PanelPlace& place, Findings& findings) {
    const Text where("panel job {}, place {}", job.id, place.id);
    findings.unless(known(project.sensors, place.sensor_id), where,
                    Text("its sensor \"{}\" is not in the project", place.sensor_id));
    findings.unless(place.second_sensor_id.empty() || known(project.sensors, place.second_sensor_id), where,
                    Text("its second sensor \"{}\" is not in the project", place.second_sensor_id));
    findings.unless(place.second_sensor_id != place.sensor_id, where, "both its heads are the same sensor",
                    "a double head has two sensors");
    if (auto good = check(place.gauge); !good)
        findings.add(joined(where, "", ".gauge"), good.error().what, good.error().mend);
    findings.concern(Concern::push);
    findings.unless(place.panel_reference_mm.allFinite() && place.body_reference_mm.allFinite() &&
                        std::isfinite(place.gap_mm) && std::isfinite(place.flush_mm) &&
                        std::isfinite(place.surface_deg),
                    where, "what was taught is not finite", "teach it again");
    findings.unless(
        place.weights.allFinite() && place.weights.minCoeff() >= 0 && place.weights.maxCoeff() > 0, where,
        "the weights must be finite, not negative, and one of them positive");
    findings.unless(positive(place.sigma_mm) && place.sigma_mm <= 10, where,
                    Text("sigma of {} mm is not plausible (0..10)", place.sigma_mm));
    findings.concern(Concern::setup);
    check_profile(place.reference_profile, joined(where, "", ".reference_profile"), findings);
}

void check_panel_job(const Project& project, const PanelJob& job, Findings& findings) {
    const Text where("panel job {}", job.id);
    findings.unless(known(project.robots, job.robot_id), where,
                    Text("its robot \"{}\" is not in the project", job.robot_id));
    std::set<std::string> seen, sensors;
    int enabled = 0;
    for (const PanelPlace& place : job.places) {
        findings.unless(!place.id.empty() && seen.insert(place.id).second, where,
                        Text("place \"{}\" has no name of its own", place.id));
        findings.unless(place.enabled || !place.required, where,
                        Text("its required place {} is switched off", place.id));
        enabled += place.enabled;
        for (const std::string& id : {place.sensor_id, place.second_sensor_id})
            findings.unless(id.empty() || !place.enabled || sensors.insert(id).second, where,
                            Text("sensor {} is used at two places", id), "a sensor sees one place");
        check_place(project, job, place, findings);
    }
    findings.unless(enabled >= 3, where, Text("{} enabled places do not determine a motion", enabled),
                    "measure at three or more places in different orientations");
    findings.concern(Concern::push);
    for (const Field<PanelJob>& f : panel_fields())
        if (auto valid = validate({{f.info.name, f.get(job)}}, {f.info}, where); !valid)
            findings.add(valid.error());
    findings.unless(!job.frame_name.empty(), where,
                    "it names no frame on the controller, nothing can be moved");
    findings.rigid(job.base_from_frame, joined(where, "", ".base_from_frame"));
    for (const Region& region : project.regions)
        findings.unless(!same_frame(region.frame_name, job.frame_name), where,
                        Text("region {} writes the same frame {}", region.id, job.frame_name));
    for (const PanelJob& other : project.panel_jobs) {
        if (other.id == job.id) break;
        findings.unless(!same_frame(other.frame_name, job.frame_name), where,
                        Text("panel job {} writes the same frame {}", other.id, job.frame_name));
    }
    findings.concern(Concern::measuring);
    findings.rigid(job.base_from_gripper, joined(where, "", ".base_from_gripper"));
    findings.concern(Concern::setup);
}

// Those that a run must not begin with.
std::vector<Error> of_motion(Findings&& findings, bool push, bool passes = true) {
    std::vector<Error> list;
    for (auto& [concern, error] : findings.list)
        if (concern == Concern::measuring || (passes && concern == Concern::passing) ||
            (push && concern == Concern::push))
            list.push_back(std::move(error));
    return list;
}

}  // namespace

Expected<void> frame_of_its_own(const Project& project, const Region& region) {
    for (const Region& other : project.regions)
        if (other.id != region.id) SEAM_OK(not_both_write(other, region));
    for (const PanelJob& job : project.panel_jobs)
        if (same_frame(job.frame_name, region.frame_name))
            return input_error(Text("panel job {} writes the same frame {}", job.id, job.frame_name),
                               Text("region {}", region.id), "give each region its own frame");
    return {};
}

std::vector<Error> motion_findings(const Project& project, bool push) {
    Findings findings;
    findings.concern(Concern::push);
    findings.unless(!project.regions.empty() || references_alone(project), "regions",
                    "the project has no region, nothing can be pushed", "make a region of the spots");
    findings.rigid(project.part.base_from_workobject, "part.base_from_workobject");
    if (auto valid = validate_fields(project.requirements); !valid) findings.add(valid.error());
    findings.concern(Concern::setup);
    for (const Spot& spot : project.spots) check_spot(project, spot, findings);
    for (const Region& region : project.regions) check_region(project, region, findings);
    return of_motion(std::move(findings), push);
}

std::vector<Error> standing_findings(const Project& project) {
    Findings findings;
    for (const Spot& spot : project.spots) check_spot(project, spot, findings);
    return of_motion(std::move(findings), false, false);
}

std::vector<Error> motion_findings(const Project& project, const PanelJob& job, bool push) {
    Findings findings;
    check_panel_job(project, job, findings);
    return of_motion(std::move(findings), push);
}

Expected<std::string> runnable_type(const Project& project, const std::string& id_or_number, bool push) {
    SEAM_TRY(auto type, called_type(project, id_or_number));
    if (type.empty()) return type;
    const Project one = of_type(project, type);
    if (std::ranges::none_of(one.spots, &Spot::enabled))
        return input_error("no spot of it is enabled", Text("part type {}", type),
                           "teach a spot of it first");
    if (auto sound = none_of_motion(motion_findings(one, push)); !sound) {
        Error error = sound.error();
        error.within(Text("part type {}", type));
        return tl::unexpected(std::move(error));
    }
    return type;
}

Expected<void> none_of_motion(const std::vector<Error>& findings) {
    if (findings.empty()) return {};
    Error error = findings.front();
    if (findings.size() > 1)
        error.what = Text("{} (and {} more findings, see check)", error.what, findings.size() - 1);
    return tl::unexpected(std::move(error));
}

namespace {
// In a project with types nothing that belongs to none is ever run.
void check_types(const Project& project, Findings& findings) {
    if (auto sound = check_part_types(project); !sound) findings.add(sound.error());
    if (project.part_types.empty()) return;
    const auto owned = [&](const auto& items, const char* kind) {
        for (const auto& item : items)
            findings.unless(!item.type_id.empty(), Text::chosen(kind, item.id),
                            "it is of no part type, and is not run: the project has several kinds of parts",
                            "seamwright type take FILE.seam TYPE ID");
    };
    owned(project.spots, "spot {}");
    owned(project.regions, "region {}");
}

void check_line(const LineSetup& link, Findings& findings) {
    const LineProtocol* protocol = line_protocol(link.protocol);
    if (!protocol)
        return findings.add(Text("line {}", link.id),
                            Text("there is no protocol \"{}\" of a line", link.protocol),
                            "choose one of `seamwright devices`");
    if (auto valid = check_settings(link.settings, "settings", protocol->settings()); !valid) {
        Error error = valid.error();
        error.within(Text("line {}", link.id));
        findings.add(std::move(error));
    }
}
}  // namespace

std::vector<Error> check(const Project& project) {
    Findings findings;
    check_ids(project.sensors, "sensor", findings);
    check_ids(project.robots, "robot", findings);
    check_ids(project.calibrations, "calibration", findings);
    check_ids(project.spots, "spot", findings);
    check_ids(project.regions, "region", findings);
    findings.rigid(project.part.base_from_workobject, "part.base_from_workobject");
    if (auto valid = validate_fields(project.requirements); !valid) findings.add(valid.error());
    for (const SensorSetup& sensor : project.sensors) check_sensor(project, sensor, findings);
    for (const RobotSetup& robot : project.robots)
        findings.unless(!robot.driver.empty(), Text("robot {}", robot.id), "it has no driver",
                        "choose one of `seamwright devices`");
    for (const RobotSetup& robot : project.robots)
        findings.unless(correction::semidefinite(robot.arrival_covariance), Text("robot {}", robot.id),
                        "the covariance of its arrivals is none: not finite, not symmetric, or negative in "
                        "some direction");
    for (const RobotSetup& robot : project.robots)
        findings.unless(
            std::abs(robot.trigger_latency_ms) <= 10000, Text("robot {}", robot.id),
            Text("the trigger's latency of {} ms is not plausible (10 s at most)", robot.trigger_latency_ms),
            "measure it: seamwright measure-trigger");
    for (const RobotSetup& robot : project.robots)
        for (const std::string& utc : robot.collisions)
            findings.unless(utc_seconds(utc).has_value(), Text("robot {}", robot.id),
                            Text("the date of its collision, \"{}\", is none", utc),
                            "mark it again: seamwright collision");
    for (const Calibration& calibration : project.calibrations) check_calibration(calibration, findings);
    for (const Spot& spot : project.spots) check_spot(project, spot, findings);
    for (const Region& region : project.regions) check_region(project, region, findings);
    check_ids(project.panel_jobs, "panel job", findings);
    for (const PanelJob& job : project.panel_jobs) check_panel_job(project, job, findings);
    check_ids(project.line, "line link", findings);
    for (const LineSetup& link : project.line) check_line(link, findings);
    check_types(project, findings);
    if (project.drift)
        if (auto sound = check_drift_watch(project, *project.drift); !sound) findings.add(sound.error());
    std::vector<Error> list;
    for (auto& [concern, error] : findings.list) list.push_back(std::move(error));
    return list;
}

}  // namespace seamwright
