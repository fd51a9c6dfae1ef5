#pragma once
// The nozzle that lays the bead: which calibration of it is in use, what its error is at the bead, and whether a collision
// came after it.
//
// The correction moves the frame of a program that trusts the tool. The tip errs in the flange by N(0, C), the bead by
// R C R^T with R the flange's attitude where the bead is laid. The project does not know that attitude (the program
// does), so the error counts with the direction of C that is known worst, in every direction across the bead: never too
// little. It is systematic: the same at every part until the nozzle is touched again. A path that was taught by touching
// the part with this very nozzle does not have it.

#include <string>

#include "projects/model/project.h"

namespace seamwright {

// The newest calibration of the robot's nozzle that is good or usable; nullptr: none.
const Calibration* nozzle_of(const Project& project, const std::string& robot_id);
// One standard deviation of the tip along the direction that is known worst. Precondition: nozzle.
double nozzle_sigma_mm(const Calibration& calibration);

// Why the nozzle's calibration in use does not hold: a collision after it, another robot than it was made on. Empty: it
// holds, or there is none.
Text nozzle_trouble(const Project& project, const std::string& robot_id);

// The robot that runs a region's frame: of its first spot. nullptr: none.
const RobotSetup* robot_of(const Project& project, const Region& region);
// nozzle_sigma_mm of that robot's nozzle; 0 where none is calibrated.
double nozzle_sigma_mm(const Project& project, const Region& region);

// Of ISO 8601 dates: something made at `created_utc` is older than the collision, or one of the dates cannot be read.
// False without a collision.
bool before_collision(const std::string& created_utc, const std::string& collided_utc);
// When it collided last; empty: never, as far as is known.
std::string last_collision(const Project& project, const std::string& robot_id);

// A robot that is said to have collided, now where `utc` is empty. Error (input): no such robot; a date that is none, lies
// in the future or before the last one.
Expected<void> mark_collision(Project& project, const std::string& robot_id, const std::string& utc);
// Takes the last mark back. Error (input): there is none.
Expected<void> take_collision_back(Project& project, const std::string& robot_id);

}  // namespace seamwright
