#pragma once
// What a region of spots will be able to tell, beyond its verdict (plan_region in correction.h).

#include <optional>
#include <span>
#include <string>

#include "core/correction/correction.h"

namespace seamwright {

// Covariance of D (tangent of pose.h, work object) that a measurement of the part displaced by `displacement`
// will state, and its two parts (see correction.h); measured_mm is ignored: the spots see the displaced
// contour. Infinite variances where the information is singular. Refuses what plan_region refuses.
struct PredictedCovariance {
    Matrix6 sum = Matrix6::Zero(), random = Matrix6::Zero(), systematic = Matrix6::Zero();
};
Expected<PredictedCovariance> predicted_covariance(std::span<const SpotObservation> spots,
                                                   const CorrectionOptions& options,
                                                   const Displacement& displacement = {});

// The further spot that helps most, with the noise of a middling one; nullopt where none of the places tried
// does (near the taught spots and at the corners of the box around them, edges along the axes and along the
// taught ones).
struct FurtherSpot {
    SpotObservation spot;
    std::string near;  // the taught spot that it lies at; empty: a corner of the box
    std::string edge;  // along which its contour runs, work object: "X" or "(0.30, 0.95, 0.00)"
};
std::optional<FurtherSpot> best_further_spot(std::span<const SpotObservation> spots,
                                             const CorrectionOptions& options);

}  // namespace seamwright
