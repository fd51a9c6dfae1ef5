#pragma once
// The detective of core/calibration/pose/convention_detective.h over a calibration's data: which convention are its
// poses written in? Nothing is changed by asking.
//
// {"verdict":"named|as_given|cannot_tell","sentence","tried" (readings),
//  "as_given":READING,"best":READING or null,"second":READING or null,"equal_poses" (of best and second),
//  "ratio","limit" (second's residual variance over the best's, and what chance reaches once in a thousand searches),
//  "offer":{LIST:CODE,..} or null}
// READING = {"conventions":{LIST:CODE,..},"words","residual_mm","verdict" (of the calibration read so)}; residual and
// verdict are null where the numbers cannot be read so or nothing was found. An offer is taken by putting it
// into the data as "pose_convention" (pose_lists.h), and by nobody but the person.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "projects/calibrate/methods/method.h"

namespace seamwright {

struct ConventionAnswer {
    DetectedConvention found;
    nlohmann::json result;
    nlohmann::json offer;            // "pose_convention" of the data; null: none
    std::vector<std::string> codes;  // the offer as "LIST=CODE"
};
// Error (input): data that the method refuses for another reason than its poses; no poses. Error (usage): a method
// without convention_fits: static's chain of poses is solved by one product and leaves no residual.
Expected<ConventionAnswer> detect_pose_convention(const CalibrationMethod& method, const nlohmann::json& data,
                                                  const ExcludedIds& exclude);

}  // namespace seamwright
