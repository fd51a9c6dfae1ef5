#pragma once
// A POSE of JSON (pose_json.h) before it means anything.

#include <nlohmann/json.hpp>
#include <string>

#include "core/geometry/pose_convention.h"

namespace seamwright {

// The numbers of a POSE as they stand there, and as what the contract takes them (parse_pose() reads both to the
// same pose). Of a pose that pose_json() wrote the angles count. A 4 x 4 matrix may be by columns. Error (input):
// what is no form of a POSE; whether the numbers are a pose, read_pose() says.
struct WrittenPose {
    PoseNumbers numbers;
    PoseConvention as_given;
};
Expected<WrittenPose> written_pose(const nlohmann::json& json, const std::string& where);

}  // namespace seamwright
