#pragma once
// Car after car without a screen: wait for the robot's start signal, measure, correct, push, tell the robot,
// wait for the next part. Lost devices are alarms, not the end: nothing is pushed while one is missing, and
// work goes on when it is back.

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <string_view>
#include <variant>

#include "core/text.h"
#include "projects/station/station.h"

namespace seamwright {

struct WatchCounts {
    std::int64_t parts = 0;  // started
    // Pushed and taken by the application (or, in a dry run, judged ok); refused, or not taken.
    std::int64_t corrected = 0, refused = 0;
    std::int64_t failed = 0, alarms = 0, lost = 0;  // runs with a device failure; pushes gone wrong; outages
    std::int64_t missed = 0;  // calls that were not measured: too old, or overtaken by a newer one
};

enum class WatchState { connecting, waiting, measuring, lost, stopped };
std::string_view to_string(WatchState state);

enum class WatchLevel { info, warning, alarm };
std::string_view to_string(WatchLevel level);

// What can happen, each with what belongs to it.
namespace watched {
struct Connected {};  // all devices answer; waiting for a call
struct Lost {
    std::string device;  // told once, however long it lasts
    ErrorCode code = ErrorCode::none;
};
struct Back {};         // all devices answer again
struct RobotNotice {};  // a robot said something that is no call
struct LineNotice {};   // the line beside the station did
struct Start {
    std::string part_id;
    std::string type_id = {};  // empty: the project has no part types
};
struct Missed {
    std::string part_id;     // called, but not measured
    bool part_type = false;  // because of its type: unknown, not said, or none that can be run
};
struct SpotDone {
    int done, total;
};
struct RunDone {
    std::shared_ptr<const RunRecord> record;
    double seconds;
    DriftStanding drift = {};  // after this run
};
struct ProjectNotice {
};  // the project was edited in the file; from now on it is measured with as it is there
struct Stopped {};
}  // namespace watched
using WatchHappening = std::variant<watched::Connected, watched::Lost, watched::Back, watched::RobotNotice,
                                    watched::LineNotice, watched::Start, watched::Missed, watched::SpotDone,
                                    watched::RunDone, watched::ProjectNotice, watched::Stopped>;
// connected | lost | back | robot | line | start | missed | spot | run | project | stopped
std::string_view name_of(const WatchHappening& happening);

// One thing that happened, for a screen and a log that machines read.
struct WatchEvent {
    std::string utc;  // ISO 8601
    WatchLevel level = WatchLevel::info;
    WatchHappening happening;
    Text text;  // one sentence
    WatchState state = WatchState::connecting;
    WatchCounts counts;
};

// A part as the line names it.
struct NamedPart {
    std::string part_id;
    int type = 0;   // PartType::number; 0: the line says none
    int paint = 0;  // names PaintLight::paint by its number; 0: the line says none
};

// The line beside the robots, as LineControl (projects/line/line_control.h) makes it. Every function returns at once.
struct WatchLine {
    // Its calls start the parts. A robot's own call is then taken note of, and that a part is over by it; it starts
    // none. false: the robots' calls do.
    bool starts = false;
    std::function<std::optional<StartSignal>()> call;
    std::function<bool()> given_up;  // the part that it called for
    // How the part that was called is to be named, by what the robot or the line called it; Error: it is not to be
    // measured, and why.
    std::function<Expected<NamedPart>(const std::string& part_id)> named;
    std::function<std::vector<Text>()> notices;
};

struct WatchOptions {
    bool push = false;
    bool keep_images = false;
    std::int64_t parts = 0;      // end after so many; 0 = never
    std::int64_t keep_runs = 0;  // older runs are deleted from the file; 0 = keep all
    // Where neither robot nor line says a part's type: its id or number. All who say one must say the same, or the part
    // is refused, as one is of an unknown type, of none, and of one that motion_findings() refuses: the robot is told,
    // the frames stay as they are.
    std::string part_type;
    std::string paint;  // where the line says none
    AcquireLimits limits;
    WatchLine line;
    // A call that may be older (StartSignal::not_before_ns), after an outage, is refused: another part may
    // stand there by now. Of several that wait the newest alone counts.
    std::chrono::milliseconds start_expiry{10000};
    std::chrono::milliseconds retry_first{100}, retry_longest{500};  // doubles between attempts
    // How often the sensors are asked, while no part comes, whether they are there (ProfileSource::answers).
    std::chrono::milliseconds ask_sensors{1000};
    // A robot whose part failed before its program went waits there for good. When all sensors answer and so long after
    // the failure (doubling from part to part) it is refused, upon which it calls once more.
    std::chrono::milliseconds call_again_first{1000}, call_again_longest{60'000};
    std::stop_token
        cancel;  // heard within kCancelSlice; a part in the middle ends as cancelled, the robot is told
    std::function<void(const WatchEvent&)> tell;  // on the watching thread
    // The same, several times a second while it waits, and at every step of a run: what a watchdog asks for.
    std::function<void()> alive;
};

// What others edit in the file counts from the next part on, see Station::follow_file().
// Connects the station where it is not. Ends by `cancel` or after `parts`. Error: the file cannot be written,
// or no robot of the project has a start signal; device failures are told and survived.
Expected<WatchCounts> watch(Station& station, const WatchOptions& options);

}  // namespace seamwright
