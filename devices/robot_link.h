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

enum class RobotMode { unknown, manual_reduced /* T1 */, manual_full /* T2 */, automatic, external, stopped, fault };
std::string_view to_string(RobotMode mode);
std::optional<RobotMode> robot_mode_from_string(std::string_view name);

// One linear pass over a spot: entry -> trigger -> exit, sensor's Y along the travel. Poses are base_from_flange.
struct MeasuringMove {
    std::string spot_id;
    Pose entry = Pose::Identity(), trigger = Pose::Identity(), exit = Pose::Identity();
    double speed_mm_s = 100;
    bool stop_at_trigger = false;  // measure standing still
};

// The robot fired the trigger for a spot. `base_from_flange` is what the controller reports, not necessarily where the
// flange was when the sensor exposed (trigger jitter).
struct TriggerEvent {
    std::string spot_id;
    std::int64_t host_time_ns = 0;
    std::optional<Pose> base_from_flange;
};

// One thread at a time. No call blocks longer than the driver's time-out; a silent controller is an Error.
class RobotLink {
public:
    virtual ~RobotLink() = default;
    virtual Expected<RobotIdentity> identity() = 0;
    virtual Expected<RobotMode> mode() = 0;
    virtual Expected<Pose> base_from_flange() = 0;
    // Starts the measuring program. Controllers that hold their own program compare the spots' names with it.
    virtual Expected<void> start_measuring(const std::vector<MeasuringMove>& moves) = 0;
    // Next trigger in order. Error (device) after `timeout`.
    virtual Expected<TriggerEvent> wait_trigger(std::chrono::milliseconds timeout) = 0;
    // The frame (base) that a region's path runs in, by its name on the controller: base_from_frame.
    virtual Expected<Pose> read_frame(const std::string& name) = 0;
    virtual Expected<void> write_frame(const std::string& name, const Pose& base_from_frame) = 0;
    // Teaching: goes to `base_from_flange` and stands still there. An Error (device) unless the driver can move.
    virtual Expected<void> move_to(const Pose& base_from_flange);
};

}  // namespace seamwright
