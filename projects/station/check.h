#pragma once
// Is a project plausible, and may a robot move by it? Judged before a device is touched.

#include <vector>

#include "core/error.h"
#include "projects/model/project.h"

namespace seamwright {

// Empty when plausible; else one Error per finding (unknown ids, duplicates, spots without region, ...).
std::vector<Error> check(const Project& project);
// Error (input) where another region, of the same type, or a panel job writes the frame that this region names, which no
// controller tells from another spelling of its letters (same_frame()). `region` may be one that the project is to get.
Expected<void> frame_of_its_own(const Project& project, const Region& region);
// Those of them that concern how the robot moves: while it measures the enabled spots, and with `push` in the
// frames of the regions. No run begins while there is one. The second: of a panel job.
std::vector<Error> motion_findings(const Project& project, bool push);
std::vector<Error> motion_findings(const Project& project, const PanelJob& job, bool push);
// What of them keeps a robot from its spots where it stands at each; it says nothing of passing them.
std::vector<Error> standing_findings(const Project& project);
// called_type(), refused too where the project of that type has such findings or no enabled spot.
Expected<std::string> runnable_type(const Project& project, const std::string& id_or_number, bool push);
// The first of them, which says how many more there are.
Expected<void> none_of_motion(const std::vector<Error>& findings);

}  // namespace seamwright
