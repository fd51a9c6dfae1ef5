#include "devices/drawing/edge_path.h"

#include <algorithm>
#include <cmath>

namespace seamwright {
namespace {

// Samples so far apart that the chord error is kept: every step_mm, and where the drawing's own samples are denser because
// the edge bends.
std::vector<DrawingPoint> spaced(const std::vector<DrawingPoint>& points, double step_mm) {
    std::vector<DrawingPoint> kept = {points.front()};
    for (std::size_t i = 1; i < points.size(); ++i) {
        const DrawingPoint& last = kept.back();
        const bool far = points[i].arc_mm - last.arc_mm >= step_mm * (1 - 1e-9);
        const bool bends =
            std::isfinite(points[i].radius_mm) || points[i].tangent.dot(last.tangent) < 1 - 1e-9;
        if (far || bends || i + 1 == points.size()) kept.push_back(points[i]);
    }
    return kept;
}

}  // namespace

Expected<EdgePath> edge_path(const Drawing& drawing, const std::string& edge,
                             const EdgePathOptions& options) {
    if (!(std::abs(options.offset_mm) <= 1000))
        return input_error(Text("{} mm is no offset from an edge", options.offset_mm), edge,
                           "give -1000 to 1000 mm");
    if (!(std::abs(options.stand_off_mm) <= 1000))
        return input_error(Text("{} mm is no stand-off of a tool", options.stand_off_mm), edge,
                           "give -1000 to 1000 mm");
    if (!(options.step_mm >= 0.05 && options.step_mm <= 1000))
        return input_error(Text("{} mm is no step along a path", options.step_mm), edge,
                           "give 0.05 to 1000 mm");
    std::vector<DrawingPoint> points;
    EdgePath path;
    SEAM_TRY(const auto chain, tangent_chain(drawing, edge));
    if (options.chain) {
        points = chain.points;
        path.closed = chain.closed;
    } else {
        const DrawingEdge& one = *find_edge(drawing, edge);
        points = one.points;
        path.closed = one.closed;
    }
    if (points.size() < 2) return input_error("the edge has no length", edge);
    path.length_mm = points.back().arc_mm;
    points = spaced(points, options.step_mm);
    if (options.reversed) {
        std::reverse(points.begin(), points.end());
        for (DrawingPoint& p : points) {
            p.tangent = -p.tangent;
            std::swap(p.normal_left, p.normal_right);
            p.arc_mm = path.length_mm - p.arc_mm;
        }
    }
    if (path.closed && points.size() > 2) points.pop_back();
    const double side = std::abs(options.offset_mm);
    std::vector<Eigen::Vector3d> beside;
    for (const DrawingPoint& p : points) {
        const bool left = options.offset_mm > 0, right = options.offset_mm < 0;
        const Eigen::Vector3d middle = p.normal_left + p.normal_right;
        Eigen::Vector3d normal = left ? p.normal_left : right ? p.normal_right : middle;
        if (normal.norm() < 1e-6) normal = p.normal_left;  // two faces back to back
        normal -= normal.dot(p.tangent) * p.tangent;
        if (!(normal.norm() > 1e-6))
            return input_error(Text("the edge has no side at {:.1f} mm of its length", p.arc_mm), edge);
        normal.normalize();
        Eigen::Vector3d into = Eigen::Vector3d::Zero();
        if (left) into = normal.cross(p.tangent);
        if (right) into = p.tangent.cross(normal);
        Eigen::Matrix3d r;
        r.col(0) = p.tangent;
        r.col(2) = -normal;
        r.col(1) = r.col(2).cross(r.col(0));
        beside.push_back(p.point_mm + side * into);
        path.drawing_from_tool.push_back(make_pose(r, beside.back() + options.stand_off_mm * normal));
    }
    for (std::size_t i = 0; i + 1 < points.size() && side > 0; ++i) {
        const Eigen::Vector3d travel = points[i].tangent + points[i + 1].tangent;
        if ((beside[i + 1] - beside[i]).dot(travel) <= 0)
            return input_error(Text("beside the edge by {} mm the path turns back at {:.1f} mm of its length",
                                    side, points[i].arc_mm),
                               edge, "give a smaller offset than the edge's radius there, or the other side");
    }
    return path;
}

}  // namespace seamwright
