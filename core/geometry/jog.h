#pragma once
// Small motions of a robot by hand: a step along or about an axis of a frame that the person thinks in.

#include "core/geometry/pose.h"

namespace seamwright {

enum class JogFrame {
    base,    // the robot's axes; turns about the sensor's origin
    flange,  // the flange's axes and origin
    sensor   // the sensor's: X along the laser line, Y across it, Z the height
};

// base_from_flange after `shift_mm` along and `turn_rad` (rotation vector) about the frame's axes. Without a calibration
// flange_from_sensor is the identity: the sensor's frame is the flange's then.
Pose jogged(const Pose& base_from_flange, const Pose& flange_from_sensor, JogFrame frame,
            const Eigen::Vector3d& shift_mm, const Eigen::Vector3d& turn_rad);

}  // namespace seamwright
