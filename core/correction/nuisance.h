#pragma once
// The errors that all spots of one sensor share (see "What is the same again" in correction.h), as unknowns
// beside the displacement: b = (rho, theta, kappa_x, kappa_z, shear) = root u with u of unit variance, so
// that priors of 0 in some direction need no inverse.

#include <Eigen/Core>
#include <vector>

#include "core/correction/correction.h"

namespace seamwright::correction {

inline constexpr int kShared = 9;
using Rows = Eigen::Matrix<double, 3, 6>;
using SharedVector = Eigen::Matrix<double, kShared, 1>;
using SharedColumns = Eigen::Matrix<double, kShared, 3>;  // d(e)/du, a column per axis of the residual

// Where a spot stands, sensor frame, unscaled.
struct SharedGeometry {
    Eigen::Matrix3d axes;                 // the sensor's axes in the work object, columns
    Eigen::Vector3d origin;               // in the work object
    Eigen::Vector3d reference, measured;  // sensor frame
    Eigen::Matrix3d flat;                 // of the residual as PreparedSpot scales it
};

// Lower triangle with root root^T = covariance of (rho, theta), and the sigmas of scale and shear.
struct SharedRoot {
    Matrix6 hand_eye;
    Eigen::Vector3d scale;
};

// One sensor after elimination. With H the information in (xi, u): lower lower^T = H_uu + I, cross = H_xu,
// gain = H_xu (H_uu + I)^-1, gradient that of u, value = u at the fit.
struct SharedBlock {
    Eigen::Matrix<double, kShared, kShared> lower;
    Eigen::Matrix<double, 6, kShared> cross, gain;
    SharedVector gradient, value, inverse;  // the last: 1 / diagonal of lower
};

// A spot after elimination, scaled like its residual, unobserved axes 0: columns = de/du, rows = de/dxi less
// what the sensor's errors take, e the residual with them as estimated.
struct SharedSpot {
    SharedColumns columns;
    Rows rows;
    Eigen::Vector3d e;
};

struct Shared {
    std::vector<SharedBlock> sensors;
    std::vector<SharedSpot> spots;
    void clear() { sensors.clear(), spots.clear(); }
};

// A covariance to rounding: finite, symmetric, no negative variance in any direction.
bool semidefinite(const Eigen::Ref<const Eigen::MatrixXd>& covariance);
// Exactly symmetric and clearly positive: quicker to tell, and then semidefinite if finite.
bool definite(const Matrix6& covariance);

SharedRoot root_of(const SensorPrior& prior);
bool is_zero(const SensorPrior& prior);

// de/du for the residual's axis i, before scaling. `axis` = R e_i with e_i the sensor's axis in the work
// object and R the rotation of D; y = W^-1 D^-1 W m.
SharedVector shared_row(const SharedGeometry& spot, const SharedRoot& root, int i,
                        const Eigen::Vector3d& axis, const Eigen::Vector3d& y);

// Covariance of a point p (sensor frame) from one arrival's `covariance` of workobject_from_sensor = `pose`,
// along the sensor's axes. Without `travel` the row and column of Y stay 0.
Eigen::Matrix3d arrival_covariance(const Pose& pose, const Matrix6& covariance, const Eigen::Vector3d& p,
                                   bool travel = true);

// Cholesky of block.lower (holding H_uu + I in its lower triangle) in place, gain and value from cross and
// gradient.
void eliminate(SharedBlock& block);

// columns^T (lower lower^T)^-1 columns.
Eigen::Matrix3d left_uncertain(const SharedBlock& block, const SharedColumns& columns);

}  // namespace seamwright::correction
