#pragma once
// A panel job: a panel held by a robot's gripper is brought into a body as it was taught, by one motion
// (core/panel/panel_fit.h). Value types; run by panel_station.h.
//
// Frames. The gripper is the robot's flange: the calibrations of its sensors are flange_from_sensor. At a
// place one sensor, or a double head of two (core/panel/double_head.h), sees panel and body in one profile;
// the place's frame is that of its sensor, of a double head the one midway between both.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/correction/correction.h"
#include "core/features/gap/gap_flush.h"
#include "core/geometry/pose.h"
#include "core/panel/panel_fit.h"
#include "core/profile/profile.h"
#include "core/value_type.h"

namespace seamwright {

// References, gap and flush are taught with the panel in its zero position (panel_station.h: teach_panel).
struct PanelPlace {
    SEAM_VALUE_TYPE(PanelPlace);
    std::string id;                // "P1"
    std::string sensor_id;         // of the project, on this job's gripper
    std::string second_sensor_id;  // of a double head; empty = none
    bool enabled = true;
    bool required = true;    // without it nothing is moved
    GapFlushSettings gauge;  // the body is the reference side
    // The surfaces at their edges (gap_flush.h).
    Eigen::Vector3d panel_reference_mm = Eigen::Vector3d::Zero(), body_reference_mm = Eigen::Vector3d::Zero();
    double gap_mm = 0, flush_mm = 0;  // taught, by the gauge
    double surface_deg = 0;           // of the body's surface in the profile, from +x towards +z
    Profile reference_profile;        // merged
    Eigen::Vector3d weights = {1, 0, 1};
    double sigma_mm = 0.05;  // of an observed coordinate, beside the gauge's own
};

// How gap and flush at the job's places answer a motion of the gripper (thesis 2.5.1), learnt on the cell by known small
// moves (projects/panel/panel_servo.h).
struct PanelSensitivity {
    std::vector<std::string> places;  // enabled ones when it was learnt, two rows each: gap, then flush
    // Per mm along x, y, z and per rad about them, in the gripper's own frame.
    std::vector<std::array<double, 6>> rows;
    double step_mm = 0, step_deg = 0;  // of the moves, to either side
    double condition = 0;              // of the matrix scaled by them
    std::string utc;                   // when, ISO 8601
};

struct PanelJob {
    SEAM_VALUE_TYPE(PanelJob);
    std::string id;  // "door left"
    std::string robot_id;
    std::vector<PanelPlace> places;
    Pose base_from_gripper = Pose::Identity();  // where it measures; taught: where the panel fits the body
    CorrectionLimits limits{25.0, 3.0};         // of the motion
    double sigma_limit_mm = 0.1, sigma_limit_deg = 0.05;  // of the motion, as a region's
    // Of gap and flush against taught, at every place: as predicted before the motion, as measured after it.
    double gap_tolerance_mm = 0.5, flush_tolerance_mm = 0.5;
    double head_limit_mm = 0.15;  // largest disagreement of a double head
    // Of a place that contradicts the others (a bent panel).
    PanelDeviation deviation = PanelDeviation::share;
    std::string frame_name;                       // on the controller: what the panel is put in by
    Pose base_from_frame = Pose::Identity();      // taught, for panel and body in their zero relation
    std::optional<PanelSensitivity> sensitivity;  // absent: not learnt
};

}  // namespace seamwright
