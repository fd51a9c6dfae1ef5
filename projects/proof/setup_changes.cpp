// Whether what was proven still holds: what of a setup has changed since.

#include <algorithm>

#include "projects/file/project_json.h"
#include "projects/measure/measure.h"
#include "projects/proof/checklist.h"
#include "projects/proof/present_names.h"

namespace seamwright {
namespace {

// What a measurement rests on.
nlohmann::json essence(const Spot& spot) {
    return to_json_document(spot);
}
nlohmann::json essence(const Region& region) {
    Region r = region;
    r.limits = {};
    r.sigma_limit_mm = r.sigma_limit_deg = 1;
    r.frame_name.clear();
    r.base_from_frame = Pose::Identity();
    return to_json_document(r);
}
nlohmann::json essence(const SensorSetup& sensor) {
    SensorSetup s = sensor;
    s.settings = nlohmann::json::object();
    return to_json_document(s);
}
nlohmann::json essence(const RobotSetup& robot) {
    RobotSetup r = robot;
    r.settings = nlohmann::json::object();
    r.required_mode = RobotMode::unknown;
    return to_json_document(r);
}
nlohmann::json essence(const Calibration* calibration, const PresentNames* names = nullptr) {
    if (!calibration) return {};
    // All but the data it was solved from and what was reported, which are megabytes: asked for every spot with every edit.
    const Calibration& all = *calibration;
    Calibration c;
    c.id = all.id;
    c.method = all.method;
    c.sensor_id = names ? names->sensor(all.sensor_id).value_or("") : all.sensor_id;
    c.robot_id = names ? names->robot(all.robot_id).value_or("") : all.robot_id;
    c.sensor_identity = all.sensor_identity;
    c.robot_identity = all.robot_identity;
    c.created_utc = all.created_utc;
    c.source = all.source;
    c.model = all.model;
    c.flange_from_sensor = all.flange_from_sensor;
    c.covariance = all.covariance;
    c.scale_sigma = all.scale_sigma;
    c.shear_sigma = all.shear_sigma;
    c.verdict = all.verdict;
    c.nozzle = all.nozzle;
    return to_json_document(c);
}

// A thing of then under today's names, that of what it names included; what is no more has none.
SensorSetup renamed(SensorSetup s, const PresentNames& names) {
    s.id = names.sensor(s.id).value_or("");
    return s;
}
RobotSetup renamed(RobotSetup r, const PresentNames& names) {
    r.id = names.robot(r.id).value_or("");
    return r;
}
Spot renamed(Spot s, const PresentNames& names) {
    s.id = names.spot(s.id).value_or("");
    s.sensor_id = names.sensor(s.sensor_id).value_or("");
    s.robot_id = names.robot(s.robot_id).value_or("");
    return s;
}
Region renamed(Region r, const PresentNames& names) {
    r.id = names.region(r.id).value_or("");
    for (std::string& id : r.spot_ids) id = names.spot(id).value_or("");
    return r;
}
template <class T>
Text first_change(const std::vector<T>& then, const std::vector<T>& now, const PresentNames& names,
                  const char* name) {
    for (std::size_t i = 0; i < std::max(then.size(), now.size()); ++i) {
        if (i >= now.size()) return Text::chosen(name, then[i].id);
        if (i >= then.size() || essence(renamed(then[i], names)) != essence(now[i]))
            return Text::chosen(name, now[i].id);
    }
    return {};
}

const Calibration* in_use(const Project& p, const SensorSetup& sensor) {
    for (const Calibration& c : p.calibrations)
        if (c.id == sensor.calibration_id) return &c;
    return nullptr;
}

}  // namespace

Text changed_since(const Project& then, const Project& now) {
    if (!then.part.base_from_workobject.isApprox(now.part.base_from_workobject, 1e-12))
        return Text("the work object");
    const PresentNames names(then, now);
    if (auto changed = first_change(then.sensors, now.sensors, names, "sensor {}"); !changed.empty())
        return changed;
    if (auto changed = first_change(then.robots, now.robots, names, "robot {}"); !changed.empty())
        return changed;
    for (std::size_t i = 0; i < now.sensors.size(); ++i)
        if (essence(in_use(then, then.sensors[i]), &names) != essence(in_use(now, now.sensors[i])))
            return Text("calibration {}", now.sensors[i].calibration_id);
    if (auto changed = first_change(then.spots, now.spots, names, "spot {}"); !changed.empty())
        return changed;
    return first_change(then.regions, now.regions, names, "region {}");
}

bool pass_changed(const Project& then, const Project& now, const std::string& spot_id) {
    const PresentNames names(then, now);
    const Spot* b = find_spot(now, spot_id);
    const auto a =
        std::ranges::find_if(then.spots, [&](const Spot& s) { return names.spot(s.id) == spot_id; });
    if (a == then.spots.end() || !b) return true;
    const auto rests_on = [](Spot s) {
        s.enabled = s.required = true;
        s.reference_mm.setZero();
        s.reference_profile = {};
        s.reference_state = ReferenceState::measured;
        s.drawn.reset();
        s.weights.setOnes();
        s.sigma_mm = 1;
        s.jitter_mm = 1;
        return to_json_document(s);
    };
    // A smaller window than was judged is on the safe side.
    return b->jitter_mm > a->jitter_mm * (1 + 1e-9) || rests_on(renamed(*a, names)) != rests_on(*b) ||
           essence(calibration_of(then, *a), &names) != essence(calibration_of(now, *b));
}

}  // namespace seamwright
