#pragma once
// The corners of a checkerboard one by one: saddle points of the grey values, found in a picture of moderate
// size and measured in the picture as taken. Private to core/calibration.

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace seamwright::detail {

// Where two edges cross so that opposite sectors are alike. `first` and `second` are unit vectors along the
// edges with first x second > 0; the sector between them is the bright one.
struct Saddle {
    Eigen::Vector2d at;  // px
    Eigen::Vector2d first, second;
    double contrast = 0;  // bright less dark, in the units of the image
};

// One scale of the search: the picture in square roots of grey (the noise of light is then even, and a stripe
// outshines a dim board less), softened by 1.2 px.
cv::Mat softened_root(const cv::Mat& grey, double full_scale);

// Maxima of Ixy^2 - Ixx Iyy (minus the determinant of the Hessian) above the noise, around which the grey
// values on a circle of `radius_px` change sides four times, alike on opposite sides. `soft` from
// softened_root().
std::vector<Saddle> find_saddles(const cv::Mat& soft, double radius_px);

// A corner measured by least squares on the grey values around it:
//   g = a + gx x + gy y + b erf(n1 (x - p) / (sqrt 2 s)) erf(n2 (x - p) / (sqrt 2 s)),
// n1, n2 the normals of the edges, s the blur, weights by Tukey: what is brighter than the paper (a stripe, a
// glint) has none.
struct CornerFit {
    Eigen::Vector2d at;
    Eigen::Vector2d first, second;
    double sigma_px = 0;       // of one coordinate, from the residuals
    double half_contrast = 0;  // b
    double blur_px = 0;        // s
    double noise = 0;          // rms of the residuals, weighted
    double foreign = 0;        // share of the window's pixels that the model does not explain
};

// Whether the model explains what is around it, and the corner is known to half a pixel.
bool sound(const CornerFit& fit);

// `grey` 8 or 16 bit; `first`, `second` as in Saddle; the window reaches `half_px` to each side. `bend1`,
// `bend2`: curvature of the edges (1/px, positive towards their normals) where a lens bends them. nullopt:
// the window leaves the picture, the edges are not there, or the corner walked off.
struct CornerStart {
    Eigen::Vector2d at, first, second;
    int half_px = 8;
    double bend1 = 0, bend2 = 0;
};
std::optional<CornerFit> fit_corner(const cv::Mat& grey, const CornerStart& start);

}  // namespace seamwright::detail
