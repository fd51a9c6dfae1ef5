#pragma once
// From "the robot may run its application in the frames" to "it does".
//
// A permission belongs to the link that gave it until the application has taken it (devices/robot_link.h):
// whoever pushed holds the link until then, and who gives up tells the robot so before the link ends.

#include <chrono>
#include <functional>
#include <map>
#include <stop_token>
#include <string>
#include <vector>

#include "core/text.h"
#include "projects/gate/push.h"

namespace seamwright {

inline constexpr std::chrono::milliseconds kHold{60000};
inline constexpr std::chrono::milliseconds kHoldForEver = std::chrono::milliseconds::max();

struct HoldOptions {
    // How long the application may take to begin; 0 = looked at once. One that runs and needs the link to its
    // end is waited for without end.
    std::chrono::milliseconds hold = kHold;
    std::stop_token cancel;
    std::function<bool()> part_over;  // the line calls for the next part: nobody will begin any more
    std::function<void(const Text& text)> progress = {};
    // Looked at every second while a robot has not taken its permission: a frame of it that is no longer the one written,
    // empty: none. The permission is taken back then.
    std::function<Text(const std::string& robot_id)> frame_changed = {};
};

struct RobotRelease {
    Release release = Release::given;  // `given`: it could not be made sure of, an alarm
    Text text;                         // one sentence
};

// Tells a robot that may have its permission already that it has none. Release::withdrawn: it is told and
// says so; taken: the application was quicker, frames and permission are its own; given: it does not answer.
// `running` too: an application that needs the link is stopped by it.
RobotRelease take_back(RobotLink& robot, PartVerdict verdict, const Text& text, bool running);

// After confirm(corrected): waits until the controllers say that their application has taken the permission.
// By robot: taken, not_taken (time or the next part), withdrawn (cancelled, or by the robot itself), given.
// Each outcome is an event.
std::map<std::string, RobotRelease> await_release(const std::map<std::string, RobotLink*>& robots,
                                                  const HoldOptions& options, const EventSink& record);

}  // namespace seamwright
