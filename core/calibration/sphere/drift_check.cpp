#include "core/calibration/sphere/drift_check.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/calibration/pose_set.h"
#include "core/calibration/sphere/circle_section.h"
#include "core/calibration/statistics.h"
#include "core/geometry/decompositions.h"

namespace seamwright {
namespace {

constexpr double kLever_mm = 100;
constexpr double kSettled_mm = 1e-10;
constexpr double kLeastNoise_mm = 1e-4;  // keeps noise-free data from looking sure
constexpr double kUnsymmetric = 1e-9;    // of its size, by which a covariance may differ from its transpose
// Shares of the radius that the laser must be off the sphere's middle, as expected and as measured, to tell y.
constexpr double kExpectedOff = 0.2, kMeasuredOff = 0.15;
// Of chi squared: something has changed; and what one change has to explain, with slack for circles that are not the sphere's.
constexpr double kChanged = 0.99, kExplained = 0.999, kExplainedSlack = 1.5;

struct Fit {
    Pose change = Pose::Identity();
    Matrix6 covariance = Matrix6::Zero();
    std::vector<Text> not_determined;
    double sigma_mm = 0, sigma_deg = 0;
    int determined = 0;
};

// Weighted Gauss-Newton on m' = g + R (m - g) + u with truncated eigenvalues of the scaled information (u,
// 100 w).
Fit fit_change(const std::vector<DriftMeasurement>& list, const std::vector<Eigen::Matrix3d>& weight,
               double coarsest_mm) {
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (const auto& m : list) g += m.measured_flange_mm;
    g /= static_cast<double>(list.size());
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    Eigen::Vector3d u = Eigen::Vector3d::Zero();
    Fit fit;
    for (int iteration = 0; iteration < 20; ++iteration) {
        Matrix6 h = Matrix6::Zero();
        Vector6 right = Vector6::Zero();
        for (size_t i = 0; i < list.size(); ++i) {
            const Eigen::Vector3d arm = rotation * (list[i].measured_flange_mm - g);
            const Eigen::Vector3d e =
                list[i].base_from_flange.inverse() * list[i].known_base_mm - g - arm - u;
            Eigen::Matrix<double, 3, 6> j;
            j.leftCols<3>().setIdentity();
            j.rightCols<3>() = -skew(arm) / kLever_mm;
            h.noalias() += j.transpose() * weight[i] * j;
            right.noalias() += j.transpose() * weight[i] * e;
        }
        const SymmetricEigen eigen = symmetric_eigen(h);
        Vector6 step = Vector6::Zero();
        Matrix6 inverse = Matrix6::Zero();
        fit.not_determined.clear();
        fit.determined = 0;
        for (int k = 0; k < 6; ++k) {
            const double value = eigen.values[k];
            const Vector6 direction = eigen.vectors.col(k);
            if (value < 1 / (coarsest_mm * coarsest_mm)) {
                const bool turn = direction.tail<3>().norm() > direction.head<3>().norm();
                fit.not_determined.push_back(Text("{} {} of the flange", turn ? "turn about" : "shift along",
                                                  axis_name(turn ? Eigen::Vector3d(direction.tail<3>())
                                                                 : Eigen::Vector3d(direction.head<3>()))));
                continue;
            }
            ++fit.determined;
            step += direction * (direction.dot(right) / value);
            inverse.noalias() += direction * direction.transpose() / value;
        }
        u += step.head<3>();
        rotation = rotation_exp(step.tail<3>() / kLever_mm) * rotation;
        Matrix6 basis = Matrix6::Identity();  // (t, w) from (u, 100 w): t = g + u - R g
        basis.bottomRightCorner<3, 3>() /= kLever_mm;
        basis.topRightCorner<3, 3>() = skew(rotation * g) / kLever_mm;
        fit.covariance = basis * inverse * basis.transpose();
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> shift(
            Eigen::Matrix3d(inverse.topLeftCorner<3, 3>()));
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> turn(
            Eigen::Matrix3d(inverse.bottomRightCorner<3, 3>()));
        fit.sigma_mm = std::sqrt(std::max(0.0, shift.eigenvalues()[2]));
        fit.sigma_deg = deg_from_rad(std::sqrt(std::max(0.0, turn.eigenvalues()[2])) / kLever_mm);
        if (step.norm() < kSettled_mm) break;
    }
    fit.change = make_pose(rotation, g + u - rotation * g);
    return fit;
}

}  // namespace

std::string_view name_of(DriftStatus status) {
    switch (status) {
        case DriftStatus::holds:
            return "holds";
        case DriftStatus::drifted:
            return "drifted";
        case DriftStatus::undetermined:
            return "undetermined";
    }
    return "undetermined";
}

Expected<DriftMeasurement> drift_measurement(const SphereObservation& observation, double radius_mm,
                                             const Pose& stored_flange_from_sensor,
                                             const Eigen::Vector3d& known_centre_base_mm,
                                             double other_sigma_mm) {
    const Text where("measurement '{}'", observation.id);
    if (!(std::isfinite(radius_mm) && radius_mm > 0))
        return input_error("the sphere's radius is not a positive number", where);
    SEAM_OK(check_rigid({observation.base_from_flange}, {observation.id}, "base_from_flange of"));
    if (observation.profile.x_mm.size() != observation.profile.z_mm.size())
        return input_error("the profile has different numbers of x and z", where);
    const auto circle = find_circle_section(observation.profile, limits_of_sphere(radius_mm));
    if (!circle)
        return input_error(Text("the profile shows no circle of a sphere with radius {:.3f} mm", radius_mm),
                           where, "let the laser cut the sphere");
    const Eigen::Vector3d expected =
        stored_flange_from_sensor.inverse() * (observation.base_from_flange.inverse() * known_centre_base_mm);
    const double height =
        std::sqrt(std::max(0.0, radius_mm * radius_mm - circle->radius_mm * circle->radius_mm));
    // Near the middle of the sphere the circle says next to nothing about y: keep the expected place there,
    // with a sigma that takes no part.
    const bool off_middle =
        std::abs(expected.y()) > kExpectedOff * radius_mm && height > kMeasuredOff * radius_mm;
    const double y = off_middle ? std::copysign(height, expected.y()) : expected.y();
    const Eigen::Vector3d centre(circle->x_mm, y, circle->z_mm);

    // Covariance of (a, b, rho) from the inliers' noise; y = sqrt(r^2 - rho^2) has sigma rho / |y| sigma_rho.
    Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
    for (const int i : circle->inliers) {
        const double dx = observation.profile.x_mm[static_cast<size_t>(i)] - circle->x_mm;
        const double dz = observation.profile.z_mm[static_cast<size_t>(i)] - circle->z_mm;
        const Eigen::Vector3d j = Eigen::Vector3d(-dx, -dz, -std::hypot(dx, dz)) / std::hypot(dx, dz);
        h.noalias() += j * j.transpose();
    }
    const double noise = std::max(circle->noise_mm, kLeastNoise_mm);
    const Eigen::Matrix3d fit = h.inverse() * noise * noise;
    Eigen::Matrix3d to_centre = Eigen::Matrix3d::Zero();  // (x, y, z) from (a, b, rho)
    to_centre(0, 0) = 1;
    to_centre(1, 2) = off_middle ? -circle->radius_mm / y : 0;
    to_centre(2, 1) = 1;
    Eigen::Matrix3d of_centre = to_centre * fit * to_centre.transpose();
    if (!off_middle) of_centre(1, 1) = radius_mm * radius_mm;
    DriftMeasurement measurement;
    measurement.id = observation.id;
    measurement.base_from_flange = observation.base_from_flange;
    measurement.known_base_mm = known_centre_base_mm;
    measurement.measured_flange_mm = stored_flange_from_sensor * centre;
    const Eigen::Matrix3d r = stored_flange_from_sensor.linear();
    measurement.covariance =
        r * of_centre * r.transpose() +
        (other_sigma_mm * other_sigma_mm + kLeastNoise_mm * kLeastNoise_mm) * Eigen::Matrix3d::Identity();
    return measurement;
}

Expected<DriftResult> check_drift(const std::vector<DriftMeasurement>& measurements,
                                  const DriftLimits& limits) {
    if (measurements.empty())
        return input_error("there is no measurement", "measurements", "measure two or three spheres");
    std::vector<std::string> ids;
    std::vector<Pose> poses;
    std::vector<Eigen::Matrix3d> weight;
    for (const auto& m : measurements) {
        ids.push_back(m.id);
        poses.push_back(m.base_from_flange);
        const Text where("measurement '{}'", m.id);
        if (!m.measured_flange_mm.allFinite() || !m.known_base_mm.allFinite() || !m.covariance.allFinite())
            return input_error("a value is not a finite number", where);
        const Eigen::LLT<Eigen::Matrix3d> llt(m.covariance);
        if (llt.info() != Eigen::Success || !m.covariance.isApprox(m.covariance.transpose(), kUnsymmetric))
            return input_error("the covariance is not symmetric and positive definite", where);
        weight.push_back(llt.solve(Eigen::Matrix3d::Identity()));
    }
    SEAM_OK(check_ids(ids, {}, "measurements"));
    SEAM_OK(check_rigid(poses, ids, "base_from_flange of"));
    SEAM_OK(check_millimetres(poses, "measurements"));
    if (!(limits.translation_mm > 0) || !(limits.rotation_deg > 0))
        return input_error("the limits of the drift check are not positive", "limits");

    DriftResult result;
    const auto statistics = [&](const Pose& change, double& chi_squared, double& rms, bool write) {
        chi_squared = rms = 0;
        for (size_t i = 0; i < measurements.size(); ++i) {
            const auto& m = measurements[i];
            const Eigen::Vector3d e =
                m.base_from_flange.inverse() * m.known_base_mm - change * m.measured_flange_mm;
            chi_squared += e.dot(weight[i] * e);
            rms += e.squaredNorm();
            if (!write) continue;
            PoseResidual residual;
            residual.id = m.id;
            residual.rms_mm = e.norm();
            result.report.poses.push_back(std::move(residual));
        }
        rms = std::sqrt(rms / static_cast<double>(measurements.size()));
    };
    const double rows = 3 * static_cast<double>(measurements.size());
    statistics(Pose::Identity(), result.chi_squared, result.rms_before_mm, true);
    result.chi_squared_limit = chi_squared_quantile(kChanged, rows);

    const Fit fit = fit_change(measurements, weight, 20 * limits.translation_mm);
    result.change = fit.change;
    result.covariance = fit.covariance;
    result.not_determined = fit.not_determined;
    result.sigma_mm = fit.sigma_mm;
    result.sigma_deg = fit.sigma_deg;
    result.change_deg = deg_from_rad(rotation_log(fit.change.linear()).norm());
    for (const auto& m : measurements)
        result.change_mm =
            std::max(result.change_mm, (fit.change * m.measured_flange_mm - m.measured_flange_mm).norm());
    double after = 0;
    statistics(fit.change, after, result.rms_after_mm, false);
    const double freedom = rows - fit.determined;
    const bool explained =
        freedom < 1 || after <= chi_squared_quantile(kExplained, freedom) * kExplainedSlack;

    auto& report = result.report;
    add_pose(report, fit.change);
    state_covariance(report, fit.covariance);

    const bool significant = result.chi_squared > result.chi_squared_limit;
    const bool beyond =
        (result.change_mm > limits.translation_mm && result.change_mm > 2 * result.sigma_mm) ||
        (result.change_deg > limits.rotation_deg && result.change_deg > 2 * result.sigma_deg);
    // Nothing holds that was not seen: every direction is determined, each to within half its limit.
    const bool shift_unknown = fit.determined < 3 || 2 * result.sigma_mm > limits.translation_mm;
    const bool turn_unknown = fit.determined < 6 || 2 * result.sigma_deg > limits.rotation_deg;
    const bool outside = result.change_mm > limits.translation_mm || result.change_deg > limits.rotation_deg;
    const Text change("change {:.3f} mm (sigma {:.3f}) and {:.3f} degrees (sigma {:.3f})", result.change_mm,
                      result.sigma_mm, result.change_deg, result.sigma_deg);
    if (significant && !explained) {
        result.status = DriftStatus::drifted;
        report.judgement = {
            Verdict::poor,
            Text("the measurements contradict the stored places and no rigid change of the sensor "
                 "explains them ({:.3f} mm remain)",
                 result.rms_after_mm),
            "check that no target has moved, then calibrate again"};
    } else if (significant && beyond) {
        result.status = DriftStatus::drifted;
        report.judgement = {Verdict::poor, Text("the calibration no longer holds: {}", change),
                            "calibrate again"};
    } else if (shift_unknown) {
        result.status = DriftStatus::undetermined;
        report.judgement = {
            Verdict::undetermined,
            Text("the measurements are too few or too rough to see {:.3f} mm", limits.translation_mm),
            "measure two or three spheres, cut off their middle, from several poses"};
    } else if (turn_unknown) {
        result.status = DriftStatus::undetermined;
        Text open;
        for (const auto& word : fit.not_determined) open = joined(open, ", ", word);
        report.judgement = {
            Verdict::undetermined,
            open.empty() ? Text("a turn of {:.3f} degrees cannot be seen: {}", limits.rotation_deg, change)
                         : Text("not seen: {}; {}", open, change),
            "measure further spheres near the rims of the view, left, right, near and far"};
    } else if (outside) {
        result.status = DriftStatus::undetermined;
        report.judgement = {Verdict::undetermined,
                            Text("more than the limits, and no more than chance could make it: {}", change),
                            "measure the spheres again from further poses"};
    } else {
        result.status = DriftStatus::holds;
        report.judgement = {Verdict::good, Text("the calibration holds: {}", change), ""};
    }
    return result;
}

}  // namespace seamwright
