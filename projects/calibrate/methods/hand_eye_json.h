#pragma once
// Pairs of poses as they stand in hand-eye data.

#include <nlohmann/json.hpp>

#include "core/calibration/pose/hand_eye.h"

namespace seamwright {

// The data of calibrate_hand_eye_json() (methods.h).
struct HandEyeData {
    Mount mount = Mount::eye_in_hand;
    std::vector<HandEyePair> pairs;
};
Expected<HandEyeData> parse_hand_eye_data(const nlohmann::json& data);

}  // namespace seamwright
