#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <unordered_map>

#include "core/geometry/pose.h"
#include "core/geometry/welded.h"
#include "devices/drawing/drawing.h"

namespace seamwright {
namespace {

// Two triangles' common side, a to b as the left one runs.
struct Piece {
    int a = 0, b = 0;
    Eigen::Vector3d left, right;  // normals
    bool border = false;
    bool taken = false;
};

std::size_t at(int i) {
    return static_cast<std::size_t>(i);
}

std::vector<Piece> pieces_of(const TriangleMesh& mesh, double sharp_deg) {
    const std::vector<int> same = welded(mesh);
    struct Side {
        int a = 0, b = 0, triangle = -1, other = -1;
        bool other_forward = false;
    };
    std::map<std::pair<int, int>, Side> sides;
    std::vector<Eigen::Vector3d> normals;
    for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
        const Eigen::Vector3i t(same[at(mesh.triangles[k][0])], same[at(mesh.triangles[k][1])],
                                same[at(mesh.triangles[k][2])]);
        const auto& v = mesh.vertices;
        const Eigen::Vector3d n = (v[at(t[1])] - v[at(t[0])]).cross(v[at(t[2])] - v[at(t[0])]);
        normals.push_back(n.norm() > 0 ? Eigen::Vector3d(n.normalized()) : Eigen::Vector3d::Zero());
        if (!(n.norm() > 0)) continue;
        for (int c = 0; c < 3; ++c) {
            const int a = t[c], b = t[(c + 1) % 3];
            Side& side = sides[{std::min(a, b), std::max(a, b)}];
            if (side.triangle < 0)
                side.a = a, side.b = b, side.triangle = static_cast<int>(k);
            else if (side.other < 0)
                side.other = static_cast<int>(k);
        }
    }
    const double most = std::cos(rad_from_deg(sharp_deg));
    std::vector<Piece> pieces;
    for (const auto& [key, side] : sides) {
        const Eigen::Vector3d& left = normals[at(side.triangle)];
        if (side.other < 0) {
            pieces.push_back({side.a, side.b, left, left, true, false});
        } else if (const Eigen::Vector3d& right = normals[at(side.other)]; left.dot(right) <= most) {
            pieces.push_back({side.a, side.b, left, right, false, false});
        }
    }
    return pieces;
}

struct Step {
    std::size_t piece = 0;
    bool reversed = false;
};

class Chains {
  public:
    Chains(const TriangleMesh& mesh, std::vector<Piece> pieces, double bend_deg)
        : mesh_(mesh), pieces_(std::move(pieces)), straight_(std::cos(rad_from_deg(bend_deg))) {
        for (std::size_t i = 0; i < pieces_.size(); ++i) {
            meeting_[pieces_[i].a].push_back(i);
            meeting_[pieces_[i].b].push_back(i);
        }
    }
    std::vector<std::vector<Step>> all() {
        std::vector<std::vector<Step>> out;
        for (std::size_t i = 0; i < pieces_.size(); ++i) {
            if (pieces_[i].taken) continue;
            pieces_[i].taken = true;
            std::vector<Step> forward{{i, false}};
            while (const auto next = after(forward.back())) forward.push_back(*next);
            std::vector<Step> backward{{i, true}};
            while (const auto next = after(backward.back())) backward.push_back(*next);
            std::vector<Step> chain;
            for (std::size_t k = backward.size(); k-- > 1;)
                chain.push_back({backward[k].piece, !backward[k].reversed});
            chain.insert(chain.end(), forward.begin(), forward.end());
            out.push_back(std::move(chain));
        }
        return out;
    }
    const Piece& piece(const Step& s) const { return pieces_[s.piece]; }
    int from(const Step& s) const { return s.reversed ? piece(s).b : piece(s).a; }
    int to(const Step& s) const { return s.reversed ? piece(s).a : piece(s).b; }
    Eigen::Vector3d along(const Step& s) const {
        return (mesh_.vertices[at(to(s))] - mesh_.vertices[at(from(s))]).normalized();
    }

  private:
    std::optional<Step> after(const Step& s) {
        const std::vector<std::size_t>& here = meeting_[to(s)];
        if (here.size() != 2) return std::nullopt;
        const std::size_t i = here[0] == s.piece ? here[1] : here[0];
        if (i == s.piece || pieces_[i].taken || pieces_[i].border != piece(s).border) return std::nullopt;
        const Step next{i, pieces_[i].a != to(s)};
        if (along(s).dot(along(next)) < straight_) return std::nullopt;
        pieces_[i].taken = true;
        return next;
    }
    const TriangleMesh& mesh_;
    std::vector<Piece> pieces_;
    double straight_;
    std::unordered_map<int, std::vector<std::size_t>> meeting_;
};

double circle_radius(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    const double area = (b - a).cross(c - a).norm();
    const double product = (b - a).norm() * (c - b).norm() * (a - c).norm();
    return area > 1e-9 * product ? product / (2 * area) : std::numeric_limits<double>::infinity();
}

DrawingPoint between(const DrawingPoint& a, const DrawingPoint& b, double share) {
    DrawingPoint p = a;
    p.point_mm += share * (b.point_mm - a.point_mm);
    p.arc_mm += share * (b.arc_mm - a.arc_mm);
    p.tangent = (b.point_mm - a.point_mm).normalized();
    p.normal_left = ((1 - share) * a.normal_left + share * b.normal_left).normalized();
    p.normal_right = ((1 - share) * a.normal_right + share * b.normal_right).normalized();
    if (share > 0.5) p.radius_mm = b.radius_mm;
    return p;
}

DrawingEdge edge_of(const TriangleMesh& mesh, const Chains& chains, const std::vector<Step>& steps,
                    double step_mm) {
    DrawingEdge edge;
    edge.kind = "chain";
    edge.closed = steps.size() > 2 && chains.from(steps.front()) == chains.to(steps.back());
    const std::size_t n = steps.size();
    std::vector<DrawingPoint> corners;
    for (std::size_t i = 0; i <= n; ++i) {
        DrawingPoint p;
        const Step& before = steps[i > 0 ? i - 1 : edge.closed ? n - 1 : 0];
        const Step& behind = steps[i < n ? i : edge.closed ? 0 : n - 1];
        p.point_mm = mesh.vertices[at(i < n ? chains.from(steps[i]) : chains.to(steps[n - 1]))];
        p.tangent = (chains.along(before) + chains.along(behind)).normalized();
        Eigen::Vector3d left = Eigen::Vector3d::Zero(), right = left;
        for (const Step* s : {&before, &behind}) {
            left += s->reversed ? chains.piece(*s).right : chains.piece(*s).left;
            right += s->reversed ? chains.piece(*s).left : chains.piece(*s).right;
        }
        p.normal_left = left.normalized();
        p.normal_right = right.normalized();
        if (i > 0) p.arc_mm = corners.back().arc_mm + (p.point_mm - corners.back().point_mm).norm();
        corners.push_back(p);
    }
    for (std::size_t i = 0; i <= n; ++i) {
        if (!edge.closed && (i == 0 || i == n)) continue;
        const std::size_t a = i > 0 ? i - 1 : n - 1, b = i < n ? i + 1 : 1;
        corners[i].radius_mm = circle_radius(corners[a].point_mm, corners[i].point_mm, corners[b].point_mm);
    }
    for (std::size_t i = 0; i < n; ++i) {
        const double length = corners[i + 1].arc_mm - corners[i].arc_mm;
        const int parts = std::clamp(static_cast<int>(std::ceil(length / step_mm)), 1, 100000);
        edge.points.push_back(corners[i]);
        for (int k = 1; k < parts; ++k)
            edge.points.push_back(between(corners[i], corners[i + 1], static_cast<double>(k) / parts));
    }
    edge.points.push_back(corners.back());
    edge.length_mm = edge.points.back().arc_mm;
    const DrawingPoint& middle = edge.points[edge.points.size() / 2];
    if (!chains.piece(steps.front()).border) {
        edge.right = "f1";
        edge.fold_deg = deg_from_rad(std::atan2(middle.normal_left.cross(middle.normal_right).norm(),
                                                middle.normal_left.dot(middle.normal_right)));
        edge.convex = middle.normal_left.cross(middle.tangent).dot(middle.normal_right) < 0;
    }
    edge.left = "f1";
    return edge;
}

}  // namespace

std::vector<DrawingEdge> sharp_edges(const TriangleMesh& mesh, double sharp_deg, double bend_deg,
                                     double step_mm) {
    Chains chains(mesh, pieces_of(mesh, sharp_deg), bend_deg);
    std::vector<DrawingEdge> edges;
    for (const std::vector<Step>& steps : chains.all()) {
        edges.push_back(edge_of(mesh, chains, steps, step_mm));
        edges.back().id = "e" + std::to_string(edges.size());
    }
    return edges;
}

}  // namespace seamwright
