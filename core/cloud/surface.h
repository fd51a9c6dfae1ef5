#pragma once
// A part's surface, asked for the nearest place to a point.
//
// Corners of the mesh nearer than a millionth of its size are one, so that a mesh whose triangles share no vertices
// (STL) knows its edges. Normals are smooth where neighbouring faces meet at less than 35 degrees, and the face's own
// at sharper edges: a round drawn by facets has the normals of the round, and tells nothing about a turn about its
// axis that the round does not tell. A border is an edge of one triangle alone: the sheet of a mesh without thickness
// ends there.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/cloud/cloud.h"
#include "core/geometry/triangle_mesh.h"

namespace seamwright {

struct SurfacePoint {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();   // on the surface, nearest
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit, smooth, outwards as the triangles turn
    double distance_mm = 0;                            // >= 0
    double signed_mm = 0;                              // positive outside
    int triangle = -1;
    bool at_border = false;  // the nearest place is on a border: the point may lie beyond the surface's end
};

class Surface {
  public:
    // Triangles without area are left out.
    explicit Surface(const TriangleMesh& mesh);

    bool empty() const { return faces_.empty(); }
    const Eigen::AlignedBox3d& box() const { return box_; }
    double size_mm() const { return box_.isEmpty() ? 0 : box_.diagonal().norm(); }
    double area_mm2() const { return area_; }
    // Within most_mm. With `facing` (unit) only triangles that face it by more than a grazing look: normal . facing > 0.1. Thread-safe.
    std::optional<SurfacePoint> nearest(const Eigen::Vector3d& p, double most_mm,
                                        const Eigen::Vector3d* facing = nullptr) const;
    // `count` points spread evenly over the area (stratified, by seed) with the smooth normals.
    Cloud sampled(std::size_t count, std::uint64_t seed) const;

  private:
    struct Face {
        std::array<Eigen::Vector3d, 3> corner;
        Eigen::Vector3d normal;
        std::array<Eigen::Vector3d, 3> smooth;  // at the corners
        std::uint8_t border = 0;                // bit k: the edge from corner k to k + 1; bit 3 + k: corner k
        int triangle = -1;
    };
    struct Node {
        Eigen::AlignedBox3d box;
        std::int32_t first = 0, count = 0;  // leaf: faces; inner (count 0): left child, right = first + 1
    };
    void build(std::int32_t node, std::int32_t first, std::int32_t count);
    SurfacePoint on(const Face& face, const Eigen::Vector3d& p) const;

    std::vector<Face> faces_;
    std::vector<Node> nodes_;
    Eigen::AlignedBox3d box_;
    double area_ = 0;
};

}  // namespace seamwright
