#pragma once
// The release of a run whose frames are pushed: of the regions of a part (station.h), of a panel job
// (panel_station.h). What the run's record says and what the robots were told are kept together here.

#include <map>
#include <string>
#include <vector>

#include "projects/file/project_file.h"
#include "projects/gate/release.h"

namespace seamwright {

// The frames of a run, wherever they stand in the record.
std::vector<PushRecord*> pushes_of(RunRecord& run);

// Writes the old frames back where nobody may run in the pushed ones: every push that is written and neither
// taken nor given.
void restore_frames(RunRecord& run, const std::map<std::string, RobotLink*>& robots, const EventSink& record,
                    EventKind kind);

// A run that is recorded as `pushed`: tells every robot (`robots`: all that wait for the verdict) that the
// part is corrected, waits until those with a pushed frame have taken that, and brings the record to its end:
//   ok         all have taken it; message `text`
//   not_taken  the others have none, their old frames are back
//   alarm      a robot did not acknowledge, an old frame is not back, or it is not sure what a robot may do
void release_run(RunRecord& run, const std::map<std::string, RobotLink*>& robots, const Text& text,
                 const HoldOptions& hold, const EventSink& record);

// The outcome of a push, durable: what the file does not take at once it may take a moment later. Success too
// where the application runs and the file can only say `pushed`, which is true: then an event of the record
// (not of the file) tells. Any other outcome that is not recorded is the file's Error.
Expected<void> record_outcome(RunRecord& run, const std::function<Expected<void>()>& store);

// A run that was left as `pushed` by a program that ended: asks the robots what became of it, takes back what
// was not taken, and records that. Nothing is written to a frame. The run stays `pushed` where a robot does
// not answer (asked again at the next time) and where its permission ended with the link.
void resolve_release(ProjectFile& file, const std::map<std::string, RobotLink*>& robots);

}  // namespace seamwright
