#include "projects/calibrate/session/use.h"

#include <algorithm>

#include "core/calibration/table/lookup_table_calibration.h"
#include "projects/calibrate/methods/methods.h"
#include "projects/measure/measure.h"

namespace seamwright {
namespace {

// What the sensor's point `xz_mm` of `before` is by `now`: the same pixel; of finished profiles the same point.
std::optional<Eigen::Vector2d> seen_by(const Calibration& now, const Calibration& before,
                                       const Eigen::Vector2d& xz_mm) {
    if (!now.model || !before.model) return xz_mm;
    const auto pixel =
        before.model->table ? pixel_in_table(*before.model->table, xz_mm) : before.model->to_pixel(xz_mm);
    return pixel ? now.model->to_laser(*pixel) : std::nullopt;
}

const Calibration* find_calibration(const Project& project, const std::string& id) {
    const auto at = std::find_if(project.calibrations.begin(), project.calibrations.end(),
                                 [&](const Calibration& c) { return c.id == id; });
    return at == project.calibrations.end() ? nullptr : &*at;
}

Expected<void> may_be_used(const Calibration& c, const std::string& sensor_id) {
    const Text where("sensor {}", sensor_id);
    if (c.sensor_id != sensor_id)
        return input_error(Text("calibration {} belongs to another sensor", c.id), where);
    const CalibrationMethod* method = find_method(c.method);
    if (c.nozzle || (method && method->use != AnswerUse::sensor))
        return input_error(
            Text("calibration {} is a record of {} and no place of the sensor", c.id, c.method), where,
            "choose one that says where the sensor is");
    // Kept without a sensor to build on: neither a model nor a place on the flange.
    if (method && !c.model && c.flange_from_sensor.matrix().isIdentity(0))
        return input_error(Text("calibration {} does not say where the sensor is on the flange", c.id), where,
                           "calibrate with the sensor's own calibration in use");
    if (!serves(c.verdict))
        return input_error(Text("calibration {} is {}", c.id, name_of(c.verdict)), where, "calibrate again");
    return {};
}

}  // namespace

Expected<CalibrationUse> calibration_use(const Project& project, const std::string& sensor_id,
                                         const std::string& calibration_id) {
    const SensorSetup* sensor = find_sensor(project, sensor_id);
    if (!sensor) return input_error(Text("there is no sensor \"{}\"", sensor_id));
    CalibrationUse use{sensor_id, sensor->calibration_id, calibration_id, {}, {}, 0};
    if (calibration_id.empty()) return use;
    const Calibration* after = find_calibration(project, calibration_id);
    if (!after) return input_error(Text("there is no calibration \"{}\"", calibration_id));
    // What is in use stays so, whatever it is: nothing changes.
    if (calibration_id != sensor->calibration_id) SEAM_OK(may_be_used(*after, sensor_id));
    const Calibration* before = calibration_of(project, sensor_id);
    if (!before) return use;
    use.difference = difference(*after, *before);
    use.working_point_mm = use.difference->mean_mm;
    double farthest = -1;
    for (const Spot& spot : project.spots) {
        if (spot.sensor_id != sensor_id) continue;
        const Eigen::Vector2d r(spot.reference_mm.x(), spot.reference_mm.z());
        const auto now = seen_by(*after, *before, r);
        if (!now) continue;
        const double moved = (after->flange_from_sensor * Eigen::Vector3d(now->x(), 0, now->y()) -
                              before->flange_from_sensor * Eigen::Vector3d(r.x(), 0, r.y()))
                                 .norm();
        use.spots.push_back({spot.id, moved});
        farthest = std::max(farthest, moved);
    }
    if (farthest >= 0) use.working_point_mm = farthest;
    return use;
}

}  // namespace seamwright
