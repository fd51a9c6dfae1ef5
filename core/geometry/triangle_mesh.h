#pragma once
// A surface as triangles: parts and bodies, from files, drawings and formulas.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

namespace seamwright {

struct TriangleMesh {
    std::vector<Eigen::Vector3d> vertices;  // mm
    std::vector<Eigen::Vector3i>
        triangles;  // anticlockwise seen from outside; the renderer lights both sides
    Eigen::AlignedBox3d box() const {
        Eigen::AlignedBox3d b;
        for (const auto& v : vertices) b.extend(v);
        return b;
    }
};

}  // namespace seamwright
