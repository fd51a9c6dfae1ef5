#pragma once
// Captures from live devices: what sensors and robot show at one stand, and what a session takes of it.

#include <memory>
#include <stop_token>
#include <vector>

#include "core/ids.h"
#include "devices/frame.h"
#include "projects/calibrate/session/session.h"
#include "projects/station/station.h"

namespace seamwright {

// One stand of the robot before a calibration target.
struct CalibrationShot {
    std::string sensor_id, robot_id;
    FramePtr stripe;
    FramePtr board;                        // with the laser off, where the sensor can switch it
    std::optional<Pose> base_from_flange;  // absent: no robot was asked
};
// Of each sensor asked for, in that order; an Error's place names its sensor.
using CalibrationShots = std::vector<Expected<CalibrationShot>>;

// `board`: a picture with the laser off and exposed for the surroundings is taken as well; laser and exposure are as
// before when this returns. Empty `robot_id`: no robot is asked. Error (device): not connected, no frame in time, the
// robot moved meanwhile.
Expected<CalibrationShot> take_shot(Station& station, const SensorId& sensor_id, const RobotId& robot_id,
                                    bool board, const std::stop_token& cancel);

// Whose pictures one capture takes, the session's own sensor first: that alone, or, of_all_sensors(),
// all of `connected` that know their camera and the session's robot.
std::vector<std::string> shot_sensors(const CalibrationSession& session, const Project& project,
                                      const std::vector<std::string>& connected);
// The session's settings with what the method takes over (CalibrationMethod::prepare), for shots of these sensors.
Expected<nlohmann::json> capture_settings(const CalibrationSession& session, const Project& project,
                                          const std::vector<std::string>& sensor_ids);

// What the shots give, with their pictures in the session's folder; of a sensor whose target is not seen, why. Reads
// the session only.
struct ShotCaptures {
    std::vector<CalibrationCapture> captures;
    nlohmann::json settings;
    std::vector<Error> refusals;
};
ShotCaptures captures_of_shots(const CalibrationSession& session, const Project& project,
                               nlohmann::json settings, const CalibrationShots& shots,
                               const std::stop_token& cancel);

// Error (input): chains in the session end in another frame than these; some are in the list already and were left out. What
// was added before a file's Error stays.
Expected<void> add_captures(CalibrationSession& session, std::vector<CalibrationCapture> captures,
                            nlohmann::json settings, bool verification);

// flange_from_sensor as far as known: given by the drawing, of the calibration in use, or as a simulated cell is
// built.
std::optional<Pose> known_mounting(const CalibrationSession& session, const Project& project);

}  // namespace seamwright
