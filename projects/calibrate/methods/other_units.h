#pragma once
// Data that do not fit as they are written, but do in another unit.

#include "projects/calibrate/methods/method.h"

namespace seamwright {

// The least angle of KUKA's A, B, C that no radians can be.
inline constexpr double kHalfTurnOfRadians = 3.2;

// Whether all angles of these poses, read as degrees, could be radians. That they are nobody can tell from them alone: a
// sensor that stands square to its part turns by 2 degrees and less.
bool may_be_radians(const std::vector<Pose>& poses);

// One sentence that names the quantity and its unit: "the angles of base_from_flange are radians: write degrees". Each of the
// method's quantities in turn is read as radians, inches, metres or micrometres, where its numbers allow it, and the data are
// solved again; empty: nothing serves. Ask where the answer does not serve as the data are written.
Text other_unit(const CalibrationMethod& method, const nlohmann::json& data, const ExcludedIds& exclude);

// Puts that sentence into an answer or a refusal that needs it. Robot poses that leave a stripe camera without its place on the
// flange need it too.
void name_other_unit(const CalibrationMethod& method, const nlohmann::json& data, const ExcludedIds& exclude,
                     Expected<CalibrationSolution>& solution);

}  // namespace seamwright
