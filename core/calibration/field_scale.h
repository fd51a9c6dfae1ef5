#pragma once
// How well a calibration knows the sensor's own millimetres: the scale of x and z and the shear of x against z over its
// field, K = [kappa_x s; 0 kappa_z] of correction.h. It is what is left of a map's error when its shift and turn in the
// laser plane are taken off, which are the hand-eye's.

#include <Eigen/Core>
#include <span>

namespace seamwright {

// One standard deviation, 1/1.
struct FieldScale {
    Eigen::Vector2d scale_sigma = Eigen::Vector2d::Zero();  // of x, z
    double shear_sigma = 0;
    bool shown = false;  // measured beyond chance: it counts whatever else is known
};

// Of two that hold for one sensor: the smaller of each, unless one is shown.
FieldScale better_known(const FieldScale& a, const FieldScale& b);

// From the covariance of places (x, z) of the field, mm^2, (x, z) of each in turn: the linear part of their errors by
// least squares, e = t + L p, turned so that the lower left of L is 0. Zero of fewer than three places, or of such on one
// line.
FieldScale field_scale(std::span<const Eigen::Vector2d> places_mm, const Eigen::MatrixXd& covariance_mm2);

}  // namespace seamwright
