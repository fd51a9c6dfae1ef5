#include "core/calibration/pose/plate.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/acceptance/distributions.h"
#include "core/calibration/numbers.h"
#include "core/calibration/pose_set.h"
#include "core/calibration/statistics.h"
#include "core/geometry/decompositions.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

constexpr double kThinPlate = 1e-3;      // of its length: narrower is a line
constexpr double kStretch_mm = 0.2;      // over the plate: less than this is no wrong scale
constexpr double kSmallestScale = 2e-4;  // and less than this of the scale neither
// A reflection must take this share of the misfit away, and the misfit be this large a point: noise reflects too.
constexpr double kMirrorGain = 0.8, kMirrorMisfit_mm2 = 0.25;

constexpr double kGoodPlate_mm = 0.1, kUsablePlate_mm = 0.5;  // three sigma anywhere on the plate
constexpr double kNoiseFloor_mm = 0.01;  // of a world point, for what three points can promise
constexpr double kSmallestOutlier_mm = 0.05;
constexpr double kWrongByChance = 1e-3;   // of a plate whose points are all right: one of them is left out
constexpr double kLeastRest_mm2 = 1e-12;  // squares that exact points leave
constexpr double kSmallestPlate_mm = 2;   // a smaller one looks like metres
constexpr double kLeastSize_mm = 1e-12, kLeastSpread_mm2 = 1e-12;  // guard quotients
// Sizes a thousand times apart, to twice either way.
constexpr double kThousandthFrom = 0.0005, kThousandthTo = 0.002, kThousandFrom = 500, kThousandTo = 2000;
constexpr double kSamePoint = 1e-6;   // of the plate's size, at least of a millimetre
constexpr double kStretchSigmas = 4;  // a wrong scale is that sure

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
        if (point.plate.cwiseAbs().maxCoeff() > kLargestBody_mm ||
            point.world.cwiseAbs().maxCoeff() > kFarthestPoint_mm)
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
    if (size > 0 && size < kSmallestPlate_mm)
        return input_error(
            Text("the plate measures {:.3g} only: its points look like metres, not millimetres", size),
            "points", "give millimetres (times 1000)");
    const double ratio = world_size / std::max(size, kLeastSize_mm);
    if (ratio > kThousandthFrom && ratio < kThousandthTo)
        return input_error(
            "the world points are a thousandth of the plate's size: they look like metres, not millimetres",
            "points", "give millimetres (times 1000)");
    if (ratio > kThousandFrom && ratio < kThousandTo)
        return input_error(
            "the plate points are a thousandth of the world's size: they look like metres, not millimetres",
            "points", "give millimetres (times 1000)");
    for (size_t i = 0; i < points.size(); ++i)
        for (size_t k = 0; k < i; ++k)
            if (use[i] && use[k] && (plate[i] - plate[k]).norm() < kSamePoint * std::max(1.0, size))
                return input_error(Text("'{}' and '{}' are the same point of the plate", ids[k], ids[i]),
                                   "points", "give different points, or their mean once");
    return {};
}

// Pairs of points, and which of them count.
struct Pairs {
    Points plate, world;
    std::vector<bool> use;
    double size = 0;  // of the plate

    // To a thousandth of its length: the turn about it hangs on the noise.
    bool on_a_line() const {
        return across_line(plate, use) < kThinPlate * size || across_line(world, use) < kThinPlate * size;
    }
    double used() const { return static_cast<double>(std::count(use.begin(), use.end(), true)); }
    Pose fit() const { return fit_rigid(world, plate, use); }
    double squares(const Pose& pose) const { return squares_of(world, plate, pose, use); }
};

struct PairsFit {
    Pose pose;
    double squares = 0;
};

// Wrong points, one after the other: the one whose absence explains the misfit (F test of its three numbers). Marks them
// in `report`; their names.
std::string drop_wrong(const std::vector<PlatePoint>& points, Pairs& pairs, PairsFit& fit,
                       CalibrationReport& report) {
    std::string wrong;
    for (;;) {
        const double redundancy = 3 * (pairs.used() - 1) - 6;
        if (redundancy < 3) break;
        size_t suspect = points.size();
        PairsFit best = fit;
        for (size_t i = 0; i < points.size(); ++i) {
            if (!pairs.use[i]) continue;
            pairs.use[i] = false;
            const Pose candidate = pairs.fit();
            const double rest = pairs.squares(candidate);
            if (rest < best.squares && !pairs.on_a_line()) {
                best = {candidate, rest};
                suspect = i;
            }
            pairs.use[i] = true;
        }
        if (suspect == points.size()) break;
        const double f =
            (fit.squares - best.squares) / 3 / (std::max(best.squares, kLeastRest_mm2) / redundancy);
        const double miss = (pairs.world[suspect] - best.pose * pairs.plate[suspect]).norm();
        // Of four, three fit each other by chance more often than the general limit allows for.
        const double limit =
            std::max(outlier_limit(redundancy), f_quantile(3, redundancy, 1 - kWrongByChance / pairs.used()));
        if (f < limit || miss < kSmallestOutlier_mm) break;
        pairs.use[suspect] = false;
        fit = best;
        report.poses[suspect].used = false;
        report.poses[suspect].note = Text("contradicts the other points by {:.2f} mm", miss);
        wrong += (wrong.empty() ? "" : ", ") + points[suspect].id;
    }
    return wrong;
}

// Each point by the others.
void leave_one_out(Pairs pairs, CalibrationReport& report) {
    double sum = 0, largest = 0;
    for (size_t i = 0; i < pairs.use.size(); ++i) {
        if (!pairs.use[i]) continue;
        pairs.use[i] = false;
        const double miss = (pairs.world[i] - pairs.fit() * pairs.plate[i]).norm();
        const bool fixed = !pairs.on_a_line();
        pairs.use[i] = true;
        if (!fixed) continue;
        sum += miss * miss;
        largest = std::max(largest, miss);
        ++report.hold_out.folds;
    }
    if (report.hold_out.folds == 0) return;
    report.hold_out.left_out = 1;
    report.hold_out.rms_mm = std::sqrt(sum / report.hold_out.folds);
    report.hold_out.max_mm = largest;
}

// A reflection that fits far better than any rotation: one set has a flipped axis.
bool mirrored(const PairMoments& m, double squares, double count) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m.cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const bool reflects = (svd.matrixV() * svd.matrixU().transpose()).determinant() < 0;
    const double gain = 4 * svd.singularValues()[2];  // by how much the reflection lowers the sum of squares
    return reflects && gain > kMirrorGain * squares && squares > count * kMirrorMisfit_mm2;
}

// Largest sigma of a point on the plate.
double worst_sigma_mm(const Points& plate, const Pose& pose, const Matrix6& covariance) {
    double worst = 0;
    for (const auto& point : plate) {
        Eigen::Matrix<double, 3, 6> j;
        j.leftCols<3>().setIdentity();
        j.rightCols<3>() = -skew(pose.linear() * point);
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(
            Eigen::Matrix3d(j * covariance * j.transpose()));
        worst = std::max(worst, std::sqrt(std::max(0.0, eigen.eigenvalues()[2])));
    }
    return worst;
}

Judgement judged(const PlateResult& result, double given_sigma_mm, double worst_mm, double size,
                 double spread, double count) {
    const double stretch = std::abs(result.scale - 1) * size;
    const double stretch_sigma =
        std::max(result.sigma_mm, kNoiseFloor_mm) * size / std::sqrt(std::max(kLeastSpread_mm2, spread));
    const Text fit("rms {:.3f} mm, three sigma on the plate {:.3f} mm", result.rms_mm, 3 * worst_mm);
    if (result.mirrored) {
        return {Verdict::poor, "the world points fit a mirrored plate",
                "check for an axis that is flipped or swapped"};
    } else if (stretch > kStretch_mm && stretch > kStretchSigmas * stretch_sigma &&
               std::abs(result.scale - 1) > kSmallestScale) {
        return {Verdict::poor,
                Text("distances in the world are {:.5f} times those on the plate", result.scale),
                "check the plate's drawing, the scale of the measuring system and the order of the points"};
    } else if (result.contradicted) {
        return {
            Verdict::poor,
            Text("the points scatter by {:.3f} mm, more than their sigma of {:.3g} mm allows",
                 result.sigma_mm, given_sigma_mm),
            "check the points and the plate's drawing, or state the sigma that the measuring system keeps"};
    } else if (3 * worst_mm > kUsablePlate_mm || result.rms_mm > kUsablePlate_mm) {
        return {Verdict::poor, fit, "check the order of the points and measure again, with more points"};
    } else if (3 * worst_mm > kGoodPlate_mm || count < 4) {
        return {Verdict::usable, count < 4 ? Text("three points leave little to check with; {}", fit) : fit,
                "measure more points, spread over the whole plate"};
    } else {
        return {Verdict::good, fit, ""};
    }
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
    Pairs pairs;
    SEAM_OK(check_input(points, options, pairs.use));
    PlateResult result;
    auto& report = result.report;
    report.poses.resize(points.size());
    for (size_t i = 0; i < points.size(); ++i) {
        pairs.plate.push_back(points[i].plate);
        pairs.world.push_back(points[i].world);
        report.poses[i].id = points[i].id;
        report.poses[i].used = pairs.use[i];
        report.poses[i].excluded = !pairs.use[i];
        if (!pairs.use[i]) report.poses[i].note = "excluded by the user";
    }
    pairs.size = extent(pairs.plate);
    if (pairs.on_a_line()) {
        result.status = PlateStatus::undetermined;
        report.judgement = {Verdict::undetermined,
                            "the points lie on one line: the turn about it is not determined",
                            "measure at least one point well off that line"};
        return result;
    }

    PairsFit fit;
    fit.pose = pairs.fit();
    fit.squares = pairs.squares(fit.pose);
    if (const std::string wrong = drop_wrong(points, pairs, fit, report); !wrong.empty())
        result.notices.push_back(Text("not used, contradicting the others: {}", wrong));

    const double count = pairs.used();
    const double redundancy = 3 * count - 6;
    result.status = PlateStatus::ok;
    result.world_from_plate = fit.pose;
    result.rms_mm = std::sqrt(fit.squares / count);
    result.contradicted =
        options.sigma_mm && contradicts_stated(fit.squares / std::pow(*options.sigma_mm, 2), redundancy);
    const bool stated = options.sigma_mm && !result.contradicted;
    result.sigma_mm = stated ? *options.sigma_mm : std::sqrt(fit.squares / redundancy);
    const double student = stated ? 1 : student_quantile(kUpper95, redundancy) / kNormal95;
    const Matrix6 unit = inverse_matrix(information_of(pairs.plate, fit.pose, pairs.use));
    result.covariance = unit * (result.sigma_mm * result.sigma_mm * student * student);
    const PairMoments m = moments_of(pairs.world, pairs.plate, pairs.use);
    result.scale = std::sqrt(m.spread_to / m.spread_from);
    result.mirrored = mirrored(m, fit.squares, count);

    for (size_t i = 0; i < points.size(); ++i)
        report.poses[i].rms_mm = (pairs.world[i] - fit.pose * pairs.plate[i]).norm();
    add_pose(report, fit.pose);
    state_covariance(report, result.covariance);
    if (count >= 4) leave_one_out(pairs, report);

    // With a floor: three points fit anything.
    const Matrix6 honest = unit * std::pow(std::max(result.sigma_mm * student, kNoiseFloor_mm), 2);
    report.judgement =
        judged(result, options.sigma_mm.value_or(0), worst_sigma_mm(pairs.plate, fit.pose, honest),
               pairs.size, m.spread_from, count);
    return result;
}

}  // namespace seamwright
