#include "projects/proof/path_direction.h"

#include "projects/measure/measure.h"

namespace seamwright {

std::vector<PathDirection> path_directions(const Project& project, const Region& region) {
    std::vector<PathDirection> out;
    for (const SpotObservation& spot : planned_observations(project, region)) {
        Eigen::Vector3d tangent = Eigen::Vector3d::UnitY();
        if (spot.curve) tangent = {spot.curve->x_coefficients[0], 1, spot.curve->z_coefficients[0]};
        tangent = (spot.workobject_from_sensor.linear() * tangent).normalized();
        const Eigen::Vector3d z = spot.workobject_from_sensor.linear().col(2);
        const Eigen::Vector3d normal = (z - z.dot(tangent) * tangent).normalized();
        const Eigen::Vector3d point = spot.workobject_from_sensor * spot.reference_mm;
        out.push_back({spot.id, true, point, normal});
        out.push_back({spot.id, false, point, tangent.cross(normal)});
    }
    return out;
}

}  // namespace seamwright
