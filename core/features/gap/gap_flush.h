#pragma once
// Gap and flush between two parts in one profile, as body and panel shops measure them (methods.md 2, 6).
//
//     reference side            other side
//     ______________           /------------   flush > 0: the other side stands proud
//                   \         |
//                    |<- gap->|
//
// The line of the reference side's surface, fitted beside its edge, gives the directions: u along the surface
// into the gap, n across it on the side of the sensor (+z). Each part's edge is its outermost place along u:
// a fold's roundest point where that is seen, else the last return and half of what the contour advances
// along u from one line to the next. The other
// side's surface line, fitted beside its edge, is continued to that edge.
//     gap   = u . (other edge - reference edge)                       negative when the parts overlap
//           or, as a feeler gauge finds it, the distance of the two edges with that sign
//           (GapBy::edge_distance)
//     flush = n . (other surface at its edge - reference line)        positive when the other side stands
//     proud
//
// Noise model: across each surface, from each line's residuals, their likeness and the profile's noise
// (contour_noise.h); an edge is spread evenly over that advance a along u, at least over a third of the pitch (variance
// a^2 / 12 each; a sensor's noise is in z and moves it by its part along u as well), and known to a point's noise across.
// On a grid whose points were measured f lines apart and straight lines drawn between
// them (contour_noise.h) it lies f a / 2 farther out, with f^2 a^2 / 12 more; d f a / 2 and d (1 - d) f^2 a^2 / 4 beside it where
// that is only d likely.
// Where a share of a surface's lines is lost, the last ones may be: q (1 + q) / (1 - q)^2 pitches^2 more, q the share
// beyond 0.01, which an ellipse of 95 % leaves out.
// Behind the edge a sensor that means m lines has drawn the step over m - 1 of them: the edge is
// their middle, with (m - 1)^2 / 12 pitches^2 more; a flank that is seen counts m times. Where nothing is known of its
// smoothing, and ground is seen: half of the steep lines beside the edge.
// A stretch of a face is known to its m returns' noise along u, sigma_u / sqrt(m), and to what choosing it costs.
// Covariance of (gap, flush) in mm^2.

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "core/features/contour/line_fit.h"
#include "core/features/feature_points.h"
#include "core/features/gap/gap_sides.h"
#include "core/text.h"

namespace seamwright {

enum class GapFlushStatus {
    ok,
    no_points,       // fewer usable points than two surfaces need
    not_found,       // no two sides: the contour is not broken
    ill_conditioned  // a surface line is too short or not straight, or may be the gap's ground
};
std::string_view to_string(GapFlushStatus status);

enum class GapBy { along_surface, edge_distance };

struct GapFlushSettings {
    enum class Reference { left, right } reference = Reference::left;
    GapBy gap_by = GapBy::along_surface;
    FeatureWindow window{-1e5, 1e5, -1e5, 1e5};
    double surface_mm = 5;      // length of surface that a line takes
    double edge_skip_mm = 1.5;  // beside the edge, left out of the line: the fold's radius
    int minimum_points = 8;     // per side; shorter pieces (the gap's ground, dirt) are no side
};

// Refuses an empty window and lengths or counts that are no surface.
Expected<void> check(const GapFlushSettings& settings);

struct GapFlush {
    GapFlushStatus status = GapFlushStatus::not_found;
    double gap_mm = 0, flush_mm = 0;
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  // of (gap, flush)
    Eigen::Vector2d reference_edge_mm = Eigen::Vector2d::Zero(), other_edge_mm = Eigen::Vector2d::Zero();
    // The surfaces at their edges: flush and the gap along the surface are n and u of their difference.
    Eigen::Vector2d reference_point_mm = Eigen::Vector2d::Zero(), other_point_mm = Eigen::Vector2d::Zero();
    Eigen::Vector2d along = Eigen::Vector2d::UnitX();  // u
    Text message;                                      // empty when ok
};

// Allocates nothing after the first calls; one thread per object. `profile` as for features; settings as
// check() passes them. Sides: gap_sides.h.
class GapFlushGauge {
  public:
    explicit GapFlushGauge(const GapFlushSettings& settings) : settings_(settings) {}
    GapFlush measure(const Profile& profile);

  private:
    struct Side {
        LineFit line;
        Eigen::Vector2d edge;
        double edge_variance = 0;  // along u
    };
    bool measure_line(const GapPart& part, double edge_along_x, double inward, LineFit& line);
    bool measure_face(const GapPart& part, const Eigen::Vector2d& u, double pitch, Side& side);
    void measure_edge(const GapPart& part, const Eigen::Vector2d& u, double pitch, Side& side);

    GapFlushSettings settings_;
    GapSides sides_;
    LineWorkspace workspace_;
    std::vector<double> x_, z_;
    std::vector<Eigen::Vector2d> face_;  // across, along; from the surface down
};

}  // namespace seamwright
