#pragma once
// After an exchange of a sensor or a robot: the spots as they were taught, with only the calibration
// repeated.
//
// What a spot sees depends on where the sensor stands at the part, W = base_from_workobject^-1 *
// base_from_flange * flange_from_sensor. Another sensor sits otherwise on the flange, another robot stands
// otherwise before the part; the flange is led so that the sensor stands at the same W again:
//     base'_from_flange' = base'_from_workobject * W * flange'_from_sensor'^-1.
// References, templates, curves, weights and regions then hold as they are. Frames of the regions keep their
// place in the work object. What the new calibration is off by shows in the zero shift, which is stale by the
// change, as is every other proof.

#include <optional>
#include <string>
#include <vector>

#include "projects/model/project.h"

namespace seamwright {

struct Exchange {
    std::string sensor_id;
    std::string calibration_id;  // of the new sensor or on the new robot; becomes the one in use
    // Of the robot that stands there now; absent where the robot stayed.
    std::optional<Pose> base_from_workobject;
};

struct MovedSpot {
    std::string spot_id;
    double moved_mm = 0, turned_deg = 0;  // of the taught flange pose
};
struct Retaught {
    Project project;
    std::vector<MovedSpot> spots;
};

// Error (input): unknown sensor or calibration, one of another sensor, a verdict that may not be used, a
// sensor without a calibration in use until now or taught in pixels, a new work object while other sensors'
// spots would stay behind.
Expected<Retaught> after_exchange(const Project& project, const Exchange& exchange);

}  // namespace seamwright
