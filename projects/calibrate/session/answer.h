#pragma once
// What a solution becomes: a calibration of the project, compared with the one before.

#include "projects/calibrate/session/session.h"

namespace seamwright {

// The calibration that a result gives. `base` is the one in use (nullptr: none): what the method does not
// determine, pixel to millimetre for the sphere, the flange for a laser plane, is taken over from it. `data`
// and `exclude` go into Calibration::raw, so that it can be solved again. Ids, identities and times are the
// caller's. Error (input): the method needs a base, the result is undetermined.
Expected<Calibration> calibration_of_result(const CalibrationMethod& method, const nlohmann::json& data,
                                            const std::vector<std::string>& exclude,
                                            const nlohmann::json& result, const Calibration* base);

// The whole of it from a session, named with free ids, for this project's sensors and robot: one calibration,
// or, of the one shot of a gripper, one for each sensor whose chain was solved, built on that sensor's own
// calibration in use; its raw data and result hold its chain alone. Error (input): also a chain of a sensor
// that the project does not know; there is no part of an answer.
Expected<std::vector<Calibration>> calibrations_of_session(const CalibrationSession& session,
                                                           const Project& project);

// How far apart two calibrations put the same pixel (or the same profile point), on the flange, over the
// field.
struct CalibrationDifference {
    double largest_mm = 0, mean_mm = 0;
    double turn_deg = 0;  // of flange_from_sensor
    double shift_mm = 0;  // of its origin
    int points = 0;       // compared; 0: the two see nothing in common
};
CalibrationDifference difference(const Calibration& now, const Calibration& before);

}  // namespace seamwright
