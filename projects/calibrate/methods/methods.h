#pragma once
// All calibration methods, one line each, in the order in which people meet them.

#include "projects/calibrate/methods/method.h"

namespace seamwright {

CalibrationMethod tcp_sphere_method();
CalibrationMethod stripe_camera_method();
CalibrationMethod hand_eye_method();
CalibrationMethod laser_plane_method();
CalibrationMethod lut_method();
CalibrationMethod static_method();
CalibrationMethod camera_method();
CalibrationMethod lens_method();
CalibrationMethod plate_method();
CalibrationMethod stereo_method();
CalibrationMethod bundle_method();
CalibrationMethod drift_method();
CalibrationMethod on_part_method();
CalibrationMethod nozzle_method();

const std::vector<CalibrationMethod>& calibration_methods();
const CalibrationMethod* find_method(const std::string& id);  // nullptr: unknown

// Data as JSON in, the answer out. The data may say in which convention their poses are written (pose_lists.h).
// Error (input): data that are no data of the method, in one sentence with their place; too few to solve from is an
// answer, undetermined, with its reason.
Expected<CalibrationSolution> solve_calibration(const CalibrationMethod& method, const nlohmann::json& data,
                                                const ExcludedIds& exclude);

}  // namespace seamwright
