#pragma once
// A calibration from live devices without a screen: the session of projects/calibrate/session, led from its first
// capture to the project by poses that the robot is sent to (a simulated one) or waited for.

#include <chrono>
#include <functional>
#include <map>
#include <stop_token>

#include "projects/calibrate/session/session.h"
#include "projects/station/station.h"

namespace seamwright {

struct LiveCalibrationOptions {
    std::string sensor_id;
    std::string robot_id;                    // empty: the project's only one
    std::map<std::string, double> settings;  // by MethodSetting's name
    int captures = 0;                        // to solve with; 0: as many as the method advises
    int verification = 1;                    // kept back, where the method can
    bool anew = false;                       // begins over; else a session that was begun is resumed
    bool use = false;                        // put to use when it is verified
    // For a robot that somebody else moves: how long the next pose is waited for.
    std::chrono::milliseconds patience{300000};
    std::function<void(const Text&)> said;  // where to go, what was taken or not seen
    std::stop_token cancel;
};

struct LiveCalibration {
    CalibrationSolution solution;
    Verification verification;
    int captures = 0;                 // solved with
    std::vector<std::string> stored;  // calibrations in the project; empty: not verified, or no good
    bool used = false;
};

// The station is connected. Every capture is on disk when it is taken; what was taken before an Error is resumed by the
// next call. A capture is taken where the robot has stood still for half a second, 3 mm or a degree away from those
// before. Error (usage): a method whose data come from files, no such sensor or robot; (device): no frame, no pose, the
// robot has not moved in time, cancelled; (input): a simulated target that is not seen.
Expected<LiveCalibration> calibrate_live(Station& station, const CalibrationMethod& method,
                                         const LiveCalibrationOptions& options);

}  // namespace seamwright
