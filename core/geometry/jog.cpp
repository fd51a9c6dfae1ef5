#include "core/geometry/jog.h"

namespace seamwright {

Pose jogged(const Pose& base_from_flange, const Pose& flange_from_sensor, JogFrame frame,
            const Eigen::Vector3d& shift_mm, const Eigen::Vector3d& turn_rad) {
    const Pose step = make_pose(rotation_exp(turn_rad), shift_mm);
    if (frame == JogFrame::flange) return base_from_flange * step;
    Pose base_from_sensor = base_from_flange * flange_from_sensor;
    if (frame == JogFrame::sensor) {
        base_from_sensor = base_from_sensor * step;
    } else {
        base_from_sensor.linear() = step.linear() * base_from_sensor.linear();
        base_from_sensor.translation() += shift_mm;
    }
    return base_from_sensor * flange_from_sensor.inverse();
}

}  // namespace seamwright
