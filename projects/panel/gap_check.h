#pragma once
// The gap check on a pass along the contour: profiles of one sensor, each with the pose at which the robot
// stood, measured by core/features/gap/gap_scan.h in the work object. The pass comes from a capture (`seamwright
// record` while the robot travels), or the robot is sent along it step by step.
//
// Pose of a captured profile: its own, else between the robot's poses and triggers of the capture before and
// after it, by time (screw interpolation), at most `most_between_s` apart. Profiles without either are
// counted and left out; those that are damaged or empty stay as a place without a measure.

#include <functional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "core/features/gap/gap_scan.h"
#include "devices/capture/capture_file.h"
#include "projects/model/project.h"
#include "projects/station/station.h"

namespace seamwright {

struct GapPass {
    std::string sensor_id;
    std::vector<GapSection> sections;  // in the work object
    std::uint64_t frames = 0, damaged = 0, without_pose = 0, without_profile = 0;
    // Of a robot that travelled meanwhile: the largest standard deviation of where the sensor was along its travel. The
    // exposure lies anywhere between trigger and arrival: speed times their distance / sqrt(12).
    double travel_sigma_mm = 0;
};

struct RecordedGapPass {
    std::string sensor_id, robot_id;  // empty: the capture's only one
    double most_between_s = 0.5;
};
// Error: no such sensor in capture or project, no calibration, a damaged file, no profile with a pose.
Expected<GapPass> gap_pass(const Project& project, CaptureReader& capture, const RecordedGapPass& options);

struct DrivenGapPass {
    std::vector<std::string> spot_ids;  // in order; straight (screw motions) from one to the next
    // Instead of spots: base_from_flange, two or more, in order, and whose; empty ids: the project's only ones.
    std::vector<Pose> stands;
    std::string sensor_id, robot_id;
    double step_mm = 1;  // of the sensor's travel, 0.05 or more
    std::stop_token cancel;
    std::function<void(const RunProgress&)> progress;
};
// The robot stops at every step, so that each profile's pose is exact. Error: fewer than two spots or poses, spots of
// different sensors or robots, no calibration, not connected, a robot that the program does not move
// (RobotLink::can_move), a device, cancelled.
Expected<GapPass> gap_pass(Station& station, const DrivenGapPass& options);

// A robot that is moved by a person or by its own program: its pose is asked over and over, the sensor triggered in between,
// and each profile's pose is that between the one asked before its trigger and the one asked after it came, at the middle
// of trigger and arrival. Nothing moves it.
struct FollowedPass {
    std::string sensor_id, robot_id;  // empty: the project's only ones
    double step_mm = 1;               // of the sensor's travel (or 2 degrees) between profiles that are kept
    double rest_s = 3;    // it ends when the robot has moved and then rested so long; 0: not by that
    double most_s = 600;  // it ends anyway; a robot that has not moved by then is an Error
    std::size_t most_profiles = 100000;
    std::stop_token finish;  // ends it with what there is
    std::stop_token cancel;  // ends it with an Error
    std::function<void(const RunProgress&)> progress;
};
// Error: no such sensor or robot, no calibration, not connected, a device, cancelled, the robot never moved.
Expected<GapPass> followed_pass(Station& station, const FollowedPass& options);

struct GapCheck {
    GapScan scan;
    // The taught spots that the pass goes by, where it is nearest to them (within kBySpotMm), by path.
    std::vector<std::pair<std::string, double>> spots;
    // "between S1 and S2", "before S1", "behind S4", "at S2"; empty without spots.
    Text where(double path_mm) const;
};
inline constexpr double kBySpotMm = 20;

// Error: what scan_gap() refuses.
Expected<GapCheck> check_gap(const Project& project, const GapPass& pass, const GapScanOptions& options);

}  // namespace seamwright
