#pragma once
// The contour as taught, which a sensor that runs ahead looks for and a tool runs along: a curve with a length,
// and at every place of it the two directions that a profile tells of.
//
// Points c_i with an upward direction each (out of the part), in one frame, mm. Path length s: along the chords.
// At a point the travel t_i is the mean direction of its neighbours' chords; between two points c, t and up run
// linearly. Directions at s (orthonormal, right-handed):
//     along = t,   across = along x up,   height = across x along.
// Foot of a point p: the s with (p - c(s)) . t(s) = 0. That is quadratic between two points and continuous from
// one to the next, so a point that is shifted across the path has exactly the path length of the place that it
// was shifted from, on curves too, as long as it lies nearer than the radius of curvature. There
//     p = c(s) + off.x across(s) + off.y height(s).

#include <vector>

#include "core/error.h"
#include "core/geometry/pose.h"

namespace seamwright {

struct GuidePoint {
    Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();
    Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // any length
};

// A guide from measured points: by path length, a parabola through what lies within `half_width_mm` of every place
// (least squares, tricube weights), a place every `step_mm`. Noise of the points leaves by it; of a curve of radius R
// it takes half_width^4 / (24 R^3) at most, a tenth of a micrometre for 10 mm and 150 mm. Points that lie nearer than half a step to
// the one before are left out. Fewer than 3 points in a window: as measured.
std::vector<GuidePoint> smoothed_guide(const std::vector<GuidePoint>& points, double half_width_mm,
                                       double step_mm);

class GuideCurve {
  public:
    // Error (input): fewer than 2 points, numbers that are not finite, two points nearer than kNearestMm, a turn of
    // more than kSharpestDeg from one chord to the next, an upward direction along the travel.
    static Expected<GuideCurve> make(const std::vector<GuidePoint>& points);

    double length_mm() const { return places_.back().s_mm; }
    Eigen::Vector3d at(double s_mm) const;          // clamped to the curve
    Eigen::Matrix3d directions(double s_mm) const;  // columns: along, across, height

    struct Foot {
        double s_mm = 0;                                   // clamped to the curve
        Eigen::Vector2d off_mm = Eigen::Vector2d::Zero();  // across, height
        bool beyond = false;                               // before its begin or behind its end
    };
    // The nearest one within `reach_mm` of path length of `near_mm`; beyond where there is none.
    Foot foot(const Eigen::Vector3d& point_mm, double near_mm, double reach_mm) const;
    Foot foot(const Eigen::Vector3d& point_mm) const;  // anywhere on the curve

    static constexpr double kNearestMm = 1e-3, kSharpestDeg = 45;

  private:
    struct Place {
        Eigen::Vector3d point, along, up;
        double s_mm = 0;
    };
    struct Within {
        std::size_t i;
        double share;
    };
    Within within(double s_mm) const;
    Foot foot_at(const Eigen::Vector3d& p, double s_mm) const;
    double ahead_of(const Eigen::Vector3d& p, std::size_t i) const {
        return (p - places_[i].point).dot(places_[i].along);
    }
    std::vector<Place> places_;
};

}  // namespace seamwright
