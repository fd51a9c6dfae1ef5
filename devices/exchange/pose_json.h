#pragma once
// Poses as JSON and the pose files of recordings.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "core/geometry/pose.h"

namespace seamwright {

// One POSE of the command line's contract, exactly one form:
//   {"xyz":[mm],"abc":[deg]}          KUKA A, B, C (C.18)
//   {"xyz":[mm],"quat_wxyz":[4]}      unit quaternion, w first (norm within 1e-3 of 1, then normalised)
//   {"xyz":[mm],"rotvec_rad":[3]}     axis times angle in radian, at most one turn
//   {"matrix":[16 row-major]} or {"matrix":[[4],[4],[4],[4]]}    translation in mm in the last column
// What pose_json() writes (xyz, abc and matrix) reads back too: the matrix counts, and xyz and abc must
// agree with it within 1e-4 mm and 1e-4 degrees, so that an edit of one of them alone is found. Refused with
// the JSON path: any other mixture, unknown fields, wrong lengths, texts, NaN, non-orthonormal or mirrored
// matrices, translations beyond 100 m, angles beyond 720 degrees.
Expected<Pose> parse_pose(const nlohmann::json& json, const std::string& where);
nlohmann::json pose_json(const Pose& pose);

// Pose files beside recorded frames. The format, not the numbers, decides the unit; a metre format whose
// translation exceeds 50 is refused as "millimetres in a file of metres".
//   .txt         one line ((x, y, z), (qx, qy, qz, qw)), metre; commas, blanks and brackets only separate
//   (openlmd/etna) .yaml .yml   seven lines `x: 0.7` ... `qw: 1`, keys x y z qx qy qz qw, metre
//   (robot_cal_tools) .json        a POSE as above, or an object with a POSE under "base_from_flange",
//   millimetre
// Quaternions must have norm 1 within 1e-3.
Expected<Pose> parse_tuple_pose(std::string_view text, const std::string& where);
Expected<Pose> parse_yaml_pose(std::string_view text, const std::string& where);
Expected<Pose> read_pose_file(const std::filesystem::path& path);

}  // namespace seamwright
