#pragma once
// A stored calibration put in use at its sensor: whether it may be, and what it changes. Asked by the desk's edit and by
// `seamwright use`, so that both refuse the same.

#include <optional>
#include <string>
#include <vector>

#include "projects/calibrate/session/answer.h"

namespace seamwright {

// Where a spot's reference point lies on the flange by the calibration asked for, against the one in use: what the
// camera saw of it (the same pixel), or the sensor delivered (the same point), carried through both.
struct MovedWorkingPoint {
    std::string spot_id;
    double moved_mm = 0;
};

struct CalibrationUse {
    std::string sensor_id, before, after;             // ids of calibrations; empty: none
    std::optional<CalibrationDifference> difference;  // nothing: one of the two is none
    std::vector<MovedWorkingPoint> spots;  // of this sensor; without those that either cannot place
    double working_point_mm = 0;           // the farthest of `spots`, else the mean over the field
};

// `calibration_id` empty: none any more. Error (input): no such sensor or calibration, another sensor's, one that says
// where something else is (a nozzle, a plate, a lens alone), a verdict that does not serve.
Expected<CalibrationUse> calibration_use(const Project& project, const std::string& sensor_id,
                                         const std::string& calibration_id);

}  // namespace seamwright
