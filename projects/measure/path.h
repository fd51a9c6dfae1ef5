#pragma once
// The application path of a project, corrected point by point by what a run found (core/correction/
// path_blend.h). Nothing is sent to a robot: the result is a path for the application program, to be run in
// the taught frame. What stands between a number and a robot holds here as well:
//   - every region that the path uses must have passed the safety gate in that run, or have been refused for nothing but spots
//     that contradict a rigid frame while its modes acted;
//   - at every point, the displacement's translation and angle and the point's sigma must keep the limits of
//     its region; within a transition the limits go over from one region's to the next's with the blend.
// Where a region's modes acted in the run (run.h), the joint solution is found again from the run's spots, the path is
// moved by its displacement and then bent by the modes across itself (core/elastic/bead_shape.h), with their sigma; what they
// add keeps RegionModes::most_added_mm.

#include <string>
#include <vector>

#include "core/correction/path/path_blend.h"
#include "core/text.h"
#include "devices/exchange/tables/path_csv.h"
#include "projects/model/project.h"
#include "projects/model/run.h"

namespace seamwright {

enum class PathFrame { base, workobject };  // what the points are expressed in

struct PathRefusal {
    std::string region_id;
    std::size_t point = 0;   // the first one, from 0
    std::size_t points = 0;  // how many; 0 = the region altogether
    Text reason;
};

struct PathAnswer {
    ApplicationPath path;  // corrected, in the frame in which it was given, with every point's region
    std::vector<std::string> region_ids;  // index of CorrectedPath
    CorrectedPath corrected;
    std::vector<PathRefusal> refusals;  // empty: the path may be run
    bool ok() const { return refusals.empty(); }
};

// Regions of points that name none: with one region it is that one, else that of the nearest spot (its
// reference) which the regions in question do not share.
// Error (input): an unknown region in the path, no region can be told, what correct_path() refuses.
Expected<PathAnswer> correct_application_path(const Project& setup, const RunRecord& run,
                                              const ApplicationPath& path, PathFrame frame,
                                              const PathBlendOptions& options);

}  // namespace seamwright
