#pragma once
// How well the robot comes back to a pose, as a calibration's data state it ("robot":{"sigma_mm","sigma_deg"}): ISO
// 9283's RP is about three times that. Of a few captures the scatter tells it badly; what is stated is always propagated,
// and what the captures show counts beside it where they show more.

#include "core/error.h"

namespace seamwright {

// Of one arrival at a pose, at the flange and in its axes, independent from arrival to arrival. 0: not stated.
struct RobotRepeatability {
    double sigma_mm = 0, sigma_rad = 0;  // each axis, about each axis
    bool stated() const { return sigma_mm > 0 || sigma_rad > 0; }
};

// Of a point so far from the flange, along each axis (mm): an arrival's shift and what its turn moves there.
double place_sigma_mm(const RobotRepeatability& robot, double lever_mm);

// Error (input): negative, not finite, above 10 mm or 5 degrees.
Expected<void> check_repeatability(const RobotRepeatability& robot);

}  // namespace seamwright
