#include "core/calibration/sphere/sphere_scale.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace seamwright::tcp_sphere {

FieldScale sphere_scale(const std::vector<Section>& sections, const Model& model, double point_variance,
                        double centre_sigma) {
    constexpr double kLeastRadiusMm = 1;
    if (!(point_variance > 0)) return {};
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (const Section& section : sections) {
        if (!section.used) continue;
        const Eigen::Vector3d centre = centre_in_sensor(section, model);
        const double square = model.radius * model.radius - centre.y() * centre.y();
        if (!(square > kLeastRadiusMm * kLeastRadiusMm)) continue;
        const double rho = std::sqrt(square), rho_sigma = centre_sigma * std::abs(centre.y()) / rho;
        // Own unknowns: centre in the plane about the circle's own, radius in units of its sigma.
        Eigen::Matrix3d own = Eigen::Matrix3d::Zero(), cross = Eigen::Matrix3d::Zero();
        Eigen::Vector3d own_gradient = Eigen::Vector3d::Zero();
        own(2, 2) = point_variance;  // prior of 1
        for (std::size_t k = 0; k < section.x.size(); ++k) {
            const double dx = section.x[k] - section.circle.x_mm, dz = section.z[k] - section.circle.z_mm;
            const double r = std::hypot(dx, dz);
            const double e = r - rho, nx = dx / r, nz = dz / r;
            // Read = true + K true: e = n K p of an exact circle.
            const Eigen::Vector3d by_scale(nx * section.x[k], nz * section.z[k], nx * section.z[k]);
            const Eigen::Vector3d by_own(nx, nz, rho_sigma);
            own += by_own * by_own.transpose();
            cross += by_scale * by_own.transpose();
            own_gradient += e * by_own;
            information += by_scale * by_scale.transpose();
            gradient += e * by_scale;
        }
        const Eigen::LLT<Eigen::Matrix3d> factor(own);
        if (factor.info() != Eigen::Success) return {};
        information -= cross * factor.solve(cross.transpose());
        gradient -= cross * factor.solve(own_gradient);
    }
    const Eigen::LLT<Eigen::Matrix3d> factor(information);
    if (factor.info() != Eigen::Success) return {};
    const Eigen::Matrix3d covariance = point_variance * factor.solve(Eigen::Matrix3d::Identity());
    const Eigen::Vector3d found = factor.solve(gradient);
    const Eigen::Vector3d sigma = (covariance.diagonal() + found.cwiseAbs2()).cwiseSqrt();
    constexpr double kTold = 0.1;  // beyond, the cuts do not tell
    if (!sigma.allFinite() || sigma.maxCoeff() > kTold) return {};
    return {{sigma.x(), sigma.y()}, sigma.z()};
}

}  // namespace seamwright::tcp_sphere
