#include "core/calibration/stripe/stripe_scale.h"

#include <cmath>
#include <memory>
#include <vector>

#include "core/calibration/problem.h"
#include "core/profile/sensor_model.h"

namespace seamwright {

FieldScale stripe_scale(const Intrinsics& intrinsics, int width, int height, const LaserPlane& plane,
                        const Eigen::MatrixXd& basis, const Eigen::MatrixXd& covariance,
                        const std::function<Pose(const LaserPlane&)>& frame) {
    const Eigen::Index n = covariance.rows(), camera = n - 3;
    if (camera < 0 || basis.cols() != camera || !covariance.allFinite()) return {};
    const std::unique_ptr<ceres::Manifold> manifold(plane_manifold());
    const auto model = [&](const Eigen::VectorXd& delta) {
        const Intrinsics k = intrinsics + basis * delta.head(camera);
        Eigen::Vector4d at, moved;
        at << plane.normal, plane.offset_mm;
        const Eigen::Vector3d step = delta.tail<3>();
        manifold->Plus(at.data(), step.data(), moved.data());
        return SensorModel{camera_of(k, width, height), frame({moved.head<3>(), moved[3]}), std::nullopt};
    };
    constexpr int kPlaces = 5;  // each way
    std::vector<Eigen::Vector2d> pixels, places;
    const SensorModel middle = model(Eigen::VectorXd::Zero(n));
    for (int i = 0; i < kPlaces; ++i)
        for (int j = 0; j < kPlaces; ++j) {
            const Eigen::Vector2d pixel(width * (i + 0.5) / kPlaces, height * (j + 0.5) / kPlaces);
            if (const auto at = middle.to_laser(pixel)) pixels.push_back(pixel), places.push_back(*at);
        }
    const auto count = static_cast<Eigen::Index>(places.size());
    Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(2 * count, n);
    for (Eigen::Index k = 0; k < n; ++k) {
        const double sigma = std::sqrt(std::max(0.0, covariance(k, k)));
        if (!(sigma > 0)) continue;
        constexpr double kStepShare = 1e-3;  // of the sigma
        const double h = kStepShare * sigma;
        const SensorModel up = model(h * Eigen::VectorXd::Unit(n, k)),
                          down = model(-h * Eigen::VectorXd::Unit(n, k));
        for (Eigen::Index i = 0; i < count; ++i) {
            const auto a = up.to_laser(pixels[static_cast<std::size_t>(i)]),
                       b = down.to_laser(pixels[static_cast<std::size_t>(i)]);
            if (!a || !b) return {};
            slope.block<2, 1>(2 * i, k) = (*a - *b) / (2 * h);
        }
    }
    return field_scale(places, slope * covariance * slope.transpose());
}

}  // namespace seamwright
