#pragma once
// A contour as a curve with known uncertainty: what the point-to-line finish of the registration measures
// against.
//
// Between two neighbouring points the curve is a parabola or a line, fitted over a window of points around
// them. The window grows while the points keep to the fit within their noise and stops at corners, so that
// straight and gently curved pieces are averaged over many points (a line through two noisy neighbours would
// tilt by noise / pitch and bring information along the contour that is not there) while corners stay sharp.
// Fits run over the point number, x and z apart, so every window costs the same: sums come from running sums. Where points are
// spaced unevenly the stretch between two of them is moved along its fit to where they are.
//
// Noise model: noise of equal size on every point, across the contour, estimated from the fits' residuals; each point's
// its own, or shared by neighbours (ContourPitch::alike()), whose waves are then no bends of the contour. A fitted value is a linear function of the window's points with known weights, which is what
// lets the registration propagate the noise of a recorded template.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/features/contour/contour_pitch.h"
#include "core/profile/profile.h"

namespace seamwright {

class ContourModel {
  public:
    // One stretch of curve between points `point` and `point + 1`.
    struct Edge {
        double cx, cz;     // its middle
        double tx, tz;     // unit tangent there; the normal is (-tz, tx)
        double curvature;  // along the normal, 1/mm
        double half;       // half its length, mm
        double index_mm;   // point numbers per mm of tangent
        double xi;         // point number of its middle, counted from the middle of the fit's window
        double centre;     // point number of the middle of the window
        int first, count;  // the window's points
        int degree;        // 1 line, 2 parabola
        int point;
        int previous, next;  // neighbours along the contour or -1
        bool wall;           // bridges a jump: says that the contour steps here, holds no measured point
        int run;             // unbroken piece of contour
    };
    // Where a point falls on the curve. `u` along the edge's tangent from its middle, `residual` across
    // (positive on the normal's side), curvature included; `beyond` how far past the edge's end, where a sheet ends or
    // bends sharply. edge = -1: nothing within the radius, or beyond an end.
    struct Foot {
        int edge = -1;
        double u = 0, residual = 0, beyond = 0;
    };

    // Uses the points that are finite and not marked as outliers. At least 5 points with extent are a
    // precondition of use (`usable()` tells).
    // `shared` (ContourPitch's) and the points' noise, where a longer profile of the sensor knows them; 0: from the points.
    void build(const Profile& profile, double shared = 0, double sigma_mm = 0);
    bool usable() const { return edges_.size() >= 4; }

    // All coordinates are relative to `origin()`, the centroid of the points: a contour far from the frame's
    // origin loses no digits, and turning and shifting stay apart.
    const Eigen::Vector2d& origin() const { return origin_; }
    const std::vector<double>& x() const { return x_; }
    const std::vector<double>& z() const { return z_; }
    const std::vector<Edge>& edges() const { return edges_; }
    double sigma_mm() const { return sigma_; }
    double extent_mm() const { return extent_; }  // diagonal of the bounding box
    double length_mm() const { return length_; }  // along the contour, without walls
    const ContourPitch& pitch() const { return pitch_; }
    Eigen::Vector2d lower() const { return lower_; }
    Eigen::Vector2d upper() const { return upper_; }

    // The curve's nearest place to (px, pz) among places within `radius`: a windowed search along the longer
    // side of the contour. Exact for contours in any order, overhanging or closed; fast where they are
    // ordered.
    Foot nearest(double px, double pz, double radius) const;

    // Weights of the fit at `u` on `edge`: value = sum_k (a0 + a1 k + a2 k^2) * offset_k over the window, k
    // counted from `centre`. Returns the variance of value and slope in units of sigma^2 (slope per mm).
    struct Weights {
        double a0, a1, a2;
        double value_variance, slope_variance;
    };
    Weights weights(const Edge& edge, double u) const;

  private:
    void fit_edges();
    void put_at_points(Edge& edge) const;
    void build_nodes();
    // Coefficients of the orthogonal polynomials over a window of points, and its raw second moments.
    struct Window {
        Eigen::Vector2d b0, b1, b2, b3;
        double centre, xx, xz, zz;
        int first, count;
    };
    Window window(int first, int count) const;
    // The fit between `point` and the next; its sum of squared residuals and the next order's coefficient,
    // normalised to the noise of one point. False where the points coincide.
    bool fit_window(int point, const Window& window, int degree, Edge& edge, double& residual2,
                    double& bend) const;

    Eigen::Vector2d origin_ = Eigen::Vector2d::Zero(), lower_ = origin_, upper_ = origin_;
    std::vector<double> x_, z_;
    std::vector<int> run_first_, run_last_;  // [points] unbroken stretch (no gap, no wall) the point lies in
    std::vector<std::uint8_t> link_;         // [points] to the next one: 0 gap, 1 curve, 2 wall
    std::vector<Edge> edges_;
    double sigma_ = 0, extent_ = 0, length_ = 0;
    ContourPitch pitch_;
    // Running sums over the points for j = 0..2: k^j x, k^j z; then x x, x z, z z; then k^3 x, k^3 z.
    std::vector<std::array<double, 11>> sums_;
    // Search nodes, sorted along the longer side.
    bool along_z_ = false;
    std::vector<double> node_a_, node_b_;
    std::vector<int> node_edge_, bin_;
    double bin_origin_ = 0, bins_per_mm_ = 0, node_reach_ = 0;
    std::vector<double> scratch_;
};

}  // namespace seamwright
