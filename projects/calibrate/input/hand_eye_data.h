#pragma once
// Pairs of poses as they stand in hand-eye data, and what a reading of their conventions is judged by.

#include <nlohmann/json.hpp>

#include "core/calibration/pose/convention_detective.h"
#include "core/calibration/pose/hand_eye.h"

namespace seamwright {

// The data of hand-eye.
struct HandEyeData {
    Mount mount = Mount::eye_in_hand;
    std::vector<HandEyePair> pairs;
    RobotRepeatability robot;
};
Expected<HandEyeData> parse_hand_eye_data(const nlohmann::json& data);

// nullopt: nothing was found from these pairs.
std::optional<ConventionFit> convention_fit(Mount mount, const std::vector<HandEyePair>& pairs,
                                            const std::vector<std::string>& exclude);

}  // namespace seamwright
