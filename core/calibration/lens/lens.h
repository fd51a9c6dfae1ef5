#pragma once
// Lens distortion from straight laser lines on a plane (4.1.1): the lens is the one that makes them straight.
//
// Model (4.1)-(4.2): u_d = u_u (1 + K1 r^2 + K2 r^4) about the centre, r in px; inside the solver r is scaled
// by half the image diagonal, or K1 and K2 would differ by ten orders of magnitude. Cost per line: its
// Karhunen-Loeve residuals, that is the distances of its undistorted points from their own best line
// (4.3)-(4.4, corrected: centred). A change of scale must cost nothing: the source divides lambda_min by
// lambda_max of the whole line (and prints lambda_min / lambda_min). That rewards a lens which stretches the
// ends of the lines until it folds, because it shrinks the noise of their middle against their length; where
// distortion is weak, noise alone then leads there. So every point's distance is divided by its own stretch:
// how far a pixel across the line reaches in the undistorted plane at that point. The sum is then one of
// squared distances in the image, where the noise is the same everywhere.
//
// Wrong points and lines. Before the lens is known a line's points are told from reflections and the like by
// a parabola (bent_line.h), then by the lens found: what lies farther than 5 robust sigma from its line is
// left out and the lens solved again, until nothing changes. A line of which less than 60 % remains, or which
// stays bent by 4 times what the middling line does (its plane is not flat there), is left out and named; no
// more than a third of the lines.
//
// Neighbours on a line that err alike widen the covariance by the sum of their autocorrelation (line_noise.h).
//
// Determined: distortion and centre. Not determined: the focal length, and the centre where there is no
// distortion (it is held to the middle of the image with a sigma of a tenth of the width). Degenerate: lines
// through the centre only, lines in one corner, fewer than 3 lines.

#include <Eigen/Core>
#include <vector>

#include "core/calibration/calibration.h"
#include "core/error.h"
#include "core/profile/sensor_model.h"

namespace seamwright {

struct LensData {
    int width = 0, height = 0;
    std::vector<std::vector<Eigen::Vector2d>> lines;  // px
};

struct LensOptions {
    std::vector<int> exclude;  // line numbers
    bool full = false;         // Brown-Conrady: k3, p1, p2 too (2.7)-(2.8)
};

struct LensResult {
    // fx = fy = half the diagonal, so that k1, k2 .. are those of the scaled radius; undistort() gives
    // straight lines.
    CameraModel lens;
    double k1_px = 0, k2_px = 0;  // K1 (1/px^2) and K2 (1/px^4) of (4.1)
    double straightness_before_px = 0,
           straightness_after_px = 0;  // rms distance from the fitted lines, of points used
    double point_noise_px = 0;         // sigma of a point across its line, whatever form the lines keep
    bool centre_strays = false;        // farther from the image's middle than a tenth of the width
    bool bent = false;                 // by more than their points scatter; the covariance holds it
    double full_model_px = 0;          // straightness_after_px by k3, p1, p2 too; where it was asked, else 0
    double corner_shift_px = 0,
           corner_sigma_px = 0;  // distortion in the image's corner and its sigma (worst corner)
    CalibrationReport report;    // centre_u, centre_v (px), k1, k2 (scaled radius), k3, p1, p2
};

// Error: no size, lines with fewer than 5 points, NaN, points outside the image. Verdict undetermined: fewer than 3
// lines, no lens that makes them straight, or the distortion in a corner known to worse than 3 px. poor: lines stay
// bent by 2 px, or by three times what their points scatter (line_noise.h) and 0.1 px; usable where k3, p1 and p2
// would take that away, or from 1.3 times on (and more than chance), where the covariance counts a third of a line as
// one point (poor if the centre strays as well: bent lines draw it). What was left out stands in the notes of
// report.poses and in the judgement.
Expected<LensResult> calibrate_lens(const LensData& data, const LensOptions& options);

}  // namespace seamwright
