#pragma once
// A run whose path is corrected while it runs: measured and pushed as ever (station.h), and from the pushed frame on
// steered by the sensor that rides before the tool (seam_steering.h).
//
// One gate, one permission: the spots are measured, every region passes the gate, the frame is written and confirmed;
// only then may the path run, and only then anything is added. Refused before anything moves are a robot that takes no
// corrections in every cycle, a sensor without a calibration that serves, a latency that nobody has proven, a guide
// that is none. The online offset is limited by `limit_mm`; with the frame's own shift at the tool by the region's
// translation limit, and by the robot's settings in every cycle (devices/cyclic/corrector.h).
//
// An alarm of the steering or of the link leads the correction back and stops the path; the run is then an `alarm`
// with its reason, the frames are taken back. What was told is an event of the run in any case.
//
// The guide's table is kept in the project before anything moves (ProjectFile::keep_guide), and an event of the run names
// it with its hash: what the path was corrected by is known as long as the project.

#include <string>
#include <vector>

#include "projects/ahead/seam_steering.h"
#include "projects/panel/gap_check.h"
#include "projects/station/station.h"

namespace seamwright {

struct FollowOptions {
    std::string region_id;             // empty: the project's only one
    std::string sensor_id;             // empty: that of the spot
    std::string spot_id;               // whose recipe finds the contour; empty: the region's first
    std::string guide_csv;             // the contour as taught, work object: guide_csv()
    std::string guide_name;            // of its file, or where it comes from; for people
    std::optional<double> latency_ms;  // from the trigger to the exposure, as a person states it
    double limit_mm = 3;
    DelayLineOptions line;
    std::chrono::milliseconds frame_timeout{1000};
};

struct FollowedRun {
    RunRecord run;
    SteeringFigures figures;
    double guide_mm = 0, latency_ms = 0;
    std::string guide_hash;                   // as the project keeps it
    Pose base_from_moved = Pose::Identity();  // of the frame that was pushed, with the displacement taken off
};

// `run.push` is meant in any case. Error: what is refused before anything moves, and what Station::run() refuses.
Expected<FollowedRun> follow_run(Station& station, RunOptions run, const FollowOptions& options);

// The contour from a pass over the taught part (gap_check.h) by the recipe of a spot, smoothed (guide.h). Error: an
// unknown spot, or the contour is found in fewer than half of the profiles; with the last reason.
Expected<std::vector<GuidePoint>> taught_guide(const Project& project, const std::string& spot_id,
                                               const GapPass& pass);
inline constexpr double kGuideStepMm = 2, kGuideHalfWidthMm = 10;

// As a table of poses in the work object (KUKA notation, devices/exchange/tables/path_csv.h): X across, Y along, Z up.
// An edge of the drawing as `seamwright path` takes it is one too.
std::string guide_csv(const std::vector<GuidePoint>& guide);
// `where` is for the error.
Expected<std::vector<GuidePoint>> parse_guide(std::string_view csv, const std::string& where);

// What `called` names: the file of that name, or, where there is none, the guide that the project keeps of it.
struct NamedGuide {
    std::string name, csv;
};
Expected<NamedGuide> find_guide(const ProjectFile& file, const std::string& called);

}  // namespace seamwright
