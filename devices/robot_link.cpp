#include "devices/robot_link.h"

#include <array>
#include <thread>

namespace seamwright {
namespace {
constexpr std::array kModes = {RobotMode::unknown,   RobotMode::manual_reduced, RobotMode::manual_full,
                               RobotMode::automatic, RobotMode::external,       RobotMode::stopped,
                               RobotMode::fault};
}

std::string_view to_string(RobotMode mode) {
    switch (mode) {
        case RobotMode::unknown:
            return "unknown";
        case RobotMode::manual_reduced:
            return "manual_reduced";
        case RobotMode::manual_full:
            return "manual_full";
        case RobotMode::automatic:
            return "automatic";
        case RobotMode::external:
            return "external";
        case RobotMode::stopped:
            return "stopped";
        case RobotMode::fault:
            return "fault";
    }
    return "unknown";
}

std::optional<RobotMode> robot_mode_from_string(std::string_view name) {
    for (const RobotMode mode : kModes) {
        if (to_string(mode) == name) return mode;
    }
    return std::nullopt;
}

std::string_view to_string(PartVerdict verdict) {
    switch (verdict) {
        case PartVerdict::corrected:
            return "corrected";
        case PartVerdict::refused:
            return "refused";
        case PartVerdict::failed:
            return "failed";
    }
    return "failed";
}

std::string_view to_string(Permission permission) {
    switch (permission) {
        case Permission::none:
            return "none";
        case Permission::given:
            return "given";
        case Permission::running:
            return "running";
        case Permission::taken:
            return "taken";
    }
    return "none";
}

Expected<StartSignal> RobotLink::wait_start(std::chrono::milliseconds) {
    return usage_error("this robot has no start signal", {}, "start each run by command");
}

Expected<void> RobotLink::confirm(PartVerdict, const std::string&) {
    return {};
}

Expected<Permission> RobotLink::permission() {
    return Permission::taken;
}

Expected<void> RobotLink::move_to(const Pose&) {
    return device_error("this robot cannot be moved from the program", {},
                        "move it by hand and read its position");
}

Expected<Pose> RobotLink::standing_at(const Pose& sent) {
    for (bool settled = false;; settled = true) {
        SEAM_TRY(const auto at, base_from_flange());
        const double off_mm = distance_mm(at, sent), off_deg = deg_from_rad(angle_rad(at, sent));
        if (off_mm <= kStandsMm && off_deg <= kStandsDeg) return at;
        if (settled)
            return device_error(
                Text("the robot stands {:.2f} mm and {:.2f} deg off the pose that it was sent to", off_mm,
                     off_deg),
                {}, "send it there again");
        std::this_thread::sleep_for(kSettles);
    }
}

}  // namespace seamwright
