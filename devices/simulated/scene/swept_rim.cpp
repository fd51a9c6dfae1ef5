#include "devices/simulated/scene/swept_rim.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "devices/simulated/scene/door.h"

namespace seamwright {

TriangleMesh swept_rim_mesh(std::span<const RimPiece> pieces, double facet_mm) {
    const std::vector<DoorSectionPoint> section = door_rim_section();
    const int rows = static_cast<int>(section.size());
    const double edge_x = default_door_spots().front().edge_mm.x();
    TriangleMesh mesh;
    for (const RimPiece& piece : pieces) {
        const double radius = std::abs(piece.radius_mm);
        assert(radius > 120 && facet_mm > 0);
        const bool straight = !std::isfinite(radius);
        // Sagitta of a chord L: L^2 / (8 R).
        const int steps =
            straight ? 1
                     : std::max(2, static_cast<int>(std::ceil(2 * piece.half_length_mm /
                                                              std::sqrt(8 * (radius - 60) * facet_mm))));
        const int first = static_cast<int>(mesh.vertices.size());
        for (int i = 0; i <= steps; ++i) {
            const double arc = piece.half_length_mm * (2.0 * i / steps - 1);
            for (const DoorSectionPoint& c : section) {
                Eigen::Vector3d p(edge_x + c.inboard_mm, arc, c.height_mm - kDoorFlangeTop_mm);
                if (!straight) {
                    const double turn = arc / radius, reach = piece.radius_mm - c.inboard_mm;
                    p.x() = edge_x + piece.radius_mm - reach * std::cos(turn);
                    p.y() = std::abs(reach) * std::sin(turn);
                }
                mesh.vertices.push_back(piece.part_from_sensor * p);
            }
        }
        const auto at = [&](int i, int row) { return first + i * rows + row; };
        for (int i = 0; i < steps; ++i) {
            for (int r = 0; r + 1 < rows; ++r) {
                mesh.triangles.emplace_back(at(i, r), at(i + 1, r), at(i, r + 1));
                mesh.triangles.emplace_back(at(i + 1, r), at(i + 1, r + 1), at(i, r + 1));
            }
        }
    }
    return mesh;
}

}  // namespace seamwright
