#pragma once
// The interface of every robot controller.

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/pose.h"

namespace seamwright {

struct RobotIdentity {
    std::string driver;  // registry name: "simulated", "replay", "kuka-eki", ...
    std::string brand, model, serial;
    bool operator==(const RobotIdentity&) const = default;
};

enum class RobotMode {
    unknown,
    manual_reduced /* T1 */,
    manual_full /* T2 */,
    automatic,
    external,
    stopped,
    fault
};
std::string_view to_string(RobotMode mode);
std::optional<RobotMode> robot_mode_from_string(std::string_view name);

// Enough for one exposure.
inline constexpr double kStand_s = 0.1;

// A frame that the application runs a path in, and its number in the program, from 1.
struct NumberedFrame {
    int number = 0;
    std::string name;
    bool operator==(const NumberedFrame&) const = default;
};

// One linear pass over a spot: entry -> trigger -> exit, sensor's Y along the travel. Poses are
// base_from_flange.
struct MeasuringMove {
    std::string spot_id;
    std::vector<Pose> via = {};  // passed in this order on the way to the entry, at travelling speed
    Pose entry = Pose::Identity(), trigger = Pose::Identity(), exit = Pose::Identity();
    double speed_mm_s = 100;
    bool stop_at_trigger = false;            // measure standing still
    double stand_s = kStand_s;               // how long it stands after the trigger, where it does
    std::vector<NumberedFrame> frames = {};  // that it is measured for
};

// The robot fired the trigger for a spot. `base_from_flange` is what the controller reports, not necessarily
// where the flange was when the sensor exposed (trigger jitter).
struct TriggerEvent {
    std::string spot_id;
    std::int64_t host_time_ns = 0;
    std::optional<Pose> base_from_flange;
};

// The line calls for a part to be measured. `part_id` is empty where the controller does not know it.
struct StartSignal {
    std::string part_id;
    std::int64_t host_time_ns = 0;  // when it was heard, steady clock
    // It was not called before this instant, when the controller was last heard without the call: a moment
    // ago between two parts, before the outage after one. 0: nothing is known of before.
    std::int64_t not_before_ns = 0;
    // The part's type, by the id or the number that the project knows it by; empty where the controller says none.
    std::string part_type = {};
};

// How a part ended, as the controller is told. Only `corrected` lets the application run with the frames
// written.
enum class PartVerdict { corrected, refused, failed };
std::string_view to_string(PartVerdict verdict);

// What became of the permission to run the application, as the controller tells it.
enum class Permission {
    none,     // not given, or taken back: the application stands
    given,    // it may begin and has not yet; a lost connection takes the permission back
    running,  // it runs and needs this connection to its end (corrections in every cycle)
    taken     // it is the application's until the part ends; a lost connection changes nothing any more
};
std::string_view to_string(Permission permission);

// One thread at a time. No call blocks longer than its own or the driver's time-out. Errors are of kind
// device: a silent controller is one that is_silence() knows. After a lost connection the call that met it
// fails, and later calls connect anew (backing off between attempts), so a link recovers when its controller
// does; who answers then is asked by identity(), which is never remembered across connections.
//
// A frame that was written counts for the application only after confirm(corrected); a start of measuring, a
// lost connection and any other verdict take the permission back, until the application has taken it: then
// frames and permission are its own to the end of the part. So whatever breaks between writing and reading
// back, no unverified frame is used, and who ends the link must first see permission() say `taken`.
class RobotLink {
  public:
    virtual ~RobotLink() = default;
    virtual Expected<RobotIdentity> identity() = 0;
    virtual Expected<RobotMode> mode() = 0;
    // False where the protocol has no word for it: mode() is unknown then, for ever. An `unknown` of a robot
    // that can tell is one that nobody may rely on.
    virtual bool tells_mode() const { return true; }
    // False where the permission lives in the link alone (a correction in every cycle): a link that was
    // opened later cannot tell what the application has taken before.
    virtual bool permission_outlives_link() const { return true; }
    // The newest pose that the controller told; fresh within the driver's time-out.
    virtual Expected<Pose> base_from_flange() = 0;
    // The controller's call for the next part. Silence after `timeout`: it has not come; a controller that is
    // silent itself or away is told otherwise (fell_silent() of silence.h). An Error unless the driver has
    // such a signal. A call that is not to be measured is answered by confirm(refused).
    virtual Expected<StartSignal> wait_start(std::chrono::milliseconds timeout);
    // Starts the measuring program, or lets one go on that waits after its start signal. Controllers that
    // hold their own program compare the spots' names with it.
    virtual Expected<void> start_measuring(const std::vector<MeasuringMove>& moves) = 0;
    // Next trigger in order. Silence after `timeout`, as with wait_start(); where the connection was lost
    // since the start of measuring and triggers with it, an Error at once.
    virtual Expected<TriggerEvent> wait_trigger(std::chrono::milliseconds timeout) = 0;
    // The frame (base, work object) that a region's path runs in, by its name on the controller:
    // base_from_frame.
    virtual Expected<Pose> read_frame(const std::string& name) = 0;
    virtual Expected<void> write_frame(const std::string& name, const Pose& base_from_frame) = 0;
    // Tells the controller how the part ended and waits for its acknowledgement. `text` is for its screen.
    // Nothing happens with a driver that has no such handshake.
    virtual Expected<void> confirm(PartVerdict verdict, const std::string& text);
    // What became of confirm(corrected). `taken` with a driver that has no such handshake: nothing waits
    // there.
    virtual Expected<Permission> permission();
    // Teaching: goes to `base_from_flange` and stands still there. An Error unless can_move().
    virtual bool can_move() const { return false; }
    virtual Expected<void> move_to(const Pose& base_from_flange);
    // The flange, which must be where it was sent, to kStandsMm and kStandsDeg: read once more, kSettles later, where it is
    // not. What answers that it has moved need not stand there: a controller may have taken the end of another motion for it.
    static constexpr double kStandsMm = 0.5, kStandsDeg = 0.1;
    static constexpr std::chrono::milliseconds kSettles{300};
    Expected<Pose> standing_at(const Pose& base_from_flange);
    // What the link has to tell since the last call beside its answers, a sentence each: peers that it
    // refused.
    virtual std::vector<Text> take_notices() { return {}; }
};

}  // namespace seamwright
