#include "core/calibration/sphere/drift_check.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/acceptance/distributions.h"
#include "core/calibration/numbers.h"
#include "core/calibration/pose_set.h"
#include "core/calibration/sphere/circle_section.h"
#include "core/calibration/statistics.h"
#include "core/geometry/decompositions.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

constexpr double kLever_mm = 100;
constexpr double kSettled_mm = 1e-10;
constexpr double kLeastNoise_mm = 1e-4;  // keeps noise-free data from looking sure
constexpr double kUnsymmetric = 1e-9;    // of its size, by which a covariance may differ from its transpose
// Shares of the radius that the laser must be off the sphere's middle, as expected and as measured, to tell y.
constexpr double kExpectedOff = 0.2, kMeasuredOff = 0.15;
constexpr double kChanged = 0.99;  // probability below which nothing has changed
constexpr double kCoarsest = 20;   // limits of the shift: what is known no better takes no part
// Measurements that disagree among themselves by more: a target has moved; by less, a robot can be as inexact.
constexpr double kRobotScatter_mm = 0.5;
constexpr double kOtherConvention_mm = 10;  // no target moves that far unseen: the poses mean something else
constexpr double kMostScatter_mm = 1000, kScatterTold = 0.01;  // the search's end, and how closely it tells
constexpr int kHalvings = 40;

using Factor = Eigen::LLT<Eigen::MatrixXd>;

struct Fit {
    Pose change = Pose::Identity();
    Matrix6 covariance = Matrix6::Zero();
    std::vector<Text> not_determined;
    double sigma_mm = 0, sigma_deg = 0;
    int determined = 0;
};

// Weighted Gauss-Newton on m' = g + R (m - g) + u with truncated eigenvalues of the scaled information (u,
// 100 w).
Fit fit_change(const std::vector<DriftMeasurement>& list, const Factor& noise, double coarsest_mm) {
    const auto rows = static_cast<Eigen::Index>(3 * list.size());
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (const auto& m : list) g += m.measured_flange_mm;
    g /= static_cast<double>(list.size());
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    Eigen::Vector3d u = Eigen::Vector3d::Zero();
    Fit fit;
    for (int iteration = 0; iteration < 20; ++iteration) {
        Eigen::MatrixXd j(rows, 6);
        Eigen::VectorXd e(rows);
        for (size_t i = 0; i < list.size(); ++i) {
            const auto at = static_cast<Eigen::Index>(3 * i);
            const Eigen::Vector3d arm = rotation * (list[i].measured_flange_mm - g);
            e.segment<3>(at) = list[i].base_from_flange.inverse() * list[i].known_base_mm - g - arm - u;
            j.block<3, 3>(at, 0).setIdentity();
            j.block<3, 3>(at, 3) = -skew(arm) / kLever_mm;
        }
        noise.matrixL().solveInPlace(j);
        noise.matrixL().solveInPlace(e);
        const Matrix6 h = j.transpose() * j;
        const Vector6 right = j.transpose() * e;
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

// m = R s + t, R <- Exp(w) R: dm = dt + w x R s.
Eigen::Matrix<double, 3, 6> drift_by_mounting(const Pose& stored_flange_from_sensor,
                                              const Eigen::Vector3d& measured_flange_mm) {
    Eigen::Matrix<double, 3, 6> j;
    j.leftCols<3>() = -Eigen::Matrix3d::Identity();
    j.rightCols<3>() = skew(measured_flange_mm - stored_flange_from_sensor.translation());
    return j;
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
    measurement.by_stored.leftCols<6>() =
        drift_by_mounting(stored_flange_from_sensor, measurement.measured_flange_mm);
    measurement.by_stored.middleCols<3>(6) = observation.base_from_flange.linear().transpose();
    if (off_middle)
        measurement.by_stored.col(9) = -stored_flange_from_sensor.linear().col(1) * (radius_mm / y);
    const Eigen::Matrix3d r = stored_flange_from_sensor.linear();
    measurement.covariance =
        r * of_centre * r.transpose() +
        (other_sigma_mm * other_sigma_mm + kLeastNoise_mm * kLeastNoise_mm) * Eigen::Matrix3d::Identity();
    return measurement;
}

namespace {

Expected<void> check_input(const std::vector<DriftMeasurement>& measurements, const DriftLimits& limits,
                           const StoredCovariance& stored) {
    if (measurements.empty())
        return input_error("there is no measurement", "measurements", "measure two or three spheres");
    std::vector<std::string> ids;
    std::vector<Pose> poses;
    for (const auto& m : measurements) {
        ids.push_back(m.id);
        poses.push_back(m.base_from_flange);
        const Text where("measurement '{}'", m.id);
        if (!m.measured_flange_mm.allFinite() || !m.known_base_mm.allFinite() || !m.covariance.allFinite() ||
            !m.by_stored.allFinite())
            return input_error("a value is not a finite number", where);
        const Eigen::LLT<Eigen::Matrix3d> llt(m.covariance);
        if (llt.info() != Eigen::Success || !m.covariance.isApprox(m.covariance.transpose(), kUnsymmetric))
            return input_error("the covariance is not symmetric and positive definite", where);
    }
    SEAM_OK(check_ids(ids, {}, "measurements"));
    SEAM_OK(check_rigid(poses, ids, "base_from_flange of"));
    SEAM_OK(check_millimetres(poses, "measurements"));
    if (!(limits.translation_mm > 0) || !(limits.rotation_deg > 0))
        return input_error("the limits of the drift check are not positive", "limits");
    const bool finite = stored.allFinite();
    const Eigen::SelfAdjointEigenSolver<StoredCovariance> eigen(
        finite ? stored : StoredCovariance::Zero().eval(), Eigen::EigenvaluesOnly);
    const double slack = kCovarianceSlack * (finite ? stored.norm() : 0);
    if (!finite || (stored - stored.transpose()).cwiseAbs().maxCoeff() > slack ||
        eigen.eigenvalues()[0] < -slack)
        return input_error(
            "the covariance of the stored calibration is none (not symmetric, or a negative variance)",
            "covariance", "give it as the calibration's result states it");
    return {};
}

// Of all e_i together, each with `scatter_mm` more on every axis.
Factor noise_of(const std::vector<DriftMeasurement>& measurements, const StoredCovariance& stored,
                double scatter_mm) {
    const auto rows = static_cast<Eigen::Index>(3 * measurements.size());
    Eigen::MatrixXd by_stored(rows, 10);
    for (size_t i = 0; i < measurements.size(); ++i)
        by_stored.middleRows<3>(static_cast<Eigen::Index>(3 * i)) = measurements[i].by_stored;
    Eigen::MatrixXd noise = by_stored * (0.5 * (stored + stored.transpose())) * by_stored.transpose();
    noise.diagonal().array() += scatter_mm * scatter_mm;
    for (size_t i = 0; i < measurements.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(3 * i);
        noise.block<3, 3>(at, at) += measurements[i].covariance;
    }
    return Factor(noise);
}

// Directions that say something: a sphere cut in its middle says nothing across.
int rows_that_tell(const std::vector<DriftMeasurement>& measurements, double coarsest_mm) {
    int rows = 0;
    for (const DriftMeasurement& m : measurements) {
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(m.covariance, Eigen::EigenvaluesOnly);
        rows += static_cast<int>((eigen.eigenvalues().array() < coarsest_mm * coarsest_mm).count());
    }
    return rows;
}

double chi_squared_of(const std::vector<DriftMeasurement>& measurements, const Pose& change,
                      const Factor& noise) {
    Eigen::VectorXd all(static_cast<Eigen::Index>(3 * measurements.size()));
    for (size_t i = 0; i < measurements.size(); ++i) {
        const auto& m = measurements[i];
        all.segment<3>(static_cast<Eigen::Index>(3 * i)) =
            m.base_from_flange.inverse() * m.known_base_mm - change * m.measured_flange_mm;
    }
    noise.matrixL().solveInPlace(all);
    return all.squaredNorm();
}

// The change, and by how much more than their S_i the measurements scatter about it.
struct Explained {
    Fit fit;
    double before = 0, after = 0;  // chi squared without and with the change
    double stated = 0,
           stated_limit = 0;  // of no change, by the S_i as they are; and what chance leaves at most
    double freedom = 0;
    double scatter_mm = 0;
    bool contradicts = false;  // the S_i, more than by chance
    bool significant = false;
};

Explained explain(const std::vector<DriftMeasurement>& measurements, const StoredCovariance& stored,
                  double coarsest_mm) {
    const int rows = rows_that_tell(measurements, coarsest_mm);
    const auto with = [&](double scatter_mm) {
        Explained e;
        const Factor noise = noise_of(measurements, stored, scatter_mm);
        e.fit = fit_change(measurements, noise, coarsest_mm);
        e.before = chi_squared_of(measurements, Pose::Identity(), noise);
        e.after = chi_squared_of(measurements, e.fit.change, noise);
        e.freedom = rows - e.fit.determined;
        e.scatter_mm = scatter_mm;
        return e;
    };
    Explained found = with(0);
    const double stated = found.before, limit = chi_squared_quantile(kChanged, std::max(1, rows));
    found.stated = stated;
    found.stated_limit = limit;
    found.significant = stated > limit;
    if (found.freedom < 1 || found.after <= found.freedom) return found;
    const bool contradicts = contradicts_stated(found.after, found.freedom);
    // As much as makes chi squared what is expected.
    double low = kLeastNoise_mm, high = kMostScatter_mm;
    for (int i = 0; i < kHalvings && high > low * (1 + kScatterTold); ++i) {
        const double middle = std::sqrt(low * high);
        found = with(middle);
        (found.after > found.freedom ? low : high) = middle;
    }
    found.stated = stated;
    found.stated_limit = limit;
    found.contradicts = contradicts;
    const double widened = student_quantile(kUpper95, found.freedom) / kNormal95;
    found.fit.covariance *= widened * widened;
    found.fit.sigma_mm *= widened;
    found.fit.sigma_deg *= widened;
    const int determined = std::max(1, found.fit.determined);
    found.significant = (found.before - found.after) / determined >
                        f_quantile(determined, found.freedom, kChanged) * found.after / found.freedom;
    return found;
}

}  // namespace

Expected<DriftResult> check_drift(const std::vector<DriftMeasurement>& measurements,
                                  const DriftLimits& limits, const StoredCovariance& stored) {
    SEAM_OK(check_input(measurements, limits, stored));
    const Explained found = explain(measurements, stored, kCoarsest * limits.translation_mm);
    const Fit& fit = found.fit;
    DriftResult result;
    result.chi_squared = found.stated;
    result.chi_squared_limit = found.stated_limit;
    result.change = fit.change;
    result.not_determined = fit.not_determined;
    result.change_deg = deg_from_rad(rotation_log(fit.change.linear()).norm());
    for (const auto& m : measurements) {
        const Eigen::Vector3d known = m.base_from_flange.inverse() * m.known_base_mm;
        const Eigen::Vector3d changed = fit.change * m.measured_flange_mm;
        PoseResidual residual;
        residual.id = m.id;
        residual.rms_mm = (known - m.measured_flange_mm).norm();
        result.rms_before_mm += residual.rms_mm * residual.rms_mm;
        result.rms_after_mm += (known - changed).squaredNorm();
        result.change_mm = std::max(result.change_mm, (changed - m.measured_flange_mm).norm());
        result.report.poses.push_back(std::move(residual));
    }
    const auto count = static_cast<double>(measurements.size());
    result.rms_before_mm = std::sqrt(result.rms_before_mm / count);
    result.rms_after_mm = std::sqrt(result.rms_after_mm / count);
    result.covariance = fit.covariance;
    result.sigma_mm = fit.sigma_mm;
    result.sigma_deg = fit.sigma_deg;

    auto& report = result.report;
    add_pose(report, fit.change);
    state_covariance(report, fit.covariance);
    const bool beyond =
        (result.change_mm > limits.translation_mm && result.change_mm > 2 * result.sigma_mm) ||
        (result.change_deg > limits.rotation_deg && result.change_deg > 2 * result.sigma_deg);
    // Nothing holds that was not seen: every direction is determined, each to within half its limit.
    const bool shift_unknown = fit.determined < 3 || 2 * result.sigma_mm > limits.translation_mm;
    const bool turn_unknown = fit.determined < 6 || 2 * result.sigma_deg > limits.rotation_deg;
    const bool outside = result.change_mm > limits.translation_mm || result.change_deg > limits.rotation_deg;
    const Text change("change {:.3f} mm (sigma {:.3f}) and {:.3f} degrees (sigma {:.3f})", result.change_mm,
                      result.sigma_mm, result.change_deg, result.sigma_deg);
    if (found.contradicts && found.scatter_mm > kRobotScatter_mm) {
        result.status = DriftStatus::drifted;
        report.judgement = {
            Verdict::poor,
            Text("the measurements contradict the stored places and no rigid change of the sensor "
                 "explains them ({:.3f} mm remain)",
                 found.scatter_mm),
            found.scatter_mm > kOtherConvention_mm ? "check that the robot's poses are written in the "
                                                     "convention and the units that the calibration "
                                                     "was made with, and that no target has moved"
                                                   : "check that no target has moved, then calibrate again"};
    } else if (found.significant && beyond) {
        result.status = DriftStatus::drifted;
        report.judgement = {Verdict::poor, Text("the calibration no longer holds: {}", change),
                            "calibrate again"};
    } else if (found.contradicts) {
        result.status = DriftStatus::undetermined;
        report.judgement = {
            Verdict::undetermined,
            Text("the measurements disagree among themselves by {:.3f} mm, more than their sigma allows: {}",
                 found.scatter_mm, change),
            "state the robot's repeatability, check that no target has moved, and measure from further "
            "poses"};
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
