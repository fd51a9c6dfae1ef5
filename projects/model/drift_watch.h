#pragma once
// The drift watch: reference spots on something fixed in the cell (a sphere, a bracket), seen again and again by the robot's
// own program, either with every part (spots in no region) or by a program of their own that the robot calls as a part
// type without regions. Each run that measured all of them is a point of the chart (core/statistics/drift_chart.h).

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose.h"
#include "core/statistics/drift_chart.h"
#include "core/text.h"
#include "core/value_type.h"

namespace seamwright {

// What the drift is taken for where it is compensated. One reference cannot tell which; several seen from different sides
// contradict the wrong one.
enum class DriftOf {
    sensor,  // the sensor on its flange: the same shift in every spot's sensor frame
    robot    // the robot: the same shift in base
};

struct LearntDirection {
    std::string spot_id;
    int axis = 0;           // 0 X, 2 Z of the taught sensor frame
    double mean_mm = 0;     // when warm
    double sigma_mm = 0;    // of one point
    double stated_mm = 0;   // as the measurements state it
    double warm_up_mm = 0;  // off the mean when cold
};

struct LearntDrift {
    std::string utc;
    std::int64_t first_point = 0, last_point = 0;  // learnt from; older ones are no part of the chart
    int points = 0;
    double degrees = 0;          // of the sigmas
    double time_constant_s = 0;  // of the warm-up; 0: none
    std::uint32_t mark = 0;      // DriftPoint::mark
    std::vector<LearntDirection> directions;
};

// What a person acknowledged: the points from the step on are no part of the chart any more. What comes next is judged from
// where the reference stood before the step.
struct SetAside {
    std::int64_t first_point = 0, last_point = 0;
    std::string utc, by, text;
};

struct DriftWatch {
    SEAM_VALUE_TYPE(DriftWatch);
    std::string id = "watch";
    std::vector<std::string> spot_ids;
    int every_parts = 1;        // it is due after so many; 0: not by parts
    double every_minutes = 0;   // or after so long; 0: not by time
    double limit_mm = 0.1;      // of the level; beyond: recalibrate
    double pause_minutes = 10;  // without a part: the cell has cooled, and its warm-up begins anew
    bool compensate = false;
    DriftOf drifts = DriftOf::sensor;
    double most_mm = 0.3;      // that is taken off; beyond, the gate refuses
    std::string switched_utc;  // when compensate was switched last
    std::optional<LearntDrift> learnt;
    std::vector<SetAside> set_aside;
};

// The reference measured once. Stored beside the runs, and kept when these are deleted.
struct DriftPoint {
    SEAM_VALUE_TYPE(DriftPoint);
    std::int64_t id = 0, run = 0;
    std::string utc;
    std::uint32_t mark = 0;              // of what it was measured with: spots, poses, features, calibrations
    double running_s = 0, pause_s = -1;  // see DriftLearning
    std::vector<double> values_mm, sigma_mm;  // x and z of each spot, taught sensor frame; as stated
    DriftVerdict verdict = DriftVerdict::learning;
    bool step = false;  // production stopped by it
    int changed = 0;    // points since the step, this one included
    Text text;
};

// What the watch said of a run, and what was taken off its measurements.
struct ActingDrift {
    SEAM_VALUE_TYPE(ActingDrift);
    DriftVerdict verdict = DriftVerdict::learning;
    Text text;
    bool compensated = false;
    Text why;  // where compensation is on and did not act
    DriftOf drifts = DriftOf::sensor;
    std::string device_id;                               // sensor or robot that it is the drift of
    Eigen::Vector3d shift_mm = Eigen::Vector3d::Zero();  // taken off: sensor frame, or base
    double sigma_mm = 0;                                 // of it, worst direction
    // Where nothing is taken off: how far the reference stands off its learnt place, worst direction, its sigma with it. The
    // correction states it as one standard deviation of the device's drift. 0: nothing is learnt.
    double standing_mm = 0;
};

Text said_of(
    const ActingDrift& drift);  // "drift compensated: X 0.100 Y 0.000 Z -0.020 mm taken off (sensor A)"

}  // namespace seamwright
