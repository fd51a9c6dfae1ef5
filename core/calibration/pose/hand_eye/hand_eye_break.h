#pragma once
// Whether the camera sits otherwise from one of the poses on: it was bumped while the poses were taken. Inner part of
// hand_eye.h.
//
// Break before pair k: X is one pose up to it and another from it on, six numbers more. Residuals across and along the
// sight, in tilt and in turn have variances of their own, estimated with the break in; F of the six numbers against what
// is left, times the number of places a break was looked for at (Bonferroni).

#include <cstddef>
#include <optional>

#include "core/calibration/pose/hand_eye/hand_eye_solve.h"

namespace seamwright::hand_eye {

struct Break {
    std::size_t first = 0;   // pair that the change is seen from
    double chance = 1;       // that pairs without a break show one as large
    double mm = 0, rad = 0;  // by what the target is seen elsewhere, rms over the pairs from there on; turn
};

// The likeliest break; nullopt: too few pairs on either side of any. All pairs are in use, in the order they were taken.
std::optional<Break> likeliest_break(const Chain& pairs, const Pose& x, const Pose& y);

}  // namespace seamwright::hand_eye
