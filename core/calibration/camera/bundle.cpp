#include "core/calibration/camera/bundle.h"

#include <limits>

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
    const double infinity = std::numeric_limits<double>::infinity();
    const auto evaluate = [&](const Pose& world_from_object, Matrix6* normal, Vector6* gradient) {
        double cost = 0;
        for (const auto& s : sights) {
            if (!(s.weight > 0)) continue;
            const auto& c = cameras[static_cast<std::size_t>(s.camera)];
            const Eigen::Vector3d turned = world_from_object.linear() * s.object_mm;
            const Eigen::Vector3d point =
                c.camera_from_world * Eigen::Vector3d(turned + world_from_object.translation());
            if (!(point.z() > 1e-6)) return infinity;
            Eigen::Vector2d pixel;
            Eigen::Matrix<double, 2, 3> by_point;
            project_with_jacobian(intrinsics_of(c.camera), point, pixel, &by_point, nullptr);
            const Eigen::Vector2d e = pixel - s.pixel;
            cost += s.weight * e.squaredNorm();
            if (!normal) continue;
            Eigen::Matrix<double, 2, 6> j;
            j.leftCols<3>() = by_point * c.camera_from_world.linear();
            j.rightCols<3>() = -j.leftCols<3>() * skew(turned);
            *normal += s.weight * j.transpose() * j;
            *gradient += s.weight * j.transpose() * e;
        }
        return std::isfinite(cost) ? cost : infinity;
    };
    BundlePose out;
    out.world_from_object = start;
    Matrix6 normal = Matrix6::Zero();
    Vector6 gradient = Vector6::Zero();
    double cost = evaluate(start, &normal, &gradient), damping = 1e-4;
    if (!std::isfinite(cost))
        return input_error("a feature lies behind its camera at the start", "start", "give a better start");
    for (int i = 0; i < 100 && damping < 1e12; ++i) {
        Matrix6 damped = normal;
        damped.diagonal() *= 1 + damping;
        const Vector6 step = -solve_symmetric(damped, gradient);
        const Pose trial = retract(out.world_from_object, step);
        const double c = step.allFinite() ? evaluate(trial, nullptr, nullptr) : infinity;
        if (!(c <= cost)) {
            damping *= 10;
            continue;
        }
        const double gain = cost - c;
        out.world_from_object = trial;
        normal.setZero();
        gradient.setZero();
        cost = evaluate(trial, &normal, &gradient);
        damping = std::max(damping * 0.1, 1e-12);
        if (gain <= 1e-12 * cost + 1e-24) break;
    }
    // Directions by the information scaled to unit diagonal, so that mm and rad do not matter.
    const Vector6 scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Matrix6 unit = scale.asDiagonal() * normal * scale.asDiagonal();
    out.determined = symmetric_eigen(unit).values(0) > 1e-9;
    out.rms_px = std::sqrt(cost / counted);
    if (out.determined && 2 * counted > 6) out.covariance = cost / (2 * counted - 6) * inverse_matrix(normal);
    return out;
}

}  // namespace seamwright
