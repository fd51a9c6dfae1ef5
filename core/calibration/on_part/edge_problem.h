#pragma once
// The least-squares problem of on_part.h on Ceres, and its normal equations in blocks: what all passes share (H, tau, then
// the edges' coefficients) and each pass's own displacement, which is eliminated. Private to core/calibration/on_part.

#include <vector>

#include "core/calibration/on_part/edge_curve.h"
#include "core/calibration/on_part/on_part.h"
#include "core/calibration/on_part/pass_motion.h"

namespace seamwright::on_part {

// A profile that takes part; which pass and edge it belongs to, by index.
struct Sight {
    std::size_t pass = 0, edge = 0, index = 0;  // index: within its pass
    double time_s = 0;
    Eigen::Vector2d point = Eigen::Vector2d::Zero();
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
    bool used = true;
    bool beyond = false;  // not used: at the latency found its pose lies beyond its pass
};

struct Data {
    std::vector<Sight> sights;
    std::vector<PassMotion> motions;  // by pass
    std::size_t edges = 0;
    bool latency_free = true;
    double latency_s = 0;  // where it is not free, else where it starts
    std::optional<MountingPrior> prior;
};

// Between a pass's shift and its turn: 1 mm goes with a third of a degree.
inline constexpr double kPassLever_mm = 172;

// q of the passes in mm and rad, kappa by edge; the white noise is relative to the sights' covariances.
struct Variances {
    double white = 1;
    double pass_mm = 0.02, pass_rad = 0.02 / kPassLever_mm;
    std::vector<double> curvature;
};

struct State {
    Pose mounting = Pose::Identity();
    double latency_s = 0;
    std::vector<EdgeCurve> edges;
    std::vector<Vector6> passes;  // displacement of the flange: shift, rotation vector
};

Eigen::Vector3d in_sensor(const Eigen::Vector2d& point);
// The sight's point in the base.
Eigen::Vector3d in_base(const Data& data, const State& state, const Sight& sight);
// Distance of the sight's point from its edge, mm, across the chord. The pass's displacement counts as zero.
Eigen::Vector2d distance(const Data& data, const State& state, const Sight& sight);

struct SolveOptions {
    double robust_mm = 0;  // Huber's scale, 0: none
    bool passes = true;    // with their displacements
    int most_iterations = 60;
};
// From where the state stands. Infinity: impossible. Else the cost (sum of squares with losses and priors).
double solve_state(const Data& data, const Variances& variances, const SolveOptions& options, State& state);

// Linearised where the state stands, rows in units of the sights' white noise, no prior in it. `wanted`: H and, where it
// is free, tau; then the edges.
struct Blocks {
    Eigen::Index wanted = 6, shared = 6;
    Eigen::MatrixXd jacobian;  // [rows, shared + 6 passes]
    Eigen::VectorXd residuals;
    std::vector<std::size_t> sight_of;  // of every second row
    Eigen::MatrixXd ss;                 // J^T J of the shared
    Eigen::VectorXd sr;
    std::vector<Eigen::MatrixXd> sp;  // by pass [shared, 6]
    std::vector<Matrix6> pp;
    std::vector<Vector6> pr;
    std::vector<int> rows;  // by pass
    double rr = 0;
};
Blocks linearised(const Data& data, const Variances& variances, const State& state);
// The same without one pass.
Blocks without_pass(const Blocks& blocks, const Data& data, std::size_t pass);

}  // namespace seamwright::on_part
