#pragma once
// Closed forms of A_i X C_i = Y; inner part of hand_eye.h.

#include <vector>

#include "core/geometry/pose.h"

namespace seamwright::hand_eye {

struct Closed {
    const char* name = "";
    Pose x = Pose::Identity();
    Pose y = Pose::Identity();
};

// Every closed form that the pairs allow (a singular one is left out). a.size() == c.size() >= 2.
std::vector<Closed> closed_forms(const std::vector<Pose>& a, const std::vector<Pose>& c);

}  // namespace seamwright::hand_eye
