#pragma once
// ABB Externally Guided Motion for path correction: the controller (option 689-1) runs SeamwrightEgm.mod
// (resources/robot/abb), moves by EGMMoveL and EGMMoveC and sends an EgmRobot message by UDP at its sample
// rate (multiples of 4 ms; EGMActMove \SampleRate, 24 to 48 ms is usual); Seamwright listens on port 6510 and
// answers each with an EgmSensorPathCorr. Messages: egm_message.h; ramp, alarms and lost packets:
// devices/cyclic/corrector.h; frames and common settings: devices/cyclic/link.h. Set "cycle_ms" to the sample
// rate.
//
// What the controller does with a path correction: it shifts the programmed position across the path. Only y
// and z of path coordinates count (x along the travel, y = tool z x x, z = x x y); a shift along the travel
// and turns are not made. So of the displacement B this driver tells, at the planned pose, the part of B p -
// p across the path; what is left over is the shift along the travel (no error of a seam that goes on) and
// the rotation, which is limited by "max_rotation_deg" (0.5 here). The travel's direction follows from the
// planned positions (of the measured ones less the correction where none are planned); until it is known zero
// is told. At a corner path coordinates turn at once: what is told follows with the ramp's speed.
//
// EGM does not tell whether an answer came in time: the newest one is taken, and kept where none comes. So
// each step is a quarter of the limit of a cycle, and three answers in a row may be lost (corrector.h). In
// force is what the measured pose shows against the planned one, across the path: a robot that stands has no
// direction of travel yet and one guided by joints no planned pose, so neither is confirmed, and confirm()
// says why.
//
// Nothing is corrected unless motors are on, RAPID runs and the MCI state is RUNNING; leaving that under a
// correction is an alarm, unless the path had come to its end and EGM is STOPPED: then the path is over
// (permission() `taken`). There is no release that could fall: a permission that goes while the path runs, by
// a verdict, an alarm or the end of the program, ends the answers, and the robot stops with CommTimeout of
// SeamwrightEgm.mod, its last correction in force until it stands. EGM tells no operating mode: without a
// measuring link mode() is unknown, stopped or fault. EGM talks from EGMSetupUC to EGMReset: a robot that is
// not at its path is silent here.
//
// Settings: abb_egm_settings(). "frame": "sensor" tells the same shift along the axes of the sensor frame that
// EGMActMove was given, for controllers that are set up so.

#include <memory>
#include <nlohmann/json.hpp>

#include "devices/cyclic/link.h"

namespace seamwright {

const SettingTable& abb_egm_settings();
Expected<std::unique_ptr<RobotLink>> open_abb_egm(const nlohmann::json& settings, DeviceSession& session,
                                                  OpenRobot open_robot);

}  // namespace seamwright
