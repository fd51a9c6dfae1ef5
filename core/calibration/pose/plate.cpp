#include "core/calibration/pose/plate.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/calibration/pose_set.h"
#include "core/calibration/statistics.h"
#include "core/geometry/decompositions.h"

namespace seamwright {
namespace {

constexpr double kGoodPlate_mm = 0.1, kUsablePlate_mm = 0.5;  // three sigma anywhere on the plate
constexpr double kNoiseFloor_mm = 0.01;  // of a world point, for what three points can promise
constexpr double kSmallestOutlier_mm = 0.05;

using Points = std::vector<Eigen::Vector3d>;

struct PairMoments {
    Eigen::Vector3d mean_to = Eigen::Vector3d::Zero(), mean_from = Eigen::Vector3d::Zero();
    Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();  // sum (from - mean)(to - mean)^T
    double spread_to = 0, spread_from = 0;            // sums of squares
    double count = 0;
};

PairMoments moments_of(const Points& to, const Points& from, const std::vector<bool>& use) {
    PairMoments m;
    const auto taken = [&use](size_t i) { return use.empty() || use[i]; };
    for (size_t i = 0; i < to.size(); ++i) {
        if (!taken(i)) continue;
        m.mean_to += to[i];
        m.mean_from += from[i];
        m.count += 1;
    }
    m.mean_to /= std::max(1.0, m.count);
    m.mean_from /= std::max(1.0, m.count);
    for (size_t i = 0; i < to.size(); ++i) {
        if (!taken(i)) continue;
        const Eigen::Vector3d a = from[i] - m.mean_from, b = to[i] - m.mean_to;
        m.cross.noalias() += a * b.transpose();
        m.spread_from += a.squaredNorm();
        m.spread_to += b.squaredNorm();
    }
    return m;
}

double squares_of(const Points& to, const Points& from, const Pose& pose, const std::vector<bool>& use) {
    double sum = 0;
    for (size_t i = 0; i < to.size(); ++i)
        if (use[i]) sum += (to[i] - pose * from[i]).squaredNorm();
    return sum;
}

Matrix6 information_of(const Points& from, const Pose& pose, const std::vector<bool>& use) {
    Matrix6 h = Matrix6::Zero();
    for (size_t i = 0; i < from.size(); ++i) {
        if (!use[i]) continue;
        Eigen::Matrix<double, 3, 6> j;
        j.leftCols<3>().setIdentity();
        j.rightCols<3>() = -skew(pose.linear() * from[i]);
        h.noalias() += j.transpose() * j;
    }
    return h;
}

// Spread of the points across their longest line: 0 when they lie on one.
double across_line(const Points& points, const std::vector<bool>& use) {
    const PairMoments m = moments_of(points, points, use);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(m.cross);
    return std::sqrt(std::max(0.0, eigen.eigenvalues()[1]) / std::max(1.0, m.count));
}

double extent(const Points& points) {
    Eigen::Vector3d low = points.front(), high = points.front();
    for (const auto& p : points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    return (high - low).norm();
}

Expected<void> check_input(const std::vector<PlatePoint>& points, const PlateOptions& options,
                           std::vector<bool>& use) {
    std::vector<std::string> ids;
    Points plate, world;
    for (const auto& point : points) {
        ids.push_back(point.id);
        plate.push_back(point.plate);
        world.push_back(point.world);
        if (!point.plate.allFinite() || !point.world.allFinite())
            return input_error("a coordinate is not a finite number", Text("point '{}'", point.id));
        if (point.plate.cwiseAbs().maxCoeff() > 1e5 || point.world.cwiseAbs().maxCoeff() > 1e6)
            return input_error("a coordinate is beyond 100 m on the plate or 1 km in the world",
                               Text("point '{}'", point.id), "give millimetres");
    }
    SEAM_OK(check_ids(ids, options.exclude, "points"));
    if (options.sigma_mm && !(std::isfinite(*options.sigma_mm) && *options.sigma_mm > 0))
        return input_error("sigma_mm is not a positive number", "sigma_mm");
    use.assign(points.size(), true);
    size_t count = 0;
    for (size_t i = 0; i < points.size(); ++i) {
        use[i] = std::find(options.exclude.begin(), options.exclude.end(), ids[i]) == options.exclude.end();
        count += use[i] ? 1 : 0;
    }
    if (count < 3)
        return input_error(Text("{} points are too few", count), "points",
                           "give at least three, better five or more");
    const double size = extent(plate), world_size = extent(world);
    if (size > 0 && size < 2)
        return input_error(
            Text("the plate measures {:.3g} only: its points look like metres, not millimetres", size),
            "points", "give millimetres (times 1000)");
    const double ratio = world_size / std::max(size, 1e-12);
    if (ratio > 0.0005 && ratio < 0.002)
        return input_error(
            "the world points are a thousandth of the plate's size: they look like metres, not millimetres",
            "points", "give millimetres (times 1000)");
    if (ratio > 500 && ratio < 2000)
        return input_error(
            "the plate points are a thousandth of the world's size: they look like metres, not millimetres",
            "points", "give millimetres (times 1000)");
    for (size_t i = 0; i < points.size(); ++i)
        for (size_t k = 0; k < i; ++k)
            if (use[i] && use[k] && (plate[i] - plate[k]).norm() < 1e-6 * std::max(1.0, size))
                return input_error(Text("'{}' and '{}' are the same point of the plate", ids[k], ids[i]),
                                   "points", "give different points, or their mean once");
    return {};
}

}  // namespace

Pose fit_rigid(const Points& to, const Points& from, const std::vector<bool>& use) {
    const PairMoments m = moments_of(to, from, use);
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m.cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
    // (4.15): V diag(1, 1, det(V U^T)) U^T
    Eigen::Vector3d guard(1, 1, 1);
    guard[2] = (svd.matrixV() * svd.matrixU().transpose()).determinant() < 0 ? -1 : 1;
    const Eigen::Matrix3d rotation = svd.matrixV() * guard.asDiagonal() * svd.matrixU().transpose();
    return make_pose(rotation, m.mean_to - rotation * m.mean_from);
}

std::string_view name_of(PlateStatus status) {
    return status == PlateStatus::ok ? "ok" : "undetermined";
}

Expected<PlateResult> calibrate_plate(const std::vector<PlatePoint>& points, const PlateOptions& options) {
    std::vector<bool> use;
    SEAM_OK(check_input(points, options, use));
    const std::vector<bool> wanted = use;
    Points plate, world;
    for (const auto& point : points) {
        plate.push_back(point.plate);
        world.push_back(point.world);
    }
    PlateResult result;
    auto& report = result.report;
    report.poses.resize(points.size());
    for (size_t i = 0; i < points.size(); ++i) {
        report.poses[i].id = points[i].id;
        report.poses[i].used = use[i];
        report.poses[i].excluded = !use[i];
        if (!use[i]) report.poses[i].note = "excluded by the user";
    }
    const double size = extent(plate);
    // On a line (to a thousandth of its length) the turn about it hangs on the noise.
    const auto on_a_line = [&](const std::vector<bool>& some) {
        return across_line(plate, some) < 1e-3 * size || across_line(world, some) < 1e-3 * size;
    };
    if (on_a_line(use)) {
        result.status = PlateStatus::undetermined;
        report.judgement = {Verdict::undetermined,
                            "the points lie on one line: the turn about it is not determined",
                            "measure at least one point well off that line"};
        return result;
    }

    Pose pose = fit_rigid(world, plate, use);
    double squares = squares_of(world, plate, pose, use);
    // A wrong point: the one whose absence explains the misfit (F test of its three numbers).
    std::string wrong;
    for (;;) {
        const auto count = std::count(use.begin(), use.end(), true);
        const double redundancy = 3.0 * static_cast<double>(count - 1) - 6;
        if (redundancy < 3) break;
        size_t suspect = points.size();
        double least = squares;
        Pose without = pose;
        for (size_t i = 0; i < points.size(); ++i) {
            if (!use[i]) continue;
            use[i] = false;
            const Pose candidate = fit_rigid(world, plate, use);
            const double rest = squares_of(world, plate, candidate, use);
            if (rest < least && !on_a_line(use)) {
                least = rest;
                suspect = i;
                without = candidate;
            }
            use[i] = true;
        }
        if (suspect == points.size()) break;
        const double f = (squares - least) / 3 / (std::max(least, 1e-12) / redundancy);
        const double miss = (world[suspect] - without * plate[suspect]).norm();
        if (f < outlier_limit(redundancy) || miss < kSmallestOutlier_mm) break;
        use[suspect] = false;
        pose = without;
        squares = least;
        report.poses[suspect].used = false;
        report.poses[suspect].note = Text("contradicts the other points by {:.2f} mm", miss);
        wrong += (wrong.empty() ? "" : ", ") + points[suspect].id;
    }
    if (!wrong.empty()) result.notices.push_back(Text("not used, contradicting the others: {}", wrong));

    const double count = static_cast<double>(std::count(use.begin(), use.end(), true));
    const double redundancy = 3 * count - 6;
    result.status = PlateStatus::ok;
    result.world_from_plate = pose;
    result.rms_mm = std::sqrt(squares / count);
    result.sigma_mm = options.sigma_mm.value_or(std::sqrt(squares / redundancy));
    const double student = options.sigma_mm ? 1 : student_quantile(0.975, redundancy) / 1.959964;
    result.covariance = inverse_matrix(information_of(plate, pose, use)) *
                        (result.sigma_mm * result.sigma_mm * student * student);
    const PairMoments m = moments_of(world, plate, use);
    result.scale = std::sqrt(m.spread_to / m.spread_from);

    for (size_t i = 0; i < points.size(); ++i) report.poses[i].rms_mm = (world[i] - pose * plate[i]).norm();
    add_pose(report, pose);
    state_covariance(report, result.covariance);

    // Leave-one-out.
    if (count >= 4) {
        double sum = 0, largest = 0;
        for (size_t i = 0; i < points.size(); ++i) {
            if (!use[i]) continue;
            use[i] = false;
            const double miss = (world[i] - fit_rigid(world, plate, use) * plate[i]).norm();
            const bool fixed = !on_a_line(use);
            use[i] = true;
            if (!fixed) continue;
            sum += miss * miss;
            largest = std::max(largest, miss);
            ++report.hold_out.folds;
        }
        if (report.hold_out.folds > 0) {
            report.hold_out.left_out = 1;
            report.hold_out.rms_mm = std::sqrt(sum / report.hold_out.folds);
            report.hold_out.max_mm = largest;
        }
    }

    // A reflection that fits far better than any rotation: one set has a flipped axis.
    {
        const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m.cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
        const bool reflects = (svd.matrixV() * svd.matrixU().transpose()).determinant() < 0;
        const double gain =
            4 * svd.singularValues()[2];  // by how much the reflection lowers the sum of squares
        result.mirrored = reflects && gain > 0.8 * squares && squares > count * 0.25;
    }

    // Largest sigma on the plate, with a floor: three points fit anything.
    const Matrix6 honest = inverse_matrix(information_of(plate, pose, use)) *
                           std::pow(std::max(result.sigma_mm * student, kNoiseFloor_mm), 2);
    double worst = 0;
    for (size_t i = 0; i < points.size(); ++i) {
        Eigen::Matrix<double, 3, 6> j;
        j.leftCols<3>().setIdentity();
        j.rightCols<3>() = -skew(pose.linear() * plate[i]);
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(
            Eigen::Matrix3d(j * honest * j.transpose()));
        worst = std::max(worst, std::sqrt(std::max(0.0, eigen.eigenvalues()[2])));
    }
    const double stretch = std::abs(result.scale - 1) * size;
    const double stretch_sigma =
        std::max(result.sigma_mm, kNoiseFloor_mm) * size / std::sqrt(std::max(1e-12, m.spread_from));
    const Text fit("rms {:.3f} mm, three sigma on the plate {:.3f} mm", result.rms_mm, 3 * worst);
    if (result.mirrored) {
        report.judgement = {Verdict::poor, "the world points fit a mirrored plate",
                            "check for an axis that is flipped or swapped"};
    } else if (stretch > 0.2 && stretch > 4 * stretch_sigma && std::abs(result.scale - 1) > 2e-4) {
        report.judgement = {
            Verdict::poor, Text("distances in the world are {:.5f} times those on the plate", result.scale),
            "check the plate's drawing, the scale of the measuring system and the order of the points"};
    } else if (3 * worst > kUsablePlate_mm || result.rms_mm > kUsablePlate_mm) {
        report.judgement = {Verdict::poor, fit,
                            "check the order of the points and measure again, with more points"};
    } else if (3 * worst > kGoodPlate_mm || count < 4) {
        report.judgement = {Verdict::usable,
                            count < 4 ? Text("three points leave little to check with; {}", fit) : fit,
                            "measure more points, spread over the whole plate"};
    } else {
        report.judgement = {Verdict::good, fit, ""};
    }
    return result;
}

}  // namespace seamwright
