#include <fmt/format.h>

#include <cmath>
#include <set>

#include "projects/fields.h"
#include "projects/measure.h"
#include "projects/project.h"

namespace seamwright {
namespace {

class Findings {
  public:
    void add(std::string where, std::string what, std::string mend = {}) {
        list.push_back(Error{ErrorKind::input, std::move(what), std::move(where), std::move(mend)});
    }
    void unless(bool ok, const std::string& where, std::string what, std::string mend = {}) {
        if (!ok) add(where, std::move(what), std::move(mend));
    }
    void rigid(const Pose& pose, const std::string& where) {
        if (auto checked = pose_from_matrix(pose.matrix(), where, 1e-6); !checked)
            list.push_back(checked.error());
    }
    std::vector<Error> list;
};

template <class T>
void check_ids(const std::vector<T>& items, const char* kind, Findings& findings) {
    std::set<std::string> seen;
    for (const T& item : items) {
        findings.unless(!item.id.empty(), fmt::format("{}s", kind), fmt::format("a {} has no id", kind),
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

void check_profile(const Profile& profile, const std::string& where, Findings& findings) {
    const std::size_t n = profile.x_mm.size();
    findings.unless(profile.z_mm.size() == n &&
                        (profile.intensity.empty() || profile.intensity.size() == n) &&
                        (profile.segment.empty() || profile.segment.size() == n),
                    where, "the columns of the profile differ in length");
}

void check_calibration(const Calibration& c, Findings& findings) {
    const std::string where = "calibration " + c.id;
    findings.rigid(c.flange_from_sensor, where + ".flange_from_sensor");
    findings.unless(c.covariance.allFinite(), where,
                    "the covariance holds a value that is not a finite number");
    if (c.verdict == "poor" || c.verdict == "undetermined" || c.verdict.empty())
        findings.add(where,
                     fmt::format("its verdict is {}, nothing measured with it can be pushed",
                                 c.verdict.empty() ? "missing" : c.verdict),
                     "calibrate again");
    else
        findings.unless(c.verdict == "good" || c.verdict == "usable", where,
                        fmt::format("the verdict \"{}\" is not known", c.verdict));
    if (!c.model) return;
    findings.rigid(c.model->camera_from_laser, where + ".camera_from_laser");
    if (!c.model->table)
        findings.unless(positive(c.model->camera.fx) && positive(c.model->camera.fy), where,
                        "the camera's focal length is not positive");
}

void check_sensor(const Project& project, const SensorSetup& sensor, Findings& findings) {
    const std::string where = "sensor " + sensor.id;
    findings.unless(!sensor.driver.empty(), where, "it has no driver", "choose one of `seamwright devices`");
    if (sensor.calibration_id.empty()) {
        findings.add(where, "it has no calibration, nothing measured with it can be pushed", "calibrate it");
        return;
    }
    for (const Calibration& c : project.calibrations) {
        if (c.id != sensor.calibration_id) continue;
        findings.unless(c.sensor_id.empty() || c.sensor_id == sensor.id, where,
                        fmt::format("its calibration {} was made for sensor {}", c.id, c.sensor_id),
                        "calibrate this sensor");
        findings.unless(sensor.identity.serial.empty() || sensor.identity == c.sensor_identity, where,
                        fmt::format("the connected sensor {} is not the one of calibration {} ({})",
                                    sensor.identity.serial, c.id, c.sensor_identity.serial),
                        "calibrate again after exchanging a sensor");
        return;
    }
    findings.add(where, fmt::format("its calibration \"{}\" is not in the project", sensor.calibration_id));
}

void check_spot(const Project& project, const Spot& spot, Findings& findings) {
    const std::string where = "spot " + spot.id;
    findings.unless(known(project.sensors, spot.sensor_id), where,
                    fmt::format("its sensor \"{}\" is not in the project", spot.sensor_id));
    findings.unless(known(project.robots, spot.robot_id), where,
                    fmt::format("its robot \"{}\" is not in the project", spot.robot_id));
    findings.rigid(spot.base_from_flange, where + ".base_from_flange");
    for (std::size_t i = 0; i < spot.via.size(); ++i)
        findings.rigid(spot.via[i], fmt::format("{}.via[{}]", where, i));
    if (auto finder = make_feature_finder(spot.feature); !finder)
        findings.add(where + ".feature", finder.error().what, finder.error().mend);
    findings.unless(spot.reference_mm.allFinite(), where, "the reference is not a finite point",
                    "teach it again");
    findings.unless(spot.weights.allFinite() && spot.weights.minCoeff() >= 0, where,
                    "the weights must be finite and not negative");
    findings.unless(spot.weights.maxCoeff() > 0, where, "no direction has a weight",
                    "give x or z the weight 1");
    findings.unless(positive(spot.sigma_mm) && spot.sigma_mm <= 10, where,
                    fmt::format("sigma of {} mm is not plausible (0..10)", spot.sigma_mm));
    findings.unless(std::isfinite(spot.jitter_mm) && spot.jitter_mm >= 0 && spot.jitter_mm <= 100, where,
                    fmt::format("the jitter window of {} mm is not plausible (0..100)", spot.jitter_mm));
    findings.unless(positive(spot.speed_mm_s) && spot.speed_mm_s <= 5000, where,
                    fmt::format("the speed of {} mm/s is not plausible (0..5000)", spot.speed_mm_s));
    findings.unless(std::isfinite(spot.entry_mm) && spot.entry_mm >= 0 && std::isfinite(spot.exit_mm) &&
                        spot.exit_mm >= 0 && spot.entry_mm <= 1000 && spot.exit_mm <= 1000,
                    where, "entry and exit must be between 0 and 1000 mm");
    check_profile(spot.reference_profile, where + ".reference_profile", findings);
    check_profile(spot.feature.template_profile, where + ".template_profile", findings);
    if (spot.curve)
        findings.unless(spot.curve->x_coefficients.allFinite() && spot.curve->z_coefficients.allFinite() &&
                            spot.curve->valid_from_mm <= spot.curve->valid_to_mm,
                        where, "the contour curve is not usable", "teach it again");
    bool used = false;
    for (const Region& region : project.regions)
        for (const std::string& id : region.spot_ids) used = used || id == spot.id;
    findings.unless(used || !spot.enabled, where, "no region uses it", "add it to a region or switch it off");
}

void check_region(const Project& project, const Region& region, Findings& findings) {
    const std::string where = "region " + region.id;
    std::set<std::string> seen;
    int enabled = 0;
    std::set<std::string> robots;
    double observed = 0;
    for (const std::string& id : region.spot_ids) {
        findings.unless(seen.insert(id).second, where, fmt::format("spot {} is named twice", id));
        const Spot* spot = find_spot(project, id);
        if (!spot) {
            findings.add(where, fmt::format("spot \"{}\" is not in the project", id));
            continue;
        }
        findings.unless(spot->enabled || !spot->required, where,
                        fmt::format("its required spot {} is switched off", id));
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
            fmt::format("{} observed coordinates cannot determine {} degrees of freedom", observed, free),
            "add spots in other orientations");
    findings.unless(robots.size() <= 1, where,
                    "its spots belong to several robots, one frame cannot serve them",
                    "make one region per robot");
    findings.unless(
        positive(region.limits.translation_mm) && region.limits.translation_mm <= 1000, where,
        fmt::format("the limit of {} mm is not plausible (0..1000)", region.limits.translation_mm));
    findings.unless(
        positive(region.limits.rotation_deg) && region.limits.rotation_deg <= 45, where,
        fmt::format("the limit of {} degrees is not plausible (0..45)", region.limits.rotation_deg));
    findings.unless(positive(region.sigma_limit_mm), where, "the limit of sigma in mm must be positive");
    findings.unless(positive(region.sigma_limit_deg), where,
                    "the limit of sigma in degrees must be positive");
    findings.unless(!region.frame_name.empty(), where,
                    "it names no frame on the controller, nothing can be pushed");
    findings.rigid(region.base_from_frame, where + ".base_from_frame");
    for (const Region& other : project.regions) {
        if (&other == &region) break;
        findings.unless(other.frame_name.empty() || other.frame_name != region.frame_name, where,
                        fmt::format("region {} writes the same frame {}", other.id, other.frame_name),
                        "give each region its own frame");
    }
}

void check_place(const Project& project, const PanelJob& job, const PanelPlace& place, Findings& findings) {
    const std::string where = fmt::format("panel job {}, place {}", job.id, place.id);
    findings.unless(known(project.sensors, place.sensor_id), where,
                    fmt::format("its sensor \"{}\" is not in the project", place.sensor_id));
    findings.unless(place.second_sensor_id.empty() || known(project.sensors, place.second_sensor_id), where,
                    fmt::format("its second sensor \"{}\" is not in the project", place.second_sensor_id));
    findings.unless(place.second_sensor_id != place.sensor_id, where, "both its heads are the same sensor",
                    "a double head has two sensors");
    if (auto good = check(place.gauge); !good)
        findings.add(where + ".gauge", good.error().what, good.error().mend);
    findings.unless(place.panel_reference_mm.allFinite() && place.body_reference_mm.allFinite() &&
                        std::isfinite(place.gap_mm) && std::isfinite(place.flush_mm) &&
                        std::isfinite(place.surface_deg),
                    where, "what was taught is not finite", "teach it again");
    findings.unless(
        place.weights.allFinite() && place.weights.minCoeff() >= 0 && place.weights.maxCoeff() > 0, where,
        "the weights must be finite, not negative, and one of them positive");
    findings.unless(positive(place.sigma_mm) && place.sigma_mm <= 10, where,
                    fmt::format("sigma of {} mm is not plausible (0..10)", place.sigma_mm));
    check_profile(place.reference_profile, where + ".reference_profile", findings);
}

void check_panel_job(const Project& project, const PanelJob& job, Findings& findings) {
    const std::string where = "panel job " + job.id;
    findings.unless(known(project.robots, job.robot_id), where,
                    fmt::format("its robot \"{}\" is not in the project", job.robot_id));
    std::set<std::string> seen, sensors;
    int enabled = 0;
    for (const PanelPlace& place : job.places) {
        findings.unless(!place.id.empty() && seen.insert(place.id).second, where,
                        fmt::format("place \"{}\" has no name of its own", place.id));
        findings.unless(place.enabled || !place.required, where,
                        fmt::format("its required place {} is switched off", place.id));
        enabled += place.enabled;
        for (const std::string& id : {place.sensor_id, place.second_sensor_id})
            findings.unless(id.empty() || !place.enabled || sensors.insert(id).second, where,
                            fmt::format("sensor {} is used at two places", id), "a sensor sees one place");
        check_place(project, job, place, findings);
    }
    findings.unless(enabled >= 3, where, fmt::format("{} enabled places do not determine a motion", enabled),
                    "measure at three or more places in different orientations");
    for (const Field<PanelJob>& f : panel_fields())
        if (auto valid = validate({{f.info.name, f.get(job)}}, {f.info}, where); !valid)
            findings.list.push_back(valid.error());
    findings.unless(!job.frame_name.empty(), where,
                    "it names no frame on the controller, nothing can be moved");
    findings.rigid(job.base_from_gripper, where + ".base_from_gripper");
    findings.rigid(job.base_from_frame, where + ".base_from_frame");
    const auto same_frame = [&](const std::string& other) {
        return !job.frame_name.empty() && other == job.frame_name;
    };
    for (const Region& region : project.regions)
        findings.unless(!same_frame(region.frame_name), where,
                        fmt::format("region {} writes the same frame {}", region.id, job.frame_name));
    for (const PanelJob& other : project.panel_jobs) {
        if (&other == &job) break;
        findings.unless(!same_frame(other.frame_name), where,
                        fmt::format("panel job {} writes the same frame {}", other.id, job.frame_name));
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
    if (auto valid = validate_fields(project.requirements); !valid) findings.list.push_back(valid.error());
    for (const SensorSetup& sensor : project.sensors) check_sensor(project, sensor, findings);
    for (const RobotSetup& robot : project.robots)
        findings.unless(!robot.driver.empty(), "robot " + robot.id, "it has no driver",
                        "choose one of `seamwright devices`");
    for (const Calibration& calibration : project.calibrations) check_calibration(calibration, findings);
    for (const Spot& spot : project.spots) check_spot(project, spot, findings);
    for (const Region& region : project.regions) check_region(project, region, findings);
    check_ids(project.panel_jobs, "panel job", findings);
    for (const PanelJob& job : project.panel_jobs) check_panel_job(project, job, findings);
    return findings.list;
}

}  // namespace seamwright
