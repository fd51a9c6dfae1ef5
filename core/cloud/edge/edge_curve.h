#pragma once
// An edge of the drawing as a curve, one side of it: the sheet that ends there.

#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose.h"

namespace seamwright {

struct EdgeSample {
    Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();
    // Unit: along the edge; along the sheet, away from it; out of the sheet. Orthogonal to each other.
    Eigen::Vector3d tangent = Eigen::Vector3d::UnitX(), outward = Eigen::Vector3d::UnitY(),
                    normal = Eigen::Vector3d::UnitZ();
    double arc_mm = 0;  // from the first sample
};

struct EdgeCurve {
    int edge = 0;      // of an edge with two faces both sides are given, with the same number
    std::string name;  // for people
    std::vector<EdgeSample>
        samples;  // two or more, arc ascending; of a closed one the last is the first again
    bool closed = false;
    bool sided = true;  // false: of a sheet without thickness, seen from either side
    double length_mm() const { return samples.empty() ? 0 : samples.back().arc_mm; }
};

// A point beside a curve: the frame at its foot, and where it lies in it.
struct BesideEdge {
    EdgeSample foot;
    double outward_mm = 0, normal_mm = 0;
};

// At the arc, cubic between the samples (Hermite), arcs beyond the ends the ends.
EdgeSample at_arc(const EdgeCurve& curve, double arc_mm);

// Asks curves for the nearest place, within `most_mm`.
class EdgeSearch {
  public:
    EdgeSearch(const EdgeCurve& curve, double most_mm);
    // Nothing: further away, or beyond an end of an open curve. `wanted` (unit): feet whose outward direction is more
    // than 53 degrees off are none.
    std::optional<BesideEdge> beside(const Eigen::Vector3d& p, const Eigen::Vector3d* wanted = nullptr) const;

  private:
    const EdgeCurve& curve_;
    double most_;
    Eigen::Vector3d corner_;
    double cell_;
    Eigen::Vector3i counts_;
    std::vector<std::vector<int>> cells_;
    const std::vector<int>* near(const Eigen::Vector3d& p) const;
};

}  // namespace seamwright
