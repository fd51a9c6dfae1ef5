#pragma once
// A point of the drift watch from what a run measured.

#include <optional>
#include <span>

#include "projects/model/project.h"
#include "projects/model/run.h"

namespace seamwright {

// nullptr: the project has none of this id.
const Spot* drift_spot(const Project& project, const std::string& id);

// Whether a spot is one of the watch's.
bool is_drift_reference(const Project& project, const Spot& spot);
// Whether a project (of_type()) is the program of the references' own, which the robot calls between the parts: no region, and no
// enabled spot but theirs. There is nothing to correct or to push.
bool references_alone(const Project& project);

// What the watch's spots are measured with: poses, features, sensors, robots, calibrations, filters. Points of another mark
// are not compared. Where a spot is missing: of what is there.
std::uint32_t drift_mark(const Project& project, const DriftWatch& watch);

// nullopt: not every spot of the watch was measured by the run. running_s and pause_s are the caller's.
std::optional<DriftPoint> drift_point(const Project& project, const DriftWatch& watch, const RunRecord& run);

// The watch's spots are in the project, enabled and in no region: what a region measures moves with the part.
// Error (input): one is not, the same one twice, there is none, they are of several sensors and robots both.
Expected<void> check_drift_watch(const Project& project, const DriftWatch& watch);

}  // namespace seamwright
