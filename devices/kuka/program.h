#pragma once
// KRL for KSS 8.3 and later with EthernetKRL 2.2 and later.
//
// Seamwright.xml and seamwright_sub.sub (a task of the submit interpreter) talk to Seamwright;
// seamwright.src/.dat hold what measuring and application programs call; seamwright_spots.src/.dat are the
// project's: entry, trigger and exit of every spot as flange poses in the robot's base, linear, triggered
// path-synchronously at the spot (TRIGGER WHEN PATH), its via points rounded off before the entry, and the
// application frames.
//
// The application calls SW_SETUP() once, SEAMWRIGHT_SPOTS() for each part and SW_ACTIVATE(SW_name) before
// each region's path: seamwright_spots.dat holds the number of every frame as a constant, SW_ and the frame's name (24 signs at
// most). A region's number does not change when its spots are disabled; it has no frame then, and SW_ACTIVATE stops the robot.
// SEAMWRIGHT_SPOTS() calls for the part (its name in
// SW_PART[], its type in SW_TYPE[], which SW_SETUP() sets to the program's), waits until Seamwright lets it go and measures; the first SW_ACTIVATE waits for the verdict and
// takes the permission (RobotLink). SW_CALLS=FALSE: it waits without a call; the line sets SW_CALL, or
// Seamwright measures by command. SW_VERDICT tells an application that goes on without correction how the
// part ended.
//
// Of the robot's settings it reads "listen" and "port", and kuka_program_settings().

#include "devices/exchange/settings.h"
#include "devices/robot_program.h"

namespace seamwright {

// What the KUKA drivers' settings hold for the program alone.
const SettingTable& kuka_program_settings();

// Error (input): more than 64 spots or 32 frames, names that KRL cannot hold, a speed over 2 m/s, a "listen"
// that is no address of this computer.
Expected<std::vector<ProgramFile>> write_kuka_program(const ProgramRequest& request);

// NAME.src: sets $BASE to the points' frame, $VEL.CP and $APO.CDIS, and runs along the points. $TOOL is the
// caller's.
Expected<std::vector<ProgramFile>> write_kuka_path(const PathProgramRequest& request);

}  // namespace seamwright
