#pragma once
// Path correction from sparse measures (methods.md 3; thesis 3.3): where has the part gone, from a few cuts that each
// see two of three directions.
//
// Model. Spot n was taught with sensor pose W_n = workobject_from_sensor and reference point r_n; now it measures m_n
// (both in the sensor frame, mm). The part has moved by D = workobject_from_movedworkobject. Residual
//     e_n(D) = diag(w_n) (r_n - W_n^-1 D^-1 W_n m_n),      minimise  sum |e_n|^2 / sigma_n^2
// (3.49, with D^-1 where the thesis writes T_corr). Weights are along the sensor's axes, 0 = not observed.
// What is returned is D, the frame shift that moves the path WITH the part: corrected frame = frame * D when D is
// expressed in that frame. Its inverse is never returned.

#include <Eigen/Core>
#include <array>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry/pose.h"

namespace seamwright {

// D as a type of its own, because its inverse sends the robot the wrong way.
struct Displacement {
    Pose workobject_from_movedworkobject = Pose::Identity();
    // The frame that carries the taught path onto the displaced part. `frame` is expressed like the work object.
    Pose corrected(const Pose& frame) const { return frame * workobject_from_movedworkobject; }
};

// The local shape of the contour at a spot, learnt from the profiles between entry and exit: the reference point as a
// function of travel y (mm, along the sensor's +Y, 0 at the trigger position), x(y) = r_x + x1 y + x2 y^2 + x3 y^3, z alike.
// Replaces the straight line along Y in the residual (5.1): without it a curved contour is mistaken by
// r - sqrt(r^2 - y^2) when the part slides along it.
struct ContourCurve {
    Eigen::Vector3d x_coefficients = Eigen::Vector3d::Zero();  // 1/1, 1/mm, 1/mm^2 for y, y^2, y^3
    Eigen::Vector3d z_coefficients = Eigen::Vector3d::Zero();
    double valid_from_mm = 0, valid_to_mm = 0;                 // travel range the profiles covered
};

struct SpotObservation {
    std::string id;
    Pose workobject_from_sensor = Pose::Identity();             // at teaching
    Eigen::Vector3d reference_mm = Eigen::Vector3d::Zero();     // r_n, sensor frame
    Eigen::Vector3d measured_mm = Eigen::Vector3d::Zero();      // m_n, sensor frame
    Eigen::Vector3d weights = {1, 0, 1};                        // sensor axes; Y is the travel direction
    double sigma_mm = 0.05;                                     // standard deviation of an observed coordinate (weight 1)
    std::optional<ContourCurve> curve;
};

struct CorrectionLimits {
    double translation_mm = std::numeric_limits<double>::infinity();   // length of D's translation
    double rotation_deg = std::numeric_limits<double>::infinity();     // angle of D's rotation
};

// Free degrees of freedom in the order x, y, z, a, b, c (KUKA letters: rotation about Z, Y, X of the work object).
using FreeDof = std::array<bool, 6>;
inline constexpr FreeDof kAllFree{true, true, true, true, true, true};

struct CorrectionOptions {
    FreeDof free = kAllFree;
    CorrectionLimits limits;
    // A direction is unobservable when its predicted sigma exceeds these (and always when the information is singular).
    double sigma_limit_mm = 1.0;
    double sigma_limit_deg = 0.5;
    // Leave-one-out test of single wrong spots, two-sided significance after Bonferroni over the spots.
    bool reject_outliers = true;
    double outlier_significance = 1e-3;
    int max_iterations = 50;
};

enum class CorrectionStatus {
    ok,
    under_determined,  // a free direction is not observed well enough; `unobservable` names it; displacement is identity
    over_limit,        // solved, but beyond the limits; displacement holds the solution
    not_converged      // the step did not shrink below 1e-9 mm / 1e-12 rad within max_iterations
};
std::string_view to_string(CorrectionStatus status);

struct SpotResidual {
    std::string id;
    Eigen::Vector3d residual_mm = Eigen::Vector3d::Zero();  // r - W^-1 D^-1 W m in the sensor frame, unweighted axes 0
    bool used = true;                                       // false: found to be wrong and left out
};

struct RegionCorrection {
    CorrectionStatus status = CorrectionStatus::not_converged;
    Displacement displacement;
    Matrix6 covariance = Matrix6::Zero();   // tangent of pose.h, work object; fixed degrees of freedom have rows of 0
    Eigen::Vector3d sigma_xyz_mm = Eigen::Vector3d::Zero();
    Eigen::Vector3d sigma_abc_deg = Eigen::Vector3d::Zero();  // of KUKA A, B, C
    double rms_mm = 0;                      // weighted rms of the used residuals
    int redundancy = 0;                     // observed coordinates minus free degrees of freedom
    std::vector<SpotResidual> spots;        // in the order given
    std::vector<std::string> unobservable;  // plain words: "translation along X", "rotation about the axis ..."
    std::string message;                    // one sentence: the verdict and how to cure it
    int iterations = 0;
};

// Refuses (Error): no spots, duplicate ids, non-finite numbers, sigma <= 0, negative weights, no free degree.
Expected<RegionCorrection> solve_region(std::span<const SpotObservation> spots, const CorrectionOptions& options);


// What a region will be able to tell, before anything is measured (measured_mm is ignored).
struct RegionPlan {
    CorrectionStatus status = CorrectionStatus::ok;  // ok or under_determined
    Matrix6 covariance = Matrix6::Zero();
    Eigen::Vector3d sigma_xyz_mm = Eigen::Vector3d::Zero();
    Eigen::Vector3d sigma_abc_deg = Eigen::Vector3d::Zero();
    Vector6 weakest_direction = Vector6::Zero();     // unit length after scaling rotations by the spots' spread
    std::string weakest;                             // in plain words
    std::vector<std::string> unobservable;
    int redundancy = 0;
    std::vector<std::string> uncontrolled;           // spots whose single wrong measure could not be found
    std::string advice;                              // which spot to add, where, in which orientation
};
Expected<RegionPlan> plan_region(std::span<const SpotObservation> spots, const CorrectionOptions& options);

}  // namespace seamwright
