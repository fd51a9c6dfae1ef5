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
};

struct RecordedGapPass {
    std::string sensor_id, robot_id;  // empty: the capture's only one
    double most_between_s = 0.5;
};
// Error: no such sensor in capture or project, no calibration, a damaged file, no profile with a pose.
Expected<GapPass> gap_pass(const Project& project, CaptureReader& capture, const RecordedGapPass& options);

struct DrivenGapPass {
    std::vector<std::string> spot_ids;  // in order; straight (screw motions) from one to the next
    double step_mm = 1;                 // of the sensor's travel, 0.05 or more
    std::stop_token cancel;
    std::function<void(const RunProgress&)> progress;
};
// The robot stops at every step, so that each profile's pose is exact. Error: fewer than two spots, spots of
// different sensors or robots, no calibration, not connected, a device, cancelled.
Expected<GapPass> gap_pass(Station& station, const DrivenGapPass& options);

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
