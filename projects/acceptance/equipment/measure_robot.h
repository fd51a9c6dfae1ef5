#pragma once
// Repeatability of a robot, measured on the cell: returns to taught spots, several profiles standing at each. The
// robot moves as in teaching, entry to trigger pose and back, between spots along the measuring program's own way;
// nothing is written to it. A sphere is returned to as a spot whose feature is its circle. The mathematics is
// core/acceptance/equipment/robot_study.h.

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "projects/acceptance/study/studies.h"
#include "projects/station/station.h"

namespace seamwright {

struct MeasureRobotOptions {
    std::vector<std::string>
        spot_ids;            // of one robot; none: up to three that together see the most directions
    int returns = kReturns;  // kLeastReturns to 1000, to each spot
    int profiles = 5;        // at each return, 2 to 100
    bool keep = true;        // sets RobotSetup::arrival_covariance and stores the evidence
    std::stop_token cancel;
    std::function<void(const RunProgress&)> progress;
};

struct MeasuredRobot {
    RobotReturns returns;
    RobotStudy study;
    StudySource source;
    std::string utc;                               // when it was stored; empty: it was not
    Matrix6 arrival_covariance = Matrix6::Zero();  // as set, or as it would be
};

// What a spot sees of a displacement of its sensor (SpotReturns::sees): the contour along its curve, or along the
// travel where none was learnt, moves nothing.
Eigen::Matrix<double, 2, 3> seen_by(const Spot& spot, const Pose& flange_from_sensor);

// C of the study as RobotSetup::arrival_covariance holds it: of the point looked at, no rotation apart.
Matrix6 arrival_covariance_of(const RobotStudy& study);

// The feature must be found in half of the returns at least, or the Error (input) carries the last reason. A profile
// whose feature lies beyond six robust deviations from those of the same return (the robot stands, so it is the
// sensor's) is left out. Error: not connected, no spot, spots of several robots or without calibration, findings of
// check() that concern motion, a device, cancelled, the file.
Expected<MeasuredRobot> measure_robot(Station& station, const MeasureRobotOptions& options);

// What it finds becomes the project's.
void apply(const MeasuredRobot& measured, Project& project);

// The newest stored study of a robot (empty: of the project's only one, or the newest of all), compared with the
// project as it is `now` (nullptr: as it is saved). nullopt: none.
Expected<std::optional<MeasuredRobot>> stored_robot_study(const ProjectFile& file,
                                                          const std::string& robot_id,
                                                          const Project* now = nullptr);

// Sets back what the newest study of the robot replaced, which becomes the project's again. Error: none is stored.
Expected<void> undo_robot_study(Station& station, const std::string& robot_id);

}  // namespace seamwright
