#pragma once
// What a solution becomes: a calibration of the project, compared with the one before.

#include "projects/calibrate/session/session.h"

namespace seamwright {

// The calibration that an answer gives. `base` is the one in use (nullptr: none): what was not found is taken over
// from it, and a camera stays where it sits on the flange when its laser plane alone is new. Its raw data are `data`
// and `exclude`, so that it can be solved again. Ids, identities and times are the caller's. Error (input): the
// finding needs a base, or is none that a sensor could measure with.
Expected<Calibration> calibration_of_solution(const CalibrationMethod& method, const nlohmann::json& data,
                                              const ExcludedIds& exclude, const CalibrationSolution& solution,
                                              const Calibration* base);

// The whole of it from a session, named with free ids, for this project's sensors and robot: one calibration,
// or, of the one shot of a gripper, one for each sensor whose chain was solved, built on that sensor's own
// calibration in use; its raw data and result hold its chain alone. Error (input): also a chain of a sensor
// that the project does not know, and a capture that was taken with a sensor or robot of another serial number than it has now;
// there is no part of an answer.
Expected<std::vector<Calibration>> calibrations_of_session(const CalibrationSession& session,
                                                           const Project& project);

// As it stands in a calibration's result and in the answer of the command line.
nlohmann::json verification_json(const Verification& verification);

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
