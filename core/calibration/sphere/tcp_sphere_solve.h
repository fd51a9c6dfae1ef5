#pragma once
// Inner parts of calibrate_tcp_sphere(); see tcp_sphere.h for the model. Parameter order everywhere: t (3),
// rotation vector (3, retract() of pose.h), c (3), r.
//
// Its own Levenberg-Marquardt, not ceres::Problem as the other calibrations: the search from no start solves hundreds
// of small problems on three sufficient numbers a profile, and the points' normal equations are sums over a profile that
// the compiler keeps in vector registers. A whole calibration, search and noise model included, takes half the time
// of one plain solve of the points by Ceres from a start a few millimetres off (tests/bench/bench_calibration_pose.cpp).

#include <vector>

#include "core/calibration/sphere/circle_section.h"
#include "core/geometry/pose.h"
#include "core/profile/profile.h"

namespace seamwright::tcp_sphere {

using Vector10 = Eigen::Matrix<double, 10, 1>;
using Matrix10 = Eigen::Matrix<double, 10, 10>;
using Matrix3x10 = Eigen::Matrix<double, 3, 10>;

// A floor under scales and pivots, relative to a unit diagonal: directions without any information stay still.
inline constexpr double kFloor = 1e-12;

struct Model {
    Pose flange_from_sensor = Pose::Identity();
    Eigen::Vector3d centre_base = Eigen::Vector3d::Zero();
    double radius = 0;
};

// One profile that shows a circle.
struct Section {
    size_t observation = 0;
    Pose flange_from_base = Pose::Identity();
    const Profile* profile = nullptr;
    CircleSection circle;
    bool used = true;
    std::vector<double> x, z;  // the points taken for the sphere
    // Sufficient statistics of (x, z) for the algebraic in-plane distance
    //   (|p - s|^2 - r^2) / (2 rho) = (nu + g^T v) / (2 rho),  v = (dx, dz, dx^2 + dz^2 + s_y^2 - r^2 +
    //   rho^2), dx = s_x - a, dz = s_z - b, g = (-2(x-a), -2(z-b), 1), nu = (x-a)^2 + (z-b)^2 - rho^2:
    // their sum of squares is own_squares + |root (v - best)|^2, so a profile costs the same whatever its
    // length.
    Eigen::Matrix3d root = Eigen::Matrix3d::Zero();
    Eigen::Vector3d best = Eigen::Vector3d::Zero();
    double own_squares = 0;
    double count() const { return static_cast<double>(x.size()); }
};

// Takes the circle's inliers into x, z and updates the statistics. The choice rests on the profile alone:
// choosing by the common sphere would cut one side off a profile whose robot pose is a little wrong, and pull
// the result.
void take_inliers(Section& section, const CircleSection& circle);

Eigen::Vector3d centre_in_sensor(const Section& section, const Model& model);
Matrix3x10 centre_jacobian(const Section& section, const Model& model);
Model retracted(const Model& model, const Vector10& delta);

// |root (v - best)|^2: by how much the profile disagrees with the model beyond its own noise, mm^2 summed
// over points.
double disagreement(const Section& section, const Model& model);

// Two stages of the noise: of the points within a profile, and of the profiles' centres against the common
// sphere, as an isotropic error of s_i (that is what an error of the robot's pose is).
struct NoiseLevels {
    double point_variance = 0;   // mm^2, in-plane radial
    double centre_variance = 0;  // mm^2 an axis; 0 when the points' noise explains the disagreement
    double redundancy = 0;       // 3 profiles - unknowns
    double freedom = 0;  // of centre_variance: how many numbers of equal weight tell as much (Satterthwaite)
    double ratio = 1;    // disagreement between the profiles over what the points' noise explains
    bool poses_disagree = false;  // ratio beyond the 99 % point of its F distribution
};
NoiseLevels noise_levels(const std::vector<Section>& sections, const Model& model,
                         const Matrix10& inverse_information, bool radius_free);

// Covariance of the least-squares solution when each s_i carries an error of `centre_variance` an axis
// besides: sum over profiles of (H^-1 K_i) (H^-1 K_i)^T, K_i = sum over its points of J^T u^T, u = de/ds. K_i
// has a row for the radius: an error of the centres is taken up by a free radius as by every other unknown.
Matrix10 covariance_of_centres(const std::vector<Section>& sections, const Model& model,
                               const Matrix10& inverse_information, double centre_variance);

// Levenberg-Marquardt on the statistics alone (Geman-McClure over profiles with `scale_mm`; infinity = least
// squares).
double solve_reduced(const std::vector<Section>& sections, Model& model, bool radius_free, double scale_mm,
                     int iterations);

// The points' own normal equations of e = |p - s| - r.
struct System {
    Matrix10 information = Matrix10::Zero();  // sum J^T J
    Matrix10 meat = Matrix10::Zero();         // sum e^2 J^T J, of the sandwich covariance
    Vector10 gradient = Vector10::Zero();     // sum J^T e
    double squares = 0;
    double count = 0;
};
System accumulate(const std::vector<Section>& sections, const Model& model, bool with_meat);

// Least squares over the points by Levenberg-Marquardt from `model`; returns the sum of squares.
double solve_points(const std::vector<Section>& sections, Model& model, bool radius_free);

}  // namespace seamwright::tcp_sphere
