#pragma once
// What an unknown travel does to a measure: a trigger that comes early or late, and does not say so.

#include "core/correction/correction.h"

namespace seamwright {

// Direction of the displaced contour where the spot measures it, sensor frame, with 1 along Y: (dx/dy, 1,
// dz/dy). From the spot's curve at the place to which the contour slid, or straight along Y, turned by D.
// A contour that lies along the laser line (no part along Y) yields infinite slopes.
Eigen::Vector3d contour_direction(const SpotObservation& spot, const Displacement& displacement);

// Where the displaced contour meets the laser plane: what a spot will measure without noise. Sensor frame, y
// that of the reference. The reference itself where the contour came to lie along the laser line.
Eigen::Vector3d displaced_measure(const SpotObservation& spot, const Displacement& displacement);

// Covariance of the measured (x, z), mm^2, from an unreported travel of standard deviation `sigma_mm` along
// the sensor's Y, to be added to that of the feature. First order: the slope of contour_direction() times the
// travel. Zero where the contour stands still. A uniform jitter of half width h has h / sqrt(3).
Eigen::Matrix2d travel_covariance(const SpotObservation& spot, const Displacement& displacement,
                                  double sigma_mm);

// Adds that of a trigger that comes anywhere within `half_window_mm` to the observation's noise. Where x and z
// weigh differently there is one sigma for both: the worse of those observed. A contour that came to lie along
// the laser line tells nothing; 1 m stands for infinite.
void add_travel(SpotObservation& spot, const Displacement& displacement, double half_window_mm);

}  // namespace seamwright
