#pragma once
// The uncertainty budget of a region's correction (GUM, JCGM 100): which error contributes how much of the
// covariance that the correction states.
//
// With B = (J^T Omega J)^-1 after the sensors' errors are eliminated, e the residual of spot n whitened by
// flat_n, Omega_n its weights and J_n its rows freed of what the sensor's errors take, the estimate errs by
//     d(xi) = - B (sum_n J_n^T Omega_n flat_n eps_n  +  sum_s gain_s u_s),
// eps_n the spot's own errors and u_s the sensor's in units of their priors (nuisance.h). All are independent,
// so each has its share
//     C_k = B (sum_n J_n^T Omega_n flat_n cov_k,n flat_n^T Omega_n J_n) B    of a spot,
//     C_k = B (sum_j gain_s,j gain_s,j^T) B                                  of a sensor (columns j of it),
// and the shares add up to the covariance of correction.h exactly. As taught the sensors' shares are 0, but for drift;
// work object and the robot's drift are shares by themselves.

#include <span>
#include <string_view>
#include <vector>

#include "core/correction/correction.h"

namespace seamwright {

// In the order of a budget's rows.
enum class ErrorSource {
    feature,    // noise of the profile, as the feature sees it
    stated,     // the spot's own sigma, typed
    travel,     // the trigger's jitter along the displaced contour
    robot_run,  // the arrival of the run
    reference,  // taught once, the same ever after, as all below
    robot_taught,
    nozzle,       // of the bead, not of D: no term of an UncertaintyBudget (projects/proof/budget.h)
    offset,       // a kept one that acts: no term either
    workobject,   // that the path is laid in, against that of the measuring
    robot_drift,  // of the robot as a whole, since the last check
    hand_eye,
    scale_x,
    scale_z,
    shear,
    latency,
    speed,  // of the run against that of the teaching
    sensor_drift
};
std::string_view to_string(ErrorSource source);
inline bool is_systematic(ErrorSource source) {
    return source >= ErrorSource::reference;
}
inline bool is_of_sensor(ErrorSource source) {
    return source >= ErrorSource::hand_eye;
}
// Stated as a share, 1/1.
inline bool is_share(ErrorSource source) {
    return (source >= ErrorSource::scale_x && source <= ErrorSource::shear) || source == ErrorSource::speed;
}

// A spot before its part is displaced, and what its noise is made of.
struct BudgetSpot {
    SpotObservation spot;        // without travel; measured_mm is ignored
    double stated_sigma_mm = 0;  // share of the noise, every axis alike; the rest is the feature's
    double half_window_mm = 0;   // the trigger comes anywhere in it, uniform
    // Of the feature's and the reference's covariance, which are estimates themselves. Infinite: known.
    double feature_degrees = std::numeric_limits<double>::infinity();
    double reference_degrees = std::numeric_limits<double>::infinity();
};

struct BudgetTerm {
    ErrorSource source = ErrorSource::feature;
    std::size_t of =
        0;  // index of the spot, or of the sensor in CorrectionOptions::sensors; 0 of what D alone errs by
    // What errs, one standard deviation: mm along an observed axis of the spot (mean square of them), of the
    // travel mm along it, of hand-eye mm of a point measured along x or z (mean square over the sensor's spots,
    // from the reference), of scale, shear and speed 1/1, of latency mm along the travel (mean square), of drift and work
    // object mm (mean square of X, Y and Z).
    double input_sigma = 0;
    Matrix6 covariance = Matrix6::Zero();  // its share of D's, tangent of pose.h, work object
    DofSigma sigma;                        // the same of the printed numbers
};

struct UncertaintyBudget {
    bool determined = false;        // false: the information is singular, and there are no terms
    std::vector<BudgetTerm> terms;  // those of priors other than 0, in no particular order
    Matrix6 covariance = Matrix6::Zero();
    DofSigma sigma;
};

// Of the part displaced by `displacement`. Refuses what plan_region refuses.
Expected<UncertaintyBudget> uncertainty_budget(std::span<const BudgetSpot> spots,
                                               const CorrectionOptions& options,
                                               const Displacement& displacement);

}  // namespace seamwright
