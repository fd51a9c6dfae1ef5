#include "core/calibration/sphere/sphere_scale.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace seamwright::tcp_sphere {

FieldScale sphere_scale(const std::vector<Section>& sections, const Model& model, double point_variance,
                        double centre_variance) {
    constexpr int kPose = 9, kAll = kPose + 3;
    constexpr double kLeastCentre_mm2 = 1e-12;
    constexpr double kUntold = 1e-300;  // information of an unknown that no cut tells
    if (!(point_variance > 0)) return {};
    using Unknowns = Eigen::Matrix<double, kAll, 1>;
    using Square = Eigen::Matrix<double, kAll, kAll>;
    Square information = Square::Zero();
    Unknowns gradient = Unknowns::Zero();
    for (const Section& section : sections) {
        if (!section.used) continue;
        const Eigen::Vector3d centre = centre_in_sensor(section, model);
        const Eigen::Matrix<double, 3, kPose> centre_by_pose =
            centre_jacobian(section, model).leftCols<kPose>();
        Eigen::Matrix3d own =
            point_variance / std::max(centre_variance, kLeastCentre_mm2) * Eigen::Matrix3d::Identity();
        Eigen::Matrix<double, kAll, 3> cross = Eigen::Matrix<double, kAll, 3>::Zero();
        Eigen::Vector3d own_gradient = Eigen::Vector3d::Zero();
        for (std::size_t k = 0; k < section.x.size(); ++k) {
            const double x = section.x[k], z = section.z[k];
            const Eigen::Vector3d to_centre = centre - Eigen::Vector3d(x, 0, z);
            const double distance = to_centre.norm();
            if (!(distance > 0)) continue;
            const Eigen::Vector3d u = to_centre / distance;
            const double e = distance - model.radius;
            Unknowns row;  // read = true + K true
            row << centre_by_pose.transpose() * u, u.x() * x, u.z() * z, u.x() * z;
            own += u * u.transpose();
            cross += row * u.transpose();
            own_gradient += e * u;
            information += row * row.transpose();
            gradient += e * row;
        }
        const Eigen::LLT<Eigen::Matrix3d> factor(own);
        if (factor.info() != Eigen::Success) return {};
        information -= cross * factor.solve(cross.transpose());
        gradient -= cross * factor.solve(own_gradient);
    }
    const Unknowns unit = information.diagonal().cwiseMax(kUntold).cwiseSqrt().cwiseInverse();
    const Eigen::LLT<Square> factor(Square(unit.asDiagonal() * information * unit.asDiagonal()));
    if (factor.info() != Eigen::Success) return {};
    const Square inverse = factor.solve(Square::Identity());
    const Unknowns found = -(unit.asDiagonal() * factor.solve(unit.asDiagonal() * gradient));
    constexpr double kTold = 0.1;           // beyond, the cuts do not tell
    constexpr double kBeyondChance = 3.29;  // of a normal, 0.1 %
    Eigen::Vector3d sigma;
    FieldScale out;
    for (int i = 0; i < 3; ++i) {
        const int k = kPose + i;
        sigma[i] = unit[k] * std::sqrt(point_variance * inverse(k, k));
        if (!(std::abs(found[k]) > kBeyondChance * sigma[i])) continue;
        sigma[i] = std::hypot(sigma[i], found[k]);
        out.shown = true;
    }
    if (!sigma.allFinite() || sigma.maxCoeff() > kTold) return {};
    out.scale_sigma = sigma.head<2>();
    out.shear_sigma = sigma.z();
    return out;
}

}  // namespace seamwright::tcp_sphere
