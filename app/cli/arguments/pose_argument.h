#pragma once
// A pose on the command line.

#include <string>

#include "core/error.h"
#include "core/geometry/pose.h"

namespace seamwright::cli {

// The JSON itself or a file that holds it; identity where the argument is empty.
Expected<Pose> read_pose_argument(const std::string& argument, const std::string& where);

// The place of something, whose lengths are asked for where they look like metres: a coordinate is not zero and none reaches the
// least. What `calibrate` and pose_json() write (xyz, abc and matrix) is believed. `field`: what an answer of `calibrate --json`
// that holds the pose calls it.
inline constexpr double kLeastPlace_mm = 10;  // a sensor sees farther, frames stand farther off
inline constexpr double kLeastTool_mm = 1;    // a changer's plate may be thin
Expected<Pose> read_place_argument(const std::string& argument, const std::string& where, double least_mm,
                                   const char* field = "");

}  // namespace seamwright::cli
