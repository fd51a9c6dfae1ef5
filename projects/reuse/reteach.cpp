#include "projects/reuse/reteach.h"

#include <algorithm>

#include "projects/measure/measure.h"

namespace seamwright {

Expected<Retaught> after_exchange(const Project& project, const Exchange& exchange) {
    const Text where("sensor {}", exchange.sensor_id);
    const SensorSetup* sensor = find_sensor(project, exchange.sensor_id);
    if (!sensor) return input_error("it is not in the project", where);
    const auto calibration = [&](const std::string& id) {
        return std::find_if(project.calibrations.begin(), project.calibrations.end(),
                            [&](const Calibration& c) { return c.id == id; });
    };
    const auto before = calibration(sensor->calibration_id), after = calibration(exchange.calibration_id);
    if (before == project.calibrations.end())
        return input_error("its spots were taught without a calibration, so that nobody knows where it stood",
                           where, "teach them again");
    if (before->method == "pixels")
        return input_error("its spots were taught in pixels, so that their references are no millimetres",
                           where, "import the recording again with --calibration");
    if (after == project.calibrations.end())
        return input_error(Text("there is no calibration \"{}\"", exchange.calibration_id), where,
                           "calibrate the new sensor first");
    if (after->sensor_id != exchange.sensor_id)
        return input_error(Text("calibration {} belongs to sensor {}", after->id, after->sensor_id), where,
                           "choose one of this sensor");
    if (!serves(after->verdict))
        return input_error(Text("calibration {} is {}", after->id, name_of(after->verdict)), where,
                           "calibrate again");
    const Pose old_base = project.part.base_from_workobject;
    const Pose new_base = exchange.base_from_workobject.value_or(old_base);
    if (exchange.base_from_workobject)
        for (const Spot& spot : project.spots)
            if (spot.sensor_id != exchange.sensor_id)
                return input_error(
                    Text("spot {} is measured by another sensor and would stay behind", spot.id),
                    "work object", "exchange one robot of a project with a single sensor");
    Retaught result;
    result.project = project;
    Project& p = result.project;
    p.part.base_from_workobject = new_base;
    for (SensorSetup& s : p.sensors)
        if (s.id == exchange.sensor_id) s.calibration_id = exchange.calibration_id;
    const Pose lead = before->flange_from_sensor * after->flange_from_sensor.inverse();
    for (Spot& spot : p.spots) {
        if (spot.sensor_id != exchange.sensor_id) continue;
        const Pose was = spot.base_from_flange;
        spot.base_from_flange = new_base * old_base.inverse() * was * lead;
        result.spots.push_back({spot.id, distance_mm(was, spot.base_from_flange),
                                deg_from_rad(angle_rad(was, spot.base_from_flange))});
    }
    for (Region& region : p.regions)
        region.base_from_frame = new_base * old_base.inverse() * region.base_from_frame;
    return result;
}

}  // namespace seamwright
