#pragma once
// A panel's run with the profiles that its places were measured in, for a screen: each head's and what became of
// them, computed again from the run's captures as replay does.

#include <span>
#include <string>
#include <vector>

#include "projects/model/project.h"
#include "projects/model/run.h"

namespace seamwright {

// In the place's frame: x along the surfaces from panel to body or back, z across, mm.
struct PlaceProfiles {
    std::string place_id;
    std::vector<std::string> sensor_ids;
    std::vector<Profile> heads;  // one, or two of a double head; empty where no profile was tracked
    Profile merged;              // what was measured in
    Eigen::Vector2d middle_mm = Eigen::Vector2d::Zero();  // of the gap as measured, else as taught (x, z)
};

// Of `measured`, the run's `before` or `after`; places that the job no longer has are left out. Error: what
// PanelMeasurer::make() refuses.
Expected<std::vector<PlaceProfiles>> place_profiles(const Project& project, const PanelJob& job,
                                                    const RunRecord& run,
                                                    std::span<const PanelMeasurement> measured);

struct MeasuredPanel {
    RunRecord run;  // without captures
    PanelJob job;   // as it was measured with
    std::vector<PlaceProfiles> before, after;
};
Expected<MeasuredPanel> with_profiles(const Project& project, RunRecord run);

}  // namespace seamwright
