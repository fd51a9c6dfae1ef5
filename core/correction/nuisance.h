#pragma once
// The errors that all spots of one sensor share (see "What is the same again" in correction.h), as unknowns
// beside the displacement: b = (rho, theta, kappa_x, kappa_z, shear, latency, speed, drift) = root u with u of unit
// variance, so that priors of 0 in some direction need no inverse.

#include <Eigen/Core>
#include <cstring>
#include <vector>

#include "core/correction/correction.h"

namespace seamwright::correction {

inline constexpr int kShared = 14;
// Where they stand in u.
inline constexpr int kScaleAt = 6, kShearAt = 8, kLatencyAt = 9, kSpeedAt = 10, kDriftAt = 11;
using Rows = Eigen::Matrix<double, 3, 6>;
using SharedVector = Eigen::Matrix<double, kShared, 1>;
using SharedColumns = Eigen::Matrix<double, kShared, 3>;  // d(e)/du, a column per axis of the residual

// Where a spot stands, sensor frame, unscaled.
struct SharedGeometry {
    double latency_travel = 0;
    Eigen::Matrix3d axes;                 // the sensor's axes in the work object, columns
    Eigen::Vector3d origin;               // in the work object
    Eigen::Vector3d reference, measured;  // sensor frame
    Eigen::Matrix3d flat;                 // of the residual as PreparedSpot scales it
};

// Lower triangle with root root^T = covariance of (rho, theta), and the sigmas of the others. `count`: beyond so many
// u are 0; one of 6, 9 and kShared.
struct SharedRoot {
    Matrix6 hand_eye;
    Eigen::Vector3d scale, drift;
    double latency = 0, speed = 0;
    int count = kShared;
};

// One sensor after elimination. With H the information in (xi, u): lower lower^T = H_uu + I, gain = H_xu (H_uu + I)^-1,
// value = u at the fit. Of lower and inverse the first `count` rows alone mean anything.
struct SharedBlock {
    SharedBlock() {}  // every number is written; clearing them first takes longer than that
    Eigen::Matrix<double, kShared, kShared> lower;
    Eigen::Matrix<double, 6, kShared> gain;
    SharedVector value, inverse;  // the last: 1 / diagonal of lower
    int count = kShared;          // as in SharedRoot
};

// A spot after elimination, scaled like its residual, unobserved axes 0: columns = de/du, rows = de/dxi less
// what the sensor's errors take, e the residual with them as estimated.
struct SharedSpot {
    SharedSpot() {}
    SharedColumns columns;
    Rows rows;
    Eigen::Vector3d e;
};

struct Shared {
    std::vector<SharedBlock> sensors;
    std::vector<SharedSpot> spots;
    void clear() { sensors.clear(); }  // the spots keep their memory
};

// A covariance to rounding: finite, symmetric, no negative variance in any direction.
bool semidefinite(const Eigen::Ref<const Eigen::MatrixXd>& covariance);
bool semidefinite_xz(const Eigen::Matrix2d& covariance);
// Equal as stored: quick. What differs in the sign of a 0 alone counts as other.
template <class Matrix>
bool same_bits(const Matrix& a, const Matrix& b) {
    return std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}
// Exactly symmetric and clearly positive: quicker to tell, and then semidefinite if finite.
bool definite(const Matrix6& covariance);

SharedRoot root_of(const SensorPrior& prior);
bool is_zero(const SensorPrior& prior);
bool same_priors(const std::vector<SensorPrior>& a, const std::vector<SensorPrior>& b);

// d(f e)/du of the residual e along f (sensor frame), its first root.count numbers; the rest is left alone. `axis` =
// R W f with W the sensor's axes in the work object and R the rotation of D; y = W^-1 D^-1 W m.
void shared_row(const SharedGeometry& spot, const SharedRoot& root, const Eigen::Vector3d& f,
                const Eigen::Vector3d& axis, const Eigen::Vector3d& y, double* u);

// One arrival's covariance of workobject_from_sensor = `pose`, as (rho, theta) along the sensor's axes about its origin.
Matrix6 arrival_along_sensor(const Pose& pose, const Matrix6& covariance);
// Covariance of a point p (sensor frame) by it, along the sensor's axes. Without `travel` the row and column of Y stay 0.
Eigen::Matrix3d arrival_covariance(const Matrix6& along_sensor, const Eigen::Vector3d& p, bool travel = true);

// Its x and z alone.
struct CovarianceXz {
    double xx = 0, zx = 0, zz = 0;
};
CovarianceXz arrival_xz(const Matrix6& along_sensor, const Eigen::Vector3d& p);

// columns^T (lower lower^T)^-1 columns.
Eigen::Matrix3d left_uncertain(const SharedBlock& block, const SharedColumns& columns);

}  // namespace seamwright::correction
