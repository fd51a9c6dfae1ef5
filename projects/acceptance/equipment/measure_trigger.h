#pragma once
// Latency and jitter of a trigger, measured on the cell: passes over one spot at several speeds in both directions, and
// passes that stop there. First a pass standing still (record_pass) tells how the feature moves with the travel. The
// passes are measuring moves as in a run, entry to exit and back, with the orientation held and the robot told
// `refused` after each round; nothing is written to it. The mathematics is core/acceptance/equipment/trigger_study.h.
//
// A contour that stands still while it is passed (frozen, as a spot should be) shows nothing of the travel; then the
// travel has to cross it: `travel_deg` turns it from the sensor's Y towards its X.
//
// A controller that holds its own measuring program passes what is in it: it needs the program of these passes
// (trigger_program()), whose names carry the speeds, so that another program is refused.

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "devices/robot_program.h"
#include "projects/acceptance/study/studies.h"
#include "projects/station/station.h"

namespace seamwright {

struct MeasureTriggerOptions {
    std::string spot_id;              // empty: the one whose curve sees the travel best
    std::vector<double> speeds_mm_s;  // three or more; none: a quarter, a half and all of the spot's
    int passes = 10;                  // each way at each speed, 2 to 1000
    double travel_deg = 0;
    bool keep = true;  // sets latency and jitter and stores the evidence
    AcquireLimits limits;
    std::stop_token cancel;
    std::function<void(const RunProgress&)> progress;
};

struct MeasuredTrigger {
    TriggerPasses passes;
    // Absent: the pass does not see its own travel, and `unseen` says which would.
    std::optional<TriggerStudy> study;
    Text unseen;
    StudySource source;
    std::string utc;  // when it was stored; empty: it was not
    std::map<std::string, double>
        jitter_mm;          // by spot, as set, or as it would be: of the same robot and sensor
    double speed_mm_s = 0;  // the spot's own
};

// One round: every speed, the fastest last, and the stop, each there and back. Named SPOT_F100, SPOT_B100.
std::vector<MeasuringMove> trigger_moves(const Spot& spot, const Pose& flange_from_sensor, double travel_deg,
                                         const std::vector<double>& speeds_mm_s);

// What a controller's generator wants of that round. Error: as measure_trigger().
Expected<ProgramRequest> trigger_program(const Project& project, const MeasureTriggerOptions& options);

// Error: not connected, no such spot, one without calibration, speeds that are none, findings of check() that concern
// motion, the feature found in fewer than half of the passes, a device, cancelled, the file.
Expected<MeasuredTrigger> measure_trigger(Station& station, const MeasureTriggerOptions& options);

// What it finds becomes the project's; nothing where the pass did not see its travel.
void apply(const MeasuredTrigger& measured, Project& project);

// The newest stored study, compared with the project as it is `now` (nullptr: as it is saved). nullopt: none.
Expected<std::optional<MeasuredTrigger>> stored_trigger_study(const ProjectFile& file,
                                                              const Project* now = nullptr);

// Sets back what the newest study replaced. Error: none is stored.
Expected<void> undo_trigger_study(Station& station);

}  // namespace seamwright
