#include "core/calibration/stripe/laser_plane.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "core/calibration/camera/camera.h"
#include "core/calibration/numbers.h"
#include "core/calibration/pose_set.h"
#include "core/calibration/statistics.h"
#include "core/calibration/stripe/laser_plane_camera.h"
#include "core/numbers.h"
#include "core/profile/units.h"

namespace seamwright {
namespace {

constexpr double kRemovalTells = 20;      // F of the two numbers of a pair: far beyond what noise gives
constexpr double kLeastRest_px2 = 1e-12;  // of exact pairs, a number
constexpr double kOpenPose_mm = 5, kOpenPose_deg = 2;        // sigma, from which on the pose is open
constexpr double kUsablePose_mm = 1, kUsablePose_deg = 0.3;  // sigma, beyond
constexpr int kFewPairs = 10;
// What pixel and point miss one another by beyond what the stated places explain, sqrt(2) times the sigma of a coordinate:
// the limits of a camera's corners. Apexes in an image and in a profile are found to 0.1 to 0.3 px.
// With fewer pairs than a wrong one can be told among it is to be trusted less.
constexpr double kUsableMisfit_px = 0.5, kPoorMisfit_px = 1.5, kPoorMisfitOfFew_px = 1;
constexpr int kFewestToTell = 6;
// Rms of what a freed camera takes away. Cameras of good calibrations differ by less than the first over the field.
constexpr double kUsablePattern_px = 0.1, kPoorPattern_px = 0.3;

CameraPoints view_of(const std::vector<LaserPair>& pairs, const std::vector<char>& used, int without = -1) {
    CameraPoints view;
    view.id = "pairs";
    for (std::size_t i = 0; i < pairs.size(); ++i)
        if (used[i] && static_cast<int>(i) != without) {
            view.object_mm.emplace_back(pairs[i].laser_mm.x(), 0, pairs[i].laser_mm.y());
            view.pixel.push_back(pairs[i].pixel);
        }
    return view;
}

double residual_px(const CameraModel& camera, const Pose& pose, const LaserPair& pair) {
    return (camera.project(pose * Eigen::Vector3d(pair.laser_mm.x(), 0, pair.laser_mm.y())) - pair.pixel)
        .norm();
}

// Variance of one coordinate of a pixel from that of its place in the laser plane, mean over the pairs in use.
double variance_of_places(const CameraModel& camera, const Pose& pose, const CameraPoints& view,
                          double place_sigma_mm) {
    constexpr double kStep_mm = 1e-3;
    double sum = 0;
    for (const auto& at : view.object_mm)
        for (const int axis : {0, 2}) {
            const Eigen::Vector3d step = kStep_mm * Eigen::Vector3d::Unit(axis);
            sum +=
                ((camera.project(pose * (at + step)) - camera.project(pose * (at - step))) / (2 * kStep_mm))
                    .squaredNorm();
        }
    return place_sigma_mm * place_sigma_mm * sum / (2 * static_cast<double>(view.object_mm.size()));
}

// Width of the points across their main direction relative to along it.
double flatness(const CameraPoints& view) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& p : view.object_mm) mean += p / static_cast<double>(view.object_mm.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const auto& p : view.object_mm) scatter += (p - mean) * (p - mean).transpose();
    const Eigen::Vector3d l = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvalues();
    return l(2) > 0 ? std::sqrt(std::max(0.0, l(1)) / l(2)) : 0;
}

}  // namespace

Expected<LaserPlaneResult> calibrate_laser_plane(const CameraModel& camera,
                                                 const std::vector<LaserPair>& pairs,
                                                 const std::vector<std::string>& exclude,
                                                 double place_sigma_mm) {
    std::vector<std::string> ids;
    for (const auto& p : pairs) ids.push_back(p.id);
    SEAM_OK(check_ids(ids, exclude, "pairs"));
    LaserPlaneResult result;
    auto& report = result.report;
    std::vector<char> used(pairs.size(), 1);
    double extent = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (!pairs[i].pixel.allFinite() || !pairs[i].laser_mm.allFinite() ||
            pairs[i].laser_mm.norm() > kFarthestPoint_mm)
            return input_error("the pair is not made of finite numbers", "pairs[" + pairs[i].id + "]",
                               "leave it out");
        used[i] = std::count(exclude.begin(), exclude.end(), pairs[i].id) == 0;
        report.poses.emplace_back();
        report.poses.back().id = pairs[i].id;
        report.poses.back().used = used[i];
        report.poses.back().excluded = !used[i];
        if (!used[i]) report.poses.back().note = "excluded";
        extent = std::max(extent, (pairs[i].laser_mm - pairs[0].laser_mm).norm());
    }
    const auto count = [&] { return static_cast<int>(std::count(used.begin(), used.end(), 1)); };
    if (count() < 4)
        return input_error(Text("{} pairs are too few, at least 4 are needed", count()), "pairs",
                           "place the body in 10 or more positions over the whole field of view");
    SEAM_OK(check_span_millimetres(extent, "pairs"));
    static constexpr const char* names[] = {"x", "y", "z", "rx", "ry", "rz"};
    const auto undetermined = [&](const Text& why) {
        report.judgement = {Verdict::undetermined, why,
                            "spread the body's positions over the whole field of view, near and far"};
        for (int i = 0; i < 6; ++i)
            report.parameters.push_back({names[i], std::numeric_limits<double>::quiet_NaN(),
                                         i < 3 ? "mm" : "deg", std::numeric_limits<double>::quiet_NaN()});
        return result;
    };
    if (flatness(view_of(pairs, used)) < kPairsOnALine)
        return undetermined("the points lie on one line of the laser plane");
    const auto row_first = [&](double swapped_px) {
        return Judgement{Verdict::poor,
                         Text("the pairs fit to {:.2f} px when they are read as [v, u]", swapped_px),
                         "write every pixel as [column, row]"};
    };
    const auto unless_swapped = [&](const Text& why) {
        const auto swapped = fits_swapped(camera, view_of(pairs, used), kInfinity);
        undetermined(why);
        if (swapped && *swapped < kUsableMisfit_px) {
            report.judgement = row_first(*swapped);
            report.judgement.verdict = Verdict::undetermined;
        }
        return result;
    };
    auto solved = locate_target(camera, view_of(pairs, used));
    if (!solved) return unless_swapped(solved.error().what);

    // The pair whose removal helps most, while the gain is far beyond what noise gives.
    for (int round = 0; count() >= kFewestToTell && round < static_cast<int>(pairs.size()) / 4 + 1; ++round) {
        const double n = count();
        const double cost = n * solved->rms_px * solved->rms_px;
        int worst = -1;
        double least = cost;
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            if (!used[i]) continue;
            const auto rest = locate_target(camera, view_of(pairs, used, static_cast<int>(i)));
            if (!rest) continue;
            const double c = (n - 1) * rest->rms_px * rest->rms_px;
            if (c < least) least = c, worst = static_cast<int>(i);
        }
        const double freedom = 2 * (n - 1) - 6;
        if (worst < 0 || (cost - least) / 2 < kRemovalTells * std::max(least / freedom, kLeastRest_px2))
            break;
        used[static_cast<std::size_t>(worst)] = 0;
        auto& p = report.poses[static_cast<std::size_t>(worst)];
        p.used = false;
        p.note = "contradicts the other pairs and was left out";
        auto again = locate_target(camera, view_of(pairs, used));
        if (!again) break;
        solved = again;
    }
    const CameraPoints view = view_of(pairs, used);
    if (flatness(view) < kPairsOnALine) return undetermined("the points lie on one line of the laser plane");
    result.camera_from_laser = solved->camera_from_target;
    const double freedom = std::max(1.0, 2.0 * count() - 6);
    const double student = student_quantile(kUpper95, freedom) / normal_quantile(kUpper95);
    const double seen = solved->rms_px * solved->rms_px * count() / freedom;
    const double stated = variance_of_places(camera, solved->camera_from_target, view, place_sigma_mm);
    result.covariance = solved->covariance * std::max(student * student, seen > 0 ? stated / seen : 0.0);
    result.rms_px = solved->rms_px;
    const double squares = solved->rms_px * solved->rms_px * count();
    // What the pairs leave open by themselves; how far a doubted camera would move the pose is another matter.
    const double open_mm = std::sqrt(result.covariance.topLeftCorner<3, 3>().trace());
    const double open_deg = deg_from_rad(std::sqrt(result.covariance.bottomRightCorner<3, 3>().trace()));
    const CameraDoubt doubt = doubt_of_camera(camera, solved->camera_from_target, view, squares);
    if (doubt.tells) result.covariance += doubt.moves * doubt.moves.transpose();
    const double unexplained = !(stated > 0)                                   ? seen
                               : contradicts_stated(squares / stated, freedom) ? std::max(0.0, seen - stated)
                                                                               : 0;
    const double misfit_px = std::sqrt(2 * unexplained);
    const auto swapped = misfit_px > kUsableMisfit_px ? fits_swapped(camera, view, squares) : std::nullopt;
    result.notices.emplace_back(
        "the camera counts as exact: what its focal length, centre and distortion err by is not in the "
        "sigmas");
    add_pose(report, result.camera_from_laser);
    state_covariance(report, result.covariance);

    double hold = 0, hold_mm = 0, hold_mm_max = 0;
    int folds = 0;
    SensorModel model{camera, result.camera_from_laser, {}};
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        report.poses[i].rms_px = residual_px(camera, result.camera_from_laser, pairs[i]);
        if (const auto xz = model.to_laser(pairs[i].pixel))
            report.poses[i].rms_mm = (*xz - pairs[i].laser_mm).norm();
        if (!used[i] || count() < kFewestToTell) continue;
        const auto rest = locate_target(camera, view_of(pairs, used, static_cast<int>(i)));
        if (!rest) continue;
        const double e = residual_px(camera, rest->camera_from_target, pairs[i]);
        const SensorModel other{camera, rest->camera_from_target, {}};
        if (const auto xz = other.to_laser(pairs[i].pixel)) {
            const double mm = (*xz - pairs[i].laser_mm).norm();
            hold_mm += mm * mm;
            hold_mm_max = std::max(hold_mm_max, mm);
        }
        hold += e * e;
        ++folds;
    }
    if (folds) {
        report.hold_out.folds = folds;
        report.hold_out.left_out = 1;
        report.hold_out.rms_px = std::sqrt(hold / folds);
        report.hold_out.rms_mm = std::sqrt(hold_mm / folds);
        report.hold_out.max_mm = hold_mm_max;
    }
    const double sigma_mm = std::sqrt(result.covariance.topLeftCorner<3, 3>().trace());
    const double sigma_deg = deg_from_rad(std::sqrt(result.covariance.bottomRightCorner<3, 3>().trace()));
    const std::string without = left_out(report.poses);
    const char* more = "add pairs in the corners of the field of view, near and far";
    if (!(open_mm < kOpenPose_mm) || !(open_deg < kOpenPose_deg)) {
        report.parameters.clear();
        report.covariance.resize(0, 0);
        return unless_swapped(
            Text("the pairs leave the pose open (sigma {:.1f} mm, {:.1f} degrees)", open_mm, open_deg));
    }
    const bool moved_far = open_mm < kUsablePose_mm && open_deg < kUsablePose_deg &&
                           !(sigma_mm < kUsablePose_mm && sigma_deg < kUsablePose_deg);
    const Text pattern("the residuals have the form of a lens that bends otherwise ({:.2f} px)",
                       doubt.pattern_px);
    const char* camera_cure =
        "give the camera as it was calibrated, with k1, k2, p1, p2 and k3, and check that the positions' x "
        "and z "
        "are of one scale";
    if (swapped)
        report.judgement = row_first(*swapped);
    else if (doubt.tells && doubt.pattern_px > kPoorPattern_px)
        report.judgement = {Verdict::poor, pattern, camera_cure};
    else if (result.rms_px > kPoorPairs_px ||
             misfit_px > (count() < kFewestToTell ? kPoorMisfitOfFew_px : kPoorMisfit_px))
        report.judgement = {Verdict::poor,
                            Text("the pairs fit to {:.1f} px only", std::max(result.rms_px, misfit_px)),
                            "check the camera and that pixels and laser points belong together"};
    else if (!without.empty())
        report.judgement = {Verdict::usable,
                            Text("the pair {} contradicts the others and was left out", without),
                            "measure it again"};
    else if (count() < kFewPairs)
        report.judgement = {Verdict::usable, Text("{} pairs are few", count()),
                            "take 10 or more over the whole field of view"};
    else if (doubt.tells && (doubt.pattern_px > kUsablePattern_px || moved_far))
        report.judgement = {Verdict::usable, pattern, camera_cure};
    else if (misfit_px > kUsableMisfit_px)
        report.judgement = {Verdict::usable,
                            Text("pixels and laser points miss one another by {:.2f} px", misfit_px),
                            "check the camera, and state how well the positions are known"};
    else if (sigma_mm > kUsablePose_mm || sigma_deg > kUsablePose_deg)
        report.judgement = {Verdict::usable,
                            Text("the pose is known to {:.2f} mm and {:.2f} degrees", sigma_mm, sigma_deg),
                            more};
    else
        report.judgement = {Verdict::good,
                            Text("{} pairs fit to {:.2f} px, sigma {:.2f} mm and {:.3f} degrees", count(),
                                 result.rms_px, sigma_mm, sigma_deg),
                            ""};
    return result;
}

}  // namespace seamwright
