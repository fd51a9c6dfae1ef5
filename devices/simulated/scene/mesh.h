#pragma once
// Triangles, and the tree that finds what a ray or a plane meets.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "core/geometry/triangle_mesh.h"

namespace seamwright {

struct RayHit {
    double distance_mm = 0;
    int triangle = -1;
};

// Where a plane crosses a triangle.
struct CutSegment {
    Eigen::Vector3d a, b;
    int triangle = -1;
};

// Bounding volume hierarchy (surface area heuristic, bins). Const calls are thread-safe.
class MeshTree {
  public:
    explicit MeshTree(TriangleMesh mesh);
    const TriangleMesh& mesh() const { return mesh_; }
    // New positions of the same vertices (a bent part): boxes are fitted again, the tree's shape stays.
    void move_vertices(std::vector<Eigen::Vector3d> vertices);

    // First triangle along origin + t * direction (unit) with min_mm < t < max_mm, `ignore` left out.
    std::optional<RayHit> first_hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                    double min_mm, double max_mm, int ignore = -1) const;
    // Whether anything but `ignore` stands between the points, nearer than `skip_mm` to either end not
    // counted.
    bool blocked(const Eigen::Vector3d& from, const Eigen::Vector3d& to, int ignore, double skip_mm) const;
    // Crossings with the plane normal . p = offset inside a sphere's box; replaces `segments`. A vertex on
    // the plane belongs to its positive side, so that every crossing comes once.
    void cut(const Eigen::Vector3d& normal, double offset_mm, const Eigen::Vector3d& centre, double radius_mm,
             std::vector<CutSegment>& segments) const;
    Eigen::Vector3d normal(int triangle) const;  // unit; zero for a degenerate triangle

  private:
    struct Node {
        Eigen::Vector3f low, high;
        std::int32_t first = 0;  // leaf: first in order_; inner: left child, right = first + 1
        std::int32_t count = 0;  // 0 = inner
    };
    struct Corner {
        Eigen::Vector3d p, e1, e2;  // corner and edges, in the order of order_
    };
    void build();
    void fit();
    bool hits(std::size_t slot, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
              double& t) const;

    TriangleMesh mesh_;
    std::vector<Node> nodes_;
    std::vector<std::int32_t> order_;  // triangle of a slot
    std::vector<Corner> corners_;
};

}  // namespace seamwright
