#pragma once
// How large the noise, the passes' own errors and the edges' curvatures are, by restricted likelihood, and the answer as
// the mean over their likely values. Private to core/calibration/on_part.
//
// With the normal equations A = J^T J + L of all unknowns, L their prior precisions (passes 1/q^2, curvatures 1/kappa^2)
// and Q the smallest sum of squares with priors,
//     -2 log l = (n - p) log(Q / (n - p)) + log |A| - log |L|,   s^2 = Q / (n - p)
// n equations, p unknowns without a prior. Likelihoods are taken on grids of q and kappa, one after the other.

#include "core/calibration/on_part/edge_problem.h"

namespace seamwright::on_part {

// The wanted unknowns as somebody at the sensor sees them: shift of the point where the edge is seen, along the sensor's
// axes (mm), turn about them on kOnPartLever_mm (mm), latency on kOnPartOpen_mm / kOnPartOpen_s (mm). Tangent of H and
// tau = view * those.
Eigen::MatrixXd view_of(const State& state, const Eigen::Vector2d& working_point, Eigen::Index wanted);

struct Estimate {
    Variances variances;           // the likeliest
    Eigen::VectorXd step;          // of the wanted unknowns from where the state stands
    Eigen::VectorXd edges;         // step of their coefficients; of at_variances() alone
    Eigen::MatrixXd covariance;    // of them; an open direction has a huge sigma
    Eigen::MatrixXd information;   // by the data alone, at the likeliest
    Eigen::VectorXd gradient;      // by the data alone
    std::vector<double> straight;  // by edge: probability of the straight one
    double rr = 0;                 // Q at the likeliest
    double minus2 = 0;             // of at_variances() alone: -2 log of the restricted likelihood
};

struct Given {
    bool robot = false;      // q stands
    bool scale_free = true;  // the white noise is estimated; else it stands
    double least = 0;        // of its scale, relative to where it stands
    Eigen::MatrixXd view;
};

// Coordinate ascent over the grids from `from`.
Estimate estimate(const Blocks& blocks, const Data& data, const State& state, const Variances& from,
                  const Given& given);
// At these variances alone; `loose`: a pass that is not bound to the others.
Estimate at_variances(const Blocks& blocks, const Data& data, const State& state, const Variances& variances,
                      const Eigen::MatrixXd& view, std::optional<std::size_t> loose = std::nullopt);

// Variance of a mean of neighbours over that of independent ones: 1 + 2 sum of the significant correlations.
double neighbours_factor(const Blocks& blocks, const Data& data);

}  // namespace seamwright::on_part
