#pragma once
// What the safety gate has passed, into the controller: written, read back, compared, and taken back where anything went wrong.

#include <functional>
#include <string>

#include "core/text.h"
#include "devices/robot_link.h"
#include "projects/gate/safety_gate.h"
#include "projects/model/run.h"

namespace seamwright {

// What a controller may change in the last digits of a frame between writing and reading.
inline constexpr double kReadBackToleranceMm = 1e-3;
inline constexpr double kReadBackToleranceDeg = 1e-4;

// Records an event durably; an Error means that it is not recorded.
using EventSink = std::function<Expected<void>(EventKind kind, const std::string& subject, const Text& text)>;

// Reads the old frame, records the attempt, writes, reads back and compares, and records that. If anything
// after the first byte sent goes wrong, the record included, that is an alarm: the old frame is written again
// and read back. Nothing is sent when the old frame cannot be read or is not the one that was judged, or when
// the attempt cannot be recorded.
PushRecord push_region(GatePass&& pass, RobotLink& robot, const EventSink& record);

// Does the frame that a push has written (precondition) still stand on the controller? `differs` in one sentence; `unread`:
// the controller does not say.
enum class FrameStands { yes, differs, unread };
struct FrameLook {
    FrameStands stands = FrameStands::unread;
    Text text;
};
FrameLook look_at_frame(const PushRecord& push, RobotLink& robot);

// Takes back a push that was written (precondition): a part is corrected with all its regions or with none.
// The old frame is written and read back, an event recorded (an alarm where that fails), `push` brought up to
// date. The permission to run must have been taken back before: a frame under a running application would
// make it jump.
void withdraw_push(PushRecord& push, RobotLink& robot, const EventSink& record,
                   EventKind kind = EventKind::alarm);

}  // namespace seamwright
