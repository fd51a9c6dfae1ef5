#pragma once
// How well a robot returns: repeatability RP as ISO 9283 defines it, RP = mean(l) + 3 s(l) with l the distance of
// an attained position from the mean of all, and the covariance of an arrival, from returns to spots.
//
// Model. At return j the sensor stands off its pose by q_j (base, mm; of the point that it looks at, so that a turn
// of the flange is in it with its lever), anew at every arrival. Spot k sees  A_k q_j,  A_k of 2 x 3 (what a
// displacement does to the feature's x and z; the direction along the contour does nothing). Each of the m profiles
// taken while the robot stands adds the sensor's own noise:
//     p_ji = p_0 + A_k q_j + e_ji,     cov(q) = C,  cov(e) = N_k.
// One-way analysis of variance:  S_k = cov_j(mean_i p_ji) = A_k C A_k^T + N_k mean(1/m),  N_k pooled within the
// returns, n - 1 and sum(m) - n degrees of freedom.
//
// One arrival's covariance C in base axes is the least-squares answer of all spots' S_k - N_k/m, taken for equal at
// all of them. Components that no spot sees are those of an isotropic C of the seen mean variance (the shortest
// correction to it), and are counted and named as assumed; a covariance that came out negative somewhere is cut at 0
// there. What of q is the flange's translation and what its rotation cannot be told from spots of one lever: C is the
// scatter of the point looked at.
//
// RP of the robot is that of normal arrivals of covariance A C A^T: mean(l) = E|x|, s(l)^2 = tr - mean(l)^2,
// without the sensor's noise; `rp_measured` is the formula put to the returns as they are, noise of the means
// included. Limits, 95 %: each squared figure is to first order sum_k tr(G_k (S_k - N_k mean(1/m))), G_k its gradient;
// the S and the N part are mean squares of Satterthwaite's degrees, f = T^2 / sum_k (tr((G_k S_k)^2) / nu_k), and their
// difference has the generalised limits of distributions.h (exact for one axis of a spot).

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "core/acceptance/acceptance.h"
#include "core/error.h"

namespace seamwright {

inline constexpr int kReturns = 30;      // what ISO 9283 asks for
inline constexpr int kLeastReturns = 5;  // fewer say nothing

// The returns to one spot.
struct SpotReturns {
    std::string spot_id;
    // (x, z) of the feature moves by sees * q, q in base axes.
    Eigen::Matrix<double, 2, 3> sees = Eigen::Matrix<double, 2, 3>::Zero();
    bool x = true, z = true;  // what the spot observes of the two
    // What the feature itself states as the sigma of x and z, root mean square; 0: it states none.
    Eigen::Vector2d stated_mm{0, 0};
    // Of each return the feature (x, z) in every profile taken while the robot stood, mm.
    std::vector<std::vector<Eigen::Vector2d>> returns;
};

// One coordinate of a spot, or one axis of the base.
struct AxisScatter {
    double sigma_mm = 0;
    Interval limits_mm;
};

struct SpotRepeatability {
    std::string spot_id;
    int returns = 0, profiles = 0;
    bool x = true, z = true;
    AxisScatter arrival_x, arrival_z;      // the robot's alone; not observed: 0
    Eigen::Vector2d noise_mm{0, 0};        // the sensor's, one profile
    double rp_mm = 0, rp_measured_mm = 0;  // in the directions that the spot observes
    Interval rp_limits_mm, rp_measured_limits_mm;
};

struct RobotStudy {
    std::vector<SpotRepeatability> spots;
    Eigen::Matrix3d covariance_mm2 = Eigen::Matrix3d::Zero();  // C, base axes
    AxisScatter axes[3];                                       // base X, Y, Z
    int seen = 0;                         // of the 6 components of C; the others are assumed
    std::vector<Eigen::Vector3d> unseen;  // unit directions, base, whose variance is assumed
    double rp_mm = 0;                     // of C, in space; rests on what is assumed unless `seen` is 6
    Interval rp_limits_mm;
};

// RP of normal arrivals of that covariance (1 to 3 dimensions): E|x| + 3 sqrt(tr - E|x|^2).
double repeatability_of(const Eigen::MatrixXd& covariance_mm2);
// RP = mean(l) + 3 s(l) of positions (columns).
double repeatability_of_positions(const Eigen::MatrixXd& positions_mm);

// Error (input): no spot; one that observes nothing, has fewer than kLeastReturns returns, a return without profile,
// no return with two, or values that are not finite or all equal.
Expected<RobotStudy> robot_study(std::span<const SpotReturns> spots);

}  // namespace seamwright
