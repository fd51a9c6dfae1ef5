#include "projects/scan/drawn_edges.h"

#include <algorithm>
#include <set>

namespace seamwright {
namespace {

// `into` the face, seen from outside on the left of the tangent or on its right.
EdgeCurve side_of(const std::vector<DrawingPoint>& points, bool left) {
    EdgeCurve curve;
    for (const DrawingPoint& p : points) {
        if (!curve.samples.empty() && !(p.arc_mm > curve.samples.back().arc_mm)) continue;
        EdgeSample s;
        s.point_mm = p.point_mm;
        s.tangent = p.tangent.normalized();
        Eigen::Vector3d normal = left ? p.normal_left : p.normal_right;
        normal -= normal.dot(s.tangent) * s.tangent;
        s.normal = normal.norm() > 1e-6 ? Eigen::Vector3d(normal.normalized()) : s.tangent.unitOrthogonal();
        s.outward = left ? s.tangent.cross(s.normal) : s.normal.cross(s.tangent);
        s.arc_mm = p.arc_mm;
        curve.samples.push_back(s);
    }
    return curve;
}

}  // namespace

Expected<std::vector<EdgeCurve>> drawn_edges(const Drawing& drawing, const std::vector<std::string>& edges,
                                             bool chain) {
    if (edges.empty()) return input_error("no edge is given", Text(drawing.source));
    std::vector<EdgeCurve> out;
    std::set<std::string> taken;
    int number = 0;
    for (const std::string& id : edges) {
        SEAM_TRY(const auto found, tangent_chain(drawing, id));
        if (!taken.insert(id).second) continue;
        const DrawingEdge& edge = *find_edge(drawing, id);
        if (chain)
            for (const EdgeChain::Part& part : found.parts) taken.insert(part.edge);
        const std::vector<DrawingPoint>& points = chain ? found.points : edge.points;
        for (const bool left : {true, false}) {
            if (!left && edge.right.empty()) continue;
            EdgeCurve curve = side_of(points, left);
            curve.edge = number;
            curve.name = id;
            curve.closed = chain ? found.closed : edge.closed;
            curve.sided = !edge.right.empty();
            if (curve.samples.size() >= 2) out.push_back(std::move(curve));
        }
        ++number;
    }
    return out;
}

}  // namespace seamwright
