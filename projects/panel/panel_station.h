#pragma once
// A panel job (panel_job.h) on the station's devices: taught in the panel's zero position, then panel after
// panel measured, moved by one step through the safety gate, and measured again.
//
// The robot. Its program goes to the measuring position (the job's base_from_gripper) and fires once under
// the job's id; all sensors expose there. The way in runs in the frame `frame_name`: written by the gate's
// pass, read back, and confirmed (RobotLink::confirm) before the program is started once more to fire at the
// position that the corrected frame leads to. A panel that lies in tolerance there is confirmed; one that
// does not has its frame taken back and is told as refused.

#include "projects/model/run.h"
#include "projects/station/station.h"
#include "projects/station/teach.h"

namespace seamwright {

// `draft` (its gauges, sensors and pose) measured `repeats` times with the panel in its zero
// position: references, gap, flush, surface and profiles of its enabled places, and base_from_gripper as the
// robot reports it. Error: not connected, a device, cancelled, or a place was measured in fewer than half of
// the repeats; the sentence carries the last reason.
Expected<PanelJob> teach_panel(Station& station, const PanelJob& draft, const TeachOptions& options);

// Whether there is something to bring a panel to: every enabled place has its references.
bool is_taught(const PanelJob& job);

// One panel. As Station::run: device failures and cancelling end in the record's status, the record is in the
// file when this returns, the judged run before the first byte is written. RunStatus::ok: moved and found in
// tolerance; in a dry run: would have been moved. refused: by the gate, by the job's tolerances before the
// motion, or by the measurement after it. Error: not connected, no such job, no enabled place, what a place
// cannot be prepared with, the file.
Expected<RunRecord> run_panel(Station& station, const std::string& job_id, const RunOptions& options);

}  // namespace seamwright
