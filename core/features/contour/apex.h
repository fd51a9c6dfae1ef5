#pragma once
// The apex of a triangular calibration body: where the stripe's two straight flanks meet (thesis 4.1.2).
// Works on a profile in mm and on the stripe in an image in pixels alike; the unit of the answer is that of
// the points.
//
// The contour is reduced to its bends; the sharpest of those with a long straight piece on either side is the
// apex. Lines are fitted robustly to both flanks next to it, without their ends (the apex of a real body is
// round), and met. Noise model: that of fit_line().

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace seamwright {

struct Apex {
    Eigen::Vector2d point = Eigen::Vector2d::Zero();
    Eigen::Vector2d left = Eigen::Vector2d::Zero(),
                    right = Eigen::Vector2d::Zero();  // far ends of the flanks
    double angle_rad = 0;                             // between the flanks, 0 .. pi
    double rms = 0;                                   // of the points on the flanks
    double sigma = 0;                                 // of the point, the worse direction
};

// `points` run along the stripe. nullopt: fewer than 40 points, no bend between 20 and 130 degrees with
// flanks of at least a twentieth of the contour's extent, or flanks that are not straight. The foot of a body
// is flatter than that unless its flanks rise by more than 50 degrees; the foot of such a steep body would be
// taken for the apex while that is out of sight.
std::optional<Apex> find_apex(const std::vector<Eigen::Vector2d>& points);

}  // namespace seamwright
