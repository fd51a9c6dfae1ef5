#pragma once
// How far a part's form leads a fit astray.
//
// What is left over after a fit is noise of points and deviation of form. Noise averages out over thousands of points;
// form does not: neighbouring points err alike, and a bend of the sheet is partly taken for a tilt. Model: the real
// surface lies off the drawing by a random displacement field d(x), isotropic, mean zero, of variance s^2 in each
// direction and correlation c(h) = exp(-h / L), so that the residuals of two
// places with normals n_i, n_j covary by s^2 c(|x_i - x_j|) n_i . n_j. Residuals r = A motion + n . d + noise. The
// exponential has waves of every length: a smoother correlation takes the length from the short ones, which a scan shows
// well, and states too little of the long ones, which it hardly shows.
//
// A sheet bends and twists besides, by far more and over all of its length: d grows by the bending modes
//     e3 (q1 u^2 / 2 + q2 u v + q3 v^2 / 2),    u, v = -1 .. 1 along the part's longer axes, e3 along its thinnest,
// q normal about 0 with the standard deviation t. About which place of the part it is bent is not to be seen in a scan: a
// door bent about its hinges stands otherwise than one bent about its middle. That place is taken to be anywhere over
// the part and somewhat beyond its ends, alike, and for each mode by itself; the answer is the pose of which the bend's
// mean over the part is zero, and its covariance holds what the
// other places would make of it.
//
// s, L and t are not known. Each triple of a grid, s from 0 to ten times the residuals, L from the nodes' distance to the
// part's size, gives motion and covariance by generalised least squares and weighs by its restricted likelihood (REML;
// Harville 1977), which accounts for what the fit itself took away; the answer is the mixture: mean, and mean of the
// covariances plus the spread of the means. Where the residuals leave L open, the wide ones count.

#include <vector>

#include "core/geometry/pose.h"

namespace seamwright {

// Points of one neighbourhood and one facing, averaged.
struct FormNode {
    Eigen::Vector3d place_mm = Eigen::Vector3d::Zero();
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit
    Vector6 row = Vector6::Zero();                     // of A, for the unknowns of refine.h
    double residual_mm = 0;
    double noise_mm2 = 0;  // variance of the node's residual by the points' noise
};

// Where a part's bending modes lie, in the nodes' frame: columns of `axes` along u, v and e3, half the part's extent along
// each.
struct PlateAxes {
    Eigen::Vector3d middle_mm = Eigen::Vector3d::Zero();
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    Eigen::Vector3d half_mm = Eigen::Vector3d::Ones();
};

struct FormSolution {
    Vector6 motion = Vector6::Zero();
    Matrix6 covariance = Matrix6::Zero();
    double form_mm = 0;                                 // s, mean over the mixture
    double length_mm = 0;                               // L, likewise (geometric); 0 where there is no form
    Eigen::Vector3d bend_mm = Eigen::Vector3d::Zero();  // q
    bool solved = false;                                // false: fewer than 12 nodes, or singular
};

// `middle_mm` and `spread_mm` of the unknowns (refine.h). At most some 250 nodes: the cost is cubic.
FormSolution solve_with_form(const std::vector<FormNode>& nodes, const PlateAxes& plate,
                             const Eigen::Vector3d& middle_mm, double spread_mm);

}  // namespace seamwright
