#pragma once
// A pose on the command line.

#include <string>

#include "core/error.h"
#include "core/geometry/pose.h"

namespace seamwright::cli {

// The JSON itself or a file that holds it; identity where the argument is empty.
Expected<Pose> read_pose_argument(const std::string& argument, const std::string& where);

}  // namespace seamwright::cli
