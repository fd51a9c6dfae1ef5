#pragma once
// Poses as JSON of other hands: POSE of pose_json.h, whose keys say the notation and not the units. Lengths are in millimetres and
// abc in degrees unless the person says another unit, or the numbers look like one (lengths as in pose_table.h; angles by
// turns_of_radian()); only what pose_json() itself writes (xyz, abc and matrix) is millimetres and degrees whatever the numbers
// look like.

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "devices/exchange/tables/pose_table.h"

namespace seamwright {

// A half or a quarter turn of radian is among the angles, and none above: they are no degrees. A sensor that looks straight ahead
// has angles of a few degrees, which prove nothing.
bool turns_of_radian(std::span<const double> angles);

// {"NAME": POSE, ..} or [POSE, ..], as the file has them (not brought to the flange). Error (input): no pose, a unit that must be
// said, an option that cannot act.
Expected<PoseTable> parse_json_poses(std::string_view text, const std::string& where,
                                     const PoseLayout& layout);

// A POSE, or one under "base_from_flange", in each file; of the flange in the robot's base. The units of all are judged together.
Expected<std::vector<Pose>> read_json_poses(std::span<const std::filesystem::path> files,
                                            const PoseLayout& layout);

}  // namespace seamwright
