#pragma once
// Look-up table of a sensor from known target positions (2.4.1): where a camera and a plane do not describe
// the sensor well enough (or are not known), the map from pixel to (x, z) is measured point by point and
// interpolated.
//
// Map: (x, z) = H(q + p(q) + s(q)), q = (u, v). H: homography, what a plane seen by a pinhole gives exactly.
// p: polynomial of total degree 1 to 5 in px, the lens as far as it is smooth over the field. s: thin-plate
// spline on knots spread over the samples, what is left locally, damped by a penalty on its bending.
// Noise model: independent noise of the pixels, of one covariance over the image, estimated from the redundancy; where
// the places' own sigma is stated and says more, as much as that gives in the image. Where places stand in rows of one x or
// one z, what a stage errs by at each row is a variance more, if the residuals of a camera
// before a plane show it.
//
// A node is a hole where the samples do not support it: outside their convex hull by more than half a step
// (or half the samples' spacing, when smaller), farther than two mean spacings from the nearest sample, on
// the far side of H's horizon, or where the map folds over.
//
// Degrees and penalties that the pairs do not speak against are averaged by what they predict of pairs they have not
// seen (model averaging, Buckland, Burnham and Augustin 1997); how far they lie apart is part of the sigmas, and so is
// what few pairs leave open of the noise.
//
// Degenerate: pairs on one line of the image or of the laser plane. A target's position error is taken as
// noise; an error common to all (a scale, a tilted stage) cannot be seen, one of all positions of one x or z only where
// the sensor is a camera before a plane.

#include <optional>
#include <string>
#include <vector>

#include "core/calibration/calibration.h"
#include "core/calibration/stripe/laser_plane.h"
#include "core/error.h"
#include "core/profile/sensor_model.h"

namespace seamwright {

struct LookupTableOptions {
    std::vector<std::string> exclude;  // ids
    // px between nodes; 0: the coarsest of 32, 16, 8, 4, 2 whose interpolation adds less than a fifth of the
    // noise
    double step_px = 0;
    double place_sigma_mm = 0;  // of laser_mm along each axis, independent from pair to pair; 0: not stated
};

struct LookupTableResult {
    LookupTable table;
    int holes = 0;             // nodes
    double covered_share = 0;  // of the nodes, those with a value
    // Through the table as it will be used, over the used pairs. Forward: pixel -> mm. Backward: mm -> pixel.
    double forward_rms_mm = 0, forward_max_mm = 0;
    double backward_rms_px = 0, backward_max_px = 0;
    int unsupported_pairs = 0;  // used pairs that fall into a hole or beside one
    double noise_px = 0;        // sigma of one coordinate of a pixel, from the redundancy
    double noise_mm = 0;        // the same as a distance in the laser plane, root mean square over the pairs
    double interpolation_mm = 0;  // rms difference of the table and the smooth map in the middle of the cells
    double map_sigma_mm = 0, map_sigma_worst_mm = 0;  // sigma of a node's position: rms and worst
    int degree = 0;                                   // of the polynomial that predicts best
    double effective_parameters = 0;                  // numbers spent on each of u and v
    // parameters: x and z (mm) of the table at the middle of the samples and at four nodes towards its
    // corners, with the covariance of the map. Per pose: rms_mm and rms_px of each pair.
    CalibrationReport report;
};

// Error: no or impossible size, fewer than 6 pairs, NaN, a pixel outside the image, unknown or double ids,
// metres, a step that is not positive or needs more than 16 million nodes. Verdict undetermined: pairs on one
// line, fewer than 9 of them, no map that explains two thirds of them, no cell of the table without a hole.
// poor: residual or hold-out beyond 3 px or folds, or the positions of one x or z are shifted together (wrong_groups.h).
// usable: wrong pairs left out, fewer than 25 pairs, less
// than half of the image covered, hold-out more than 1.6 times the noise. A wrong pair (beyond the 99.9 %
// limit of the largest of all leave-one-out residuals, and more than a quarter of a pixel) is named and left
// out.
Expected<LookupTableResult> calibrate_lookup_table(int width, int height, const std::vector<LaserPair>& pairs,
                                                   const LookupTableOptions& options);

// Pixel where the table has `xz_mm`, by Newton over its cells. `start` helps when the map is not one to one
// (a lens beyond its fold); without it the nearest node is taken. nullopt: nowhere in the table.
std::optional<Eigen::Vector2d> pixel_in_table(const LookupTable& table, const Eigen::Vector2d& xz_mm,
                                              std::optional<Eigen::Vector2d> start = std::nullopt);

}  // namespace seamwright
