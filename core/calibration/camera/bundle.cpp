#include "core/calibration/camera/bundle.h"

#include <cmath>

#include "core/calibration/camera/camera_costs.h"
#include "core/geometry/decompositions.h"

namespace seamwright {

std::optional<StereoPoint> triangulate(const PlacedCamera& first, const Eigen::Vector2d& first_pixel,
                                       const PlacedCamera& second, const Eigen::Vector2d& second_pixel) {
    const Pose a = first.camera_from_world.inverse(), b = second.camera_from_world.inverse();
    const Eigen::Vector3d u = (a.linear() * first.camera.undistort(first_pixel).homogeneous()).normalized();
    const Eigen::Vector3d v = (b.linear() * second.camera.undistort(second_pixel).homogeneous()).normalized();
    if (!u.allFinite() || !v.allFinite()) return std::nullopt;
    // a + s u and b + t v where the connection is perpendicular to both.
    const Eigen::Vector3d w = b.translation() - a.translation();
    const double c = u.dot(v), sine2 = 1 - c * c;
    if (sine2 < 1e-12) return std::nullopt;
    const double s = (w.dot(u) - c * w.dot(v)) / sine2, t = (c * w.dot(u) - w.dot(v)) / sine2;
    if (!(s > 0) || !(t > 0)) return std::nullopt;
    const Eigen::Vector3d p = a.translation() + s * u, q = b.translation() + t * v;
    return StereoPoint{0.5 * (p + q), (p - q).norm()};
}

Expected<BundlePose> bundle_object(const std::vector<PlacedCamera>& cameras,
                                   const std::vector<BundleSight>& sights, const Pose& start) {
    int counted = 0;
    for (std::size_t i = 0; i < sights.size(); ++i) {
        const std::string where = "sights[" + std::to_string(i) + "]";
        const auto& s = sights[i];
        if (s.camera < 0 || static_cast<std::size_t>(s.camera) >= cameras.size())
            return input_error(Text("there is no camera {}", std::to_string(s.camera)), where,
                               "cameras count from 0");
        if (!std::isfinite(s.weight) || s.weight < 0)
            return input_error("the weight must be 0 or positive", where,
                               "give 1 for an ordinary feature, 0 for none");
        if (!s.object_mm.allFinite() || (s.weight > 0 && !s.pixel.allFinite()))
            return input_error("the feature is not made of finite numbers", where, "give it the weight 0");
        counted += s.weight > 0;
    }
    if (counted < 3)
        return input_error("fewer than three features were seen", "sights", "give three or more");
    std::vector<camera_costs::Sights> seen;
    for (const auto& c : cameras) seen.push_back({intrinsics_of(c.camera), c.camera_from_world, {}});
    for (const auto& s : sights)
        if (s.weight > 0)
            seen[static_cast<std::size_t>(s.camera)].corners.push_back(
                {s.object_mm, s.pixel, std::sqrt(s.weight)});
    BundlePose out;
    out.world_from_object = start;
    const auto [cost, normal] = camera_costs::solve_pose(std::move(seen), out.world_from_object);
    if (!std::isfinite(cost))
        return input_error("a feature lies behind its camera at the start", "start", "give a better start");
    // Directions by the information scaled to unit diagonal, so that mm and rad do not matter.
    const Vector6 scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Matrix6 unit = scale.asDiagonal() * normal * scale.asDiagonal();
    out.determined = symmetric_eigen(unit).values(0) > 1e-9;
    out.rms_px = std::sqrt(cost / counted);
    if (out.determined && 2 * counted > 6) out.covariance = cost / (2 * counted - 6) * inverse_matrix(normal);
    return out;
}

}  // namespace seamwright
