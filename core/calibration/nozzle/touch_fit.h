#pragma once
// The tip that explains a set of touches, and how sure it is. Model and noise: nozzle.h.

#include <optional>
#include <vector>

#include "core/calibration/nozzle/nozzle.h"

namespace seamwright::nozzle {

using Vector7 = Eigen::Matrix<double, 7, 1>;
using Matrix7 = Eigen::Matrix<double, 7, 7>;

inline constexpr double kUnstatedTouch_mm = 0.1;  // judged by as long as no scatter tells
inline constexpr double kOpen_mm = 2;             // a direction of the tip known worse is not determined
// Two places of the tip fit alike when their chi squared differs by less (chance: once in a thousand).
inline constexpr double kAlike = 10.83;

// What is given: the touches in use, and the priors. c = c0 + half u, rho = rho0 + spread v, u and v standard normal.
struct TouchSet {
    std::vector<Pose> poses;
    bool sphere = true;
    Eigen::Vector3d place_mm = Eigen::Vector3d::Zero();
    Eigen::Matrix3d half = Eigen::Matrix3d::Zero();  // half half^T = S
    double rho_mm = 0, spread_mm = 0;
    bool spread_stated = true;  // else spread_mm is assumed
    double robot_mm = 0, robot_rad = 0;
    std::optional<double> sigma_mm;
    std::optional<Eigen::Vector3d> near;  // programmed: one more place to start from
    int rows() const { return static_cast<int>(poses.size()) * (sphere ? 1 : 3); }
    TouchSet without(std::size_t i) const;
};

// Unknowns: t, u, v.
struct TouchFit {
    bool solved = false;
    Vector7 state = Vector7::Zero();
    Matrix7 covariance = Matrix7::Zero();                   // valid where determined
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  // of t, all else eliminated
    Eigen::Matrix3d random = Eigen::Matrix3d::Zero(), systematic = Eigen::Matrix3d::Zero();  // of t
    double cost = 0;                       // chi squared, priors included
    double misfit = 0, freedom = 0;        // chi squared of the touches alone, and its expectation
    double variance = 0;                   // of a touch, mm^2
    bool estimated = false;                // from the scatter
    std::optional<Eigen::Vector3d> other;  // a second place that fits as well
    bool determined() const;
};

// e of one touch at a state, mm: the sphere's in the first.
Eigen::Vector3d residual(const TouchSet& set, const Pose& pose, const Vector7& state);

// The information that one more touch of this attitude and contact normal (base, from the centre to the tip) brings.
Matrix7 information_of(const TouchSet& set, const Eigen::Matrix3d& attitude, const Eigen::Vector3d& normal,
                       const Eigen::Vector3d& tip, double variance);
// Of t alone out of that of all unknowns, the priors added.
Eigen::Matrix3d information_of_tip(const Matrix7& of_touches);
// The touches' own at a state.
Matrix7 information_at(const TouchSet& set, const Vector7& state, double variance);

// From the linear solutions and the programmed tool. The variance is the stated one, `variance` where given, else
// estimated.
TouchFit fit_touches(const TouchSet& set, std::optional<double> variance = {});

}  // namespace seamwright::nozzle
