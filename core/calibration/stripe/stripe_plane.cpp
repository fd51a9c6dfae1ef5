#include "core/calibration/stripe/stripe_plane.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "core/median.h"

namespace seamwright::detail {

std::optional<LaserPlane> fit_plane(const StripePoints& points, const std::vector<char>& chosen) {
    constexpr double kCauchy_mm = 0.2;       // distance from the plane at which a point's weight is halved
    constexpr double kOneLine = 1e-9;        // of the scatter along a line, across it: less fixes no plane
    constexpr double kNormalSettled = 1e-9;  // rad
    std::optional<LaserPlane> plane;
    for (int iteration = 0; iteration < 12; ++iteration) {
        Eigen::Vector3d mean = Eigen::Vector3d::Zero();
        Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
        double sum = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!chosen[i] || points[i].empty()) continue;
            const double share = 1 / static_cast<double>(points[i].size());
            for (const auto& p : points[i]) {
                double w = share;
                if (plane) {
                    const double q = (plane->normal.dot(p) + plane->offset_mm) / kCauchy_mm;
                    w /= 1 + q * q;
                }
                mean += w * p;
                square += w * p * p.transpose();
                sum += w;
            }
        }
        if (!(sum > 0)) return std::nullopt;
        mean /= sum;
        const Eigen::Matrix3d scatter = square / sum - mean * mean.transpose();
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scatter);
        if (eigen.info() != Eigen::Success || !(eigen.eigenvalues()(1) > kOneLine * eigen.eigenvalues()(2)))
            return std::nullopt;
        LaserPlane next;
        next.normal = eigen.eigenvectors().col(0).normalized();
        if (next.normal.z() < 0) next.normal = -next.normal;
        next.offset_mm = -next.normal.dot(mean);
        const bool still = plane && (next.normal - plane->normal).norm() < kNormalSettled;
        plane = next;
        if (still) break;
    }
    return plane;
}

double median_off_plane(const LaserPlane& plane, const std::vector<Eigen::Vector3d>& points) {
    if (points.empty()) return std::numeric_limits<double>::infinity();
    std::vector<double> d;
    d.reserve(points.size());
    for (const auto& p : points) d.push_back(std::abs(plane.normal.dot(p) + plane.offset_mm));
    return median(d);
}

std::optional<PlaneConsensus> consensus_plane(const StripePoints& points, double limit_mm) {
    std::optional<PlaneConsensus> best;
    double best_score = -1;
    const auto score = [&](const LaserPlane& plane, std::vector<char>& frames) {
        double s = 0;
        frames.assign(points.size(), 0);
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (points[i].empty()) continue;
            const double m = median_off_plane(plane, points[i]);
            if (m < limit_mm) {
                frames[i] = 1;
                s += 1 - 0.5 * m / limit_mm;
            }
        }
        return s;
    };
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t j = i + 1; j < points.size(); ++j) {
            if (points[i].empty() || points[j].empty()) continue;
            std::vector<char> frames(points.size(), 0);
            frames[i] = frames[j] = 1;
            auto plane = fit_plane(points, frames);
            for (int step = 0; plane && step < 4; ++step) {
                const double s = score(*plane, frames);
                if (s > best_score) {
                    best_score = s;
                    best = PlaneConsensus{*plane, frames};
                }
                plane = fit_plane(points, frames);
            }
        }
    return best;
}

}  // namespace seamwright::detail
