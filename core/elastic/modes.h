#pragma once
// How a part bends: its modes, learnt from what the rigid correction leaves at the spots (methods.md 13).
//
// Model. A part is displaced by D and bent: the reference of spot n, p_n = W_n r_n (correction.h), lies at
// D (p_n + u_n), and the residual of the rigid correction is e_n = -W_n^T u_n. Over the parts
//     u = mean + sum_k a_k phi_k,     a_k ~ N(0, lambda_k), independent,
// with u, phi in the work object as taught, three coordinates a spot.
//
// What a row tells. A laser cut tells two directions of three, the third is unknown and not 0; and the rigid
// motion has been taken out. Both are said by one matrix, the information that a row y has of u:
//     M = L - L G (G^T L G + P)^-1 G^T L,
// L block diagonal, the inverse covariance of a spot's measure with 0 along its travel and for a spot that was
// not measured, G the motions of the free degrees of D (P = 0) and the errors that the spots of a sensor share
// (P = 1, nuisance.h). M u is what the measures say of u; M G = 0, so that y may be the residual of any D near the
// solution. To first order; the slope of a curved contour along its travel is left out of what u does to it.
//
// Learning (learn_modes). Factor analysis (Rubin and Thayer 1982) with M in the place of the noise: expectation
// and maximisation over u = mean + C z, z ~ N(0, 1), and over a factor kappa_n of each spot's stated variance, L_n /
// kappa_n in M. A spot whose stated sigma is too small moves alone, in every part otherwise: noise, no mode. The
// factors are learnt with each number of modes, drawn to their mean by as much as one part tells. Directions that no row
// tells are 0 in phi (shortest). Modes are the singular vectors of C; phi_k is scaled to length 1 at the spot that
// moves most, so that a_k is in mm there, and its sign makes its largest coordinate positive.
//
// Number. Likelihood of the parts left out, in folds by part (runs of one part always together): the smallest number on which
// no larger one gains more than its own standard error and `least_gain`, which noise does not reach. None is an answer. Before,
// a spot of one part is left out that the model of the other parts contradicts.
//
// Mean. The part that was taught was bent too, a_0: of the mean residual, what the modes explain is their mean
// amplitude. The rest (`common_mm`) may as well be the references' own error: the bead does not follow it.

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "core/correction/correction.h"

namespace seamwright {

// One part as one run saw it. Vectors and matrices by the spots of the learning, 3 coordinates each.
struct ElasticRow {
    std::string id;                     // "run 12"; one row each
    std::string part_id;                // rows of one part are held out together
    Eigen::VectorXd residual_mm;        // u as measured, work object; 0 where nothing is told
    std::vector<Eigen::Matrix3d> seen;  // L of each spot, 1/mm^2; 0: not measured
    Eigen::MatrixXd motions;            // G: what the free degrees of D and the shared errors do to y
    int shared = 0;                     // of the columns of G, the last ones: P = 1
};

// A spot as it stood when the modes were learnt.
struct ElasticSpot {
    std::string id;
    Pose workobject_from_sensor = Pose::Identity();
    Eigen::Vector3d reference_mm = Eigen::Vector3d::Zero();  // sensor frame
    Eigen::Vector3d weights = {1, 0, 1};
    Eigen::Matrix3d seen = Eigen::Matrix3d::Zero();  // mean L over the rows, 1/mm^2, work object
    double noise_factor = 1;  // of its stated sigma, times that of all spots: sqrt(kappa_n)
    Eigen::Vector3d common_mm = Eigen::Vector3d::Zero();
    Eigen::Vector3d place_mm() const { return workobject_from_sensor * reference_mm; }
};

struct ElasticMode {
    std::vector<Eigen::Vector3d> shape;  // a spot each, mm per mm of amplitude
    double variance_mm2 = 0;
    double variance_low_mm2 = 0, variance_high_mm2 = 0;  // 95 %, chi-square of as many parts
    double mean_mm = 0;                                  // a_0
    double lowest_mm = 0, highest_mm = 0;                // amplitudes of the learning set
};

struct ElasticModes {
    std::vector<ElasticSpot> spots;
    std::vector<ElasticMode> modes;  // largest variance first; may be none
    double noise_factor = 1;         // of all spots together: scatter left over stated sigma
    int rows = 0, parts = 0;
    // Gain of the hold-out log-likelihood per part by the mode of this number, and its standard error; the
    // last one is the one that was not taken.
    std::vector<double> gain, gain_sigma;
    Text message;  // how many and why
};

struct LearnOptions {
    int most_modes = 5;
    int folds = 5;
    double gain_sigmas = 1;  // of the mean gain per part
    double least_gain = 6;   // of the log-likelihood, over all parts
    int fewest_parts = 10;   // below: none, and it is said
};

// A row from what a region's solver got, and the displacement that it found. Spots of `spots` without an
// observation tell nothing. Error (input): an observation of no such spot, two of one, what solve_region
// refuses, fewer observed coordinates than free degrees.
Expected<ElasticRow> elastic_row(std::span<const ElasticSpot> spots,
                                 std::span<const SpotObservation> observations,
                                 const CorrectionOptions& options, const Displacement& displacement);

// Error (input): no row, two rows of one id, numbers that are not finite, sizes that differ, information
// that is none, fewer observed coordinates than free degrees.
Expected<ElasticModes> learn_modes(std::span<const ElasticSpot> spots, std::span<const ElasticRow> rows,
                                   const LearnOptions& options = {});

// What makes modes unusable, as they come from a file: sizes, finite numbers, positive variances, ids.
Expected<void> check_modes(const ElasticModes& modes);

}  // namespace seamwright
