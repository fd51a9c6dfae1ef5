#pragma once
// The verdict on a hand-eye. Inner part of hand_eye.h.

#include <string>

#include "core/calibration/pose/hand_eye.h"
#include "core/calibration/pose/hand_eye/hand_eye_break.h"

namespace seamwright::hand_eye {

struct HandEyeEvidence {
    int stands = 0;       // different robot poses
    double reach_mm = 0;  // mean distance of the target from the camera
    bool robot_stated = false;
    std::optional<Break> bump;
    std::string bumped_at;  // id of the pair that the change is seen from
    Text mistake;           // what was probably confused; empty: nothing known
};

// Beyond chance and beyond what pitches and robots are known to.
bool size_is_off(double size, double sigma);

// Sets result.fits. `result` holds all else.
Judgement judge_hand_eye(const HandEyeEvidence& evidence, HandEyeResult& result);

}  // namespace seamwright::hand_eye
