#include "core/geometry/three_two_one.h"

#include <algorithm>
#include <cmath>

namespace seamwright {
namespace {

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return deg_from_rad(std::atan2(a.cross(b).norm(), a.dot(b)));
}

}  // namespace

Expected<Pose> frame_by_three_two_one(const std::array<Eigen::Vector3d, 3>& plane,
                                      const std::array<Eigen::Vector3d, 2>& line,
                                      const Eigen::Vector3d& point) {
    for (const auto* p : {&plane[0], &plane[1], &plane[2], &line[0], &line[1], &point})
        if (!p->allFinite()) return input_error("a picked point is not finite", "3-2-1");
    double smallest_deg = 180;
    for (std::size_t i = 0; i < 3; ++i) {
        const Eigen::Vector3d a = plane[(i + 1) % 3] - plane[i], b = plane[(i + 2) % 3] - plane[i];
        if (a.norm() < kNearestPick_mm)
            return input_error("two points of the plane coincide", "3-2-1", "pick three places far apart");
        smallest_deg = std::min(smallest_deg, angle_deg(a, b));
    }
    if (smallest_deg < kFlattestPick_deg)
        return input_error("the three points of the plane lie on a line", "3-2-1",
                           "pick three places far apart");
    const Eigen::Vector3d z = (plane[1] - plane[0]).cross(plane[2] - plane[0]).normalized();
    const Eigen::Vector3d along = line[1] - line[0];
    if (along.norm() < kNearestPick_mm)
        return input_error("the two points of the line coincide", "3-2-1", "pick two places far apart");
    const double off_normal_deg = std::min(angle_deg(along, z), angle_deg(along, -z));
    if (off_normal_deg < kFlattestPick_deg)
        return input_error("the line stands upright on the plane", "3-2-1",
                           "pick its two points along the direction that is to be X");
    const Eigen::Vector3d x = (along - along.dot(z) * z).normalized();
    const auto on_plane = [&](const Eigen::Vector3d& p) {
        return Eigen::Vector3d(p - (p - plane[0]).dot(z) * z);
    };
    const Eigen::Vector3d start = on_plane(line[0]);
    Pose frame = Pose::Identity();
    frame.linear() << x, z.cross(x), z;
    frame.translation() = start + (point - start).dot(x) * x;
    return frame;
}

}  // namespace seamwright
