#include "core/calibration/camera/camera.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <numeric>
#include <set>

#include "core/calibration/camera/camera_limits.h"
#include "core/calibration/camera/plate_bends.h"
#include "core/calibration/camera/plate_doubt.h"
#include "core/calibration/camera/projection.h"
#include "core/calibration/numbers.h"
#include "core/calibration/pose_set.h"
#include "core/median.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

constexpr double kLeastCornerSigma_px = 1e-3;  // exact corners do not make a prior infinitely weak
constexpr double kSmallestTarget_mm = 0.5;     // spread along its longest axis; less looks like metres
constexpr double kFlatTarget = 0.05;           // of its width: a target less deep is a plate

// From simple to rich.
constexpr CameraFreedom kLadder[] = {
    {false, false, 0, false}, {false, false, 1, false}, {false, true, 1, false}, {true, true, 1, false},
    {true, true, 2, false},   {true, true, 2, true},    {true, true, 3, true},
};

// Extents of a point set along its principal axes, largest first.
Eigen::Vector3d extents(const std::vector<Eigen::Vector3d>& points) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& p : points) mean += p;
    mean /= static_cast<double>(points.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const auto& p : points) scatter += (p - mean) * (p - mean).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scatter / static_cast<double>(points.size()),
                                                               Eigen::EigenvaluesOnly);
    return eigen.eigenvalues().reverse().cwiseMax(0).cwiseSqrt();
}

Expected<void> check(const CameraData& data, const CameraOptions& options) {
    if (data.width < kSmallestImage_px || data.height < kSmallestImage_px || data.width > kLargestImage_px ||
        data.height > kLargestImage_px)
        return input_error(Text("an image of {}x{} pixels is not possible", data.width, data.height), "size",
                           "give width and height of the images in pixels");
    std::vector<std::string> ids;
    for (const auto& v : data.views) ids.push_back(v.id);
    if (ids.empty()) return input_error("there is no view", "views", "give at least 3 views of the plate");
    SEAM_OK(check_ids(ids, options.exclude, "views"));
    double size_mm = 0;
    for (const auto& v : data.views) {
        const std::string where = "views[" + v.id + "]";
        if (v.pixel.size() != v.object_mm.size())
            return input_error(Text("{} points but {} pixels", v.object_mm.size(), v.pixel.size()), where,
                               "give one pixel per point");
        if (v.pixel.size() < 4)
            return input_error(Text("{} points are too few for a pose, 4 are needed", v.pixel.size()), where,
                               "leave the view out or give more points");
        for (std::size_t i = 0; i < v.pixel.size(); ++i) {
            if (!v.pixel[i].allFinite() || !v.object_mm[i].allFinite() ||
                v.object_mm[i].cwiseAbs().maxCoeff() > kFarthestPoint_mm)
                return input_error(Text("point {} is not a finite number of millimetres and pixels", i),
                                   where, "leave it out");
            if (v.pixel[i].x() < -1 || v.pixel[i].y() < -1 || v.pixel[i].x() > data.width ||
                v.pixel[i].y() > data.height)
                return input_error(Text("pixel {} ({:.1f}, {:.1f}) lies outside the image of {}x{}", i,
                                        v.pixel[i].x(), v.pixel[i].y(), data.width, data.height),
                                   where, "check the image size; all views must have the same");
        }
        const Eigen::Vector3d e = extents(v.object_mm);
        if (!(e(1) > kPointsOnALine * e(0)))
            return input_error("the points lie on one line", where, "give points that span a plane");
        size_mm = std::max(size_mm, e(0));
    }
    if (size_mm < kSmallestTarget_mm)
        return input_error(Text("the target is {:.3f} mm across, which looks like metres", 2 * size_mm),
                           "views", "give its points in millimetres");
    return {};
}

// Index of an earlier view with the same pixels, or -1.
int twin_of(const CameraData& data, std::size_t view) {
    for (std::size_t i = 0; i < view; ++i) {
        const auto &a = data.views[i].pixel, &b = data.views[view].pixel;
        if (a.size() != b.size()) continue;
        double worst = 0;
        for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, (a[k] - b[k]).norm());
        if (worst < kSamePicture_px) return static_cast<int>(i);
    }
    return -1;
}

CameraData without(const CameraData& data, const std::vector<char>& drop) {
    CameraData out;
    out.width = data.width;
    out.height = data.height;
    for (std::size_t i = 0; i < data.views.size(); ++i)
        if (!drop[i]) out.views.push_back(data.views[i]);
    return out;
}

template <class T>
std::vector<T> kept_of(const std::vector<T>& all, const std::vector<char>& drop) {
    std::vector<T> out;
    for (std::size_t i = 0; i < all.size(); ++i)
        if (!drop[i]) out.push_back(all[i]);
    return out;
}

// Squared error (px^2 per point) of every view as the others' camera predicts it, its pose fitted; up to 10
// folds.
struct Prediction {
    std::vector<double> view;  // mean squared error
    double mean = kInfinity;   // over views
    double max_mm = 0, square_mm = 0;
    int folds = 0, left_out = 0;
};

Prediction predict(const CameraData& data, const std::vector<std::vector<char>>& used,
                   const CameraFreedom& freedom, const CameraSolution& all) {
    Prediction out;
    const std::size_t n = data.views.size();
    out.folds = static_cast<int>(std::min<std::size_t>(n, 10));
    out.left_out =
        static_cast<int>((n + static_cast<std::size_t>(out.folds) - 1) / static_cast<std::size_t>(out.folds));
    out.view.assign(n, kInfinity);
    for (int fold = 0; fold < out.folds; ++fold) {
        std::vector<char> drop(n, 0);
        for (std::size_t i = static_cast<std::size_t>(fold); i < n; i += static_cast<std::size_t>(out.folds))
            drop[i] = 1;
        CameraSolution start = all;
        start.camera_from_target = kept_of(all.camera_from_target, drop);
        const auto rest = refine_camera(without(data, drop), kept_of(used, drop), freedom, start);
        const CameraModel camera = camera_of(rest.intrinsics, data.width, data.height);
        for (std::size_t i = 0; i < n; ++i) {
            if (!drop[i]) continue;
            if (const auto t = locate_target(camera, chosen(data.views[i], used[i]))) {
                out.view[i] = t->rms_px * t->rms_px;
                const double mm = t->rms_px * t->camera_from_target.translation().norm() / camera.fx;
                out.max_mm = std::max(out.max_mm, mm);
                out.square_mm += mm * mm / static_cast<double>(n);
            }
        }
    }
    out.mean = std::accumulate(out.view.begin(), out.view.end(), 0.0) / static_cast<double>(n);
    return out;
}

// The richest model that does not predict worse than the best one by more than a standard error. Superfluous
// freedom only widens the stated sigmas; a missing term bends the camera without a sign.
CameraFreedom choose_freedom(const CameraData& data, const std::vector<std::vector<char>>& used,
                             const CameraSolution& start, std::size_t flat_views) {
    if (flat_views > 0 && data.views.size() < 4) return {false, data.views.size() > 2, 1, false};
    std::vector<Prediction> predictions;
    std::size_t best = 0;
    for (const auto& freedom : kLadder) {
        const auto solution = refine_camera(data, used, freedom, start);
        predictions.push_back(predict(data, used, freedom, solution));
        if (shared_covariance(solution.normal).size() == 0) predictions.back().mean = kInfinity;
        if (predictions.back().mean < predictions[best].mean) best = predictions.size() - 1;
    }
    const auto n = static_cast<double>(data.views.size());
    for (std::size_t m = predictions.size() - 1; m > best; --m) {
        const double gap = predictions[m].mean - predictions[best].mean;
        if (!std::isfinite(gap)) continue;
        double variance = 0;
        for (std::size_t k = 0; k < data.views.size(); ++k) {
            const double d = predictions[m].view[k] - predictions[best].view[k] - gap;
            variance += d * d;
        }
        if (gap < std::sqrt(variance / (n * std::max(n - 1, 1.0)))) return kLadder[m];
    }
    return kLadder[best];
}

// Marks points farther off than `sigmas` robust standard deviations; at most a tenth of a view. Returns how
// many.
int drop_outliers(const CameraData& data, const CameraSolution& solution, double sigmas,
                  std::vector<std::vector<char>>& used) {
    std::vector<double> size;
    const auto residual = [&](std::size_t i, std::size_t k) {
        const Eigen::Vector3d ray = solution.camera_from_target[i] * data.views[i].object_mm[k];
        return (pixel_of_ray(solution.intrinsics.data(), ray.x() / ray.z(), ray.y() / ray.z()) -
                data.views[i].pixel[k])
            .norm();
    };
    for (std::size_t i = 0; i < data.views.size(); ++i)
        for (std::size_t k = 0; k < data.views[i].pixel.size(); ++k)
            if (used[i][k]) size.push_back(residual(i, k));
    constexpr double kLeastLimit_px = 1e-6;  // rounding of exact corners is nothing wrong
    const double limit = std::max(sigmas * median(size) / kRayleighMedian, kLeastLimit_px);
    int dropped = 0;
    for (std::size_t i = 0; i < data.views.size(); ++i) {
        int room = static_cast<int>(data.views[i].pixel.size() / 10);
        for (std::size_t k = 0; k < data.views[i].pixel.size() && room > 0; ++k)
            if (used[i][k] && residual(i, k) > limit) {
                used[i][k] = 0;
                ++dropped;
                --room;
            }
    }
    return dropped;
}

double hull_share(const CameraData& data) {
    std::vector<Eigen::Vector2d> p;
    for (const auto& v : data.views) p.insert(p.end(), v.pixel.begin(), v.pixel.end());
    const auto less = [](const auto& a, const auto& b) {
        return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
    };
    std::sort(p.begin(), p.end(), less);
    std::vector<Eigen::Vector2d> hull;
    const auto turn = [](const auto& o, const auto& a, const auto& b) {
        return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
    };
    for (int pass = 0; pass < 2; ++pass) {
        const std::size_t base = hull.size();
        for (const auto& q : p) {
            while (hull.size() >= base + 2 && turn(hull[hull.size() - 2], hull.back(), q) <= 0)
                hull.pop_back();
            hull.push_back(q);
        }
        hull.pop_back();
        std::reverse(p.begin(), p.end());
    }
    double area = 0;
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const auto &a = hull[i], &b = hull[(i + 1) % hull.size()];
        area += 0.5 * (a.x() * b.y() - a.y() * b.x());
    }
    return std::abs(area) / (static_cast<double>(data.width) * data.height);
}

// In words; empty: the plate is not doubted.
Text plate_hint(const PlateDoubt& doubt) {
    if (!doubt.tells) return {};
    return Text(
        "the plate is not as stated: stretched {:.2f} %, sheared {:.2f} %, bowed {:.2f} mm would take {:.0f} "
        "% of the "
        "residuals away",
        100 * doubt.shape.stretch, 100 * doubt.shape.shear, doubt.shape.bow_mm.cwiseAbs().maxCoeff(),
        100 * (1 - std::sqrt(1 - doubt.fall)));
}

// `bent`: by how many sigma the plate's own shape moves focal lengths or centre.
// `bends`: what the plate's bending from view to view does to the camera, where that is more than its corners' noise does.
Judgement judge(const CameraResult& r, std::size_t views, const Text& hint, double bent, const Text& bends) {
    // What is worse is poor, or usable: sigma of the focal length over itself, and fit of the corners.
    constexpr double kPoorFocal = 0.01, kUsableFocal = 0.002, kUsableCorners_px = 0.5;
    constexpr double kMostBent = 3;            // sigma
    constexpr double kCoveredShare = 1.0 / 3;  // of the image: less extrapolates the distortion
    const double f = 0.5 * (r.camera.fx + r.camera.fy);
    const double sigma = r.report.covariance.size() ? r.report.parameters[0].sigma : kInfinity;
    const char* tilt =
        "take 10 or more views with the plate tilted by 20 to 40 degrees in different directions";
    const char* flat = "measure the plate or take a flat one";
    if (!hint.empty() && !(bent < kMostBent)) return {Verdict::poor, hint, flat};
    if (!(sigma < kOpenFocal * f) || !std::isfinite(f))
        return {
            Verdict::undetermined,
            Text(
                "the views do not determine the focal length (their plates differ by {:.1f} degrees of tilt)",
                r.tilt_spread_deg),
            tilt};
    if (r.rms_px > kPoorCorners_px)
        return {Verdict::poor, Text("the points fit to {:.2f} px only", r.rms_px),
                "check focus, the pattern's size and that the plate is flat"};
    if (sigma > kPoorFocal * f)
        return {Verdict::poor, Text("the focal length is known to {:.1f} % only", 100 * sigma / f), tilt};
    if (!hint.empty()) return {Verdict::usable, hint, flat};
    if (!bends.empty())
        return {Verdict::usable, bends, "take a stiff plate and hold it without force, or lay it down"};
    if (sigma > kUsableFocal * f)
        return {Verdict::usable, Text("the focal length is known to {:.2f} %", 100 * sigma / f), tilt};
    if (r.rms_px > kUsableCorners_px)
        return {Verdict::usable, Text("the points fit to {:.2f} px", r.rms_px),
                "check focus and that the plate is flat"};
    if (r.covered_share < kCoveredShare)
        return {Verdict::usable,
                Text("the views cover {:.0f} % of the image: the distortion outside is extrapolated",
                     100 * r.covered_share),
                "add views with the plate in the corners of the image"};
    return {Verdict::good,
            Text("{} views, points fit to {:.2f} px, focal length to {:.2f} %, {:.0f} % of the image covered",
                 views, r.rms_px, 100 * sigma / f, 100 * r.covered_share),
            ""};
}

}  // namespace

Expected<CameraResult> calibrate_camera(const CameraData& input, const CameraOptions& options) {
    SEAM_OK(check(input, options));
    CameraResult result;
    const std::size_t total = input.views.size();
    result.camera_from_target.assign(total, Pose::Identity());
    result.pose_covariance.assign(total, Matrix6::Zero());
    std::vector<char> drop(total, 0);
    std::size_t flat = 0;
    for (std::size_t i = 0; i < total; ++i) {
        PoseResidual p;
        p.id = input.views[i].id;
        const int twin = twin_of(input, i);
        if (std::count(options.exclude.begin(), options.exclude.end(), p.id))
            p.note = "excluded";
        else if (twin >= 0)
            p.note = Text("the same view as {}", input.views[static_cast<std::size_t>(twin)].id);
        p.used = p.note.empty();
        drop[i] = !p.used;
        if (p.used) {
            const Eigen::Vector3d e = extents(input.views[i].object_mm);
            flat += e(2) < kFlatTarget * e(1);
        }
        result.report.poses.push_back(std::move(p));
        result.point_used.emplace_back(input.views[i].pixel.size(), 1);
    }
    const CameraData data = without(input, drop);
    if (data.views.empty() || (flat == data.views.size() && flat < 2))
        return input_error(Text("{} different view(s) of a plate are too few", data.views.size()), "views",
                           "give at least 3, better 10, views with the plate tilted in different directions");
    const auto start = start_camera(data);
    if (!start)
        return input_error("no camera explains any of the views", "views",
                           "check the order of the points and the size of the plate");
    std::vector<std::vector<char>> used;
    for (const auto& v : data.views) used.emplace_back(v.pixel.size(), 1);

    CameraFreedom freedom = options.freedom ? *options.freedom : choose_freedom(data, used, *start, flat);
    CameraSolution solution = refine_camera(data, used, freedom, *start);
    for (int round = 0; options.outlier_sigmas > 0 && round < 3; ++round) {
        if (!drop_outliers(data, solution, options.outlier_sigmas, used)) break;
        if (!options.freedom) freedom = choose_freedom(data, used, solution, flat);
        solution = refine_camera(data, used, freedom, solution);
    }
    result.freedom = freedom;
    const auto redundancy_of = [&](const CameraSolution& s) {
        return 2.0 * static_cast<double>(s.points) - 6.0 * static_cast<double>(data.views.size()) -
               static_cast<double>(freedom_basis(freedom).cols());
    };
    // What the model holds is held as well as cameras are built, beside corners as good as they turn out.
    const bool exactly = options.freedom.has_value();
    for (int round = 0; !exactly && round < 2 && redundancy_of(solution) > 0; ++round)
        solution =
            refine_camera(data, used, freedom, solution,
                          std::max(kLeastCornerSigma_px, std::sqrt(solution.cost / redundancy_of(solution))));
    const double redundancy = redundancy_of(solution);
    result.camera = camera_of(solution.intrinsics, data.width, data.height);
    result.rms_px = std::sqrt(solution.cost / static_cast<double>(solution.points));
    result.sigma_px = redundancy > 0 ? std::sqrt(solution.cost / redundancy) : 0;
    result.covered_share = hull_share(data);

    const Eigen::MatrixXd& basis = solution.basis;
    const Eigen::MatrixXd unit =
        redundancy > 0 && solution.converged ? shared_covariance(solution.normal) : Eigen::MatrixXd();
    const double variance = exactly ? result.sigma_px * result.sigma_px : 1;
    auto& report = result.report;
    for (std::size_t i = 0; i < 9; ++i)
        report.parameters.push_back(
            {kIntrinsicNames[i], solution.intrinsics(static_cast<Eigen::Index>(i)), i < 4 ? "px" : "1", 0});
    const PlateDoubt doubt = doubt_of_plate(data, used, freedom, exactly, result.sigma_px, solution);
    double bent = 0;
    Text bends;
    if (unit.size()) {
        report.covariance = variance * basis * unit * basis.transpose();
        for (Eigen::Index i = 0; doubt.tells && i < 4; ++i)
            if (report.covariance(i, i) > 0)
                bent = std::max(bent, std::abs(doubt.moves(i)) / std::sqrt(report.covariance(i, i)));
        const double corner2 = result.sigma_px * result.sigma_px;
        if (corner2 > 0) {
            const PlateBends plate = bends_of_plate(data, used, solution, variance / corner2 * unit);
            for (Eigen::Index i = 0; plate.tells && i < 4; ++i)
                if (plate.covariance(i, i) > report.covariance(i, i) && report.covariance(i, i) > 0)
                    bends = Text("the plate bends otherwise in each view, by {:.2f} mm", plate.bow_mm);
            report.covariance += plate.covariance;
        }
        if (doubt.tells) report.covariance += doubt.moves * doubt.moves.transpose();
        finish_statistics(report);
    }
    // Poses back to the order of the input; views left out are located with the solved camera.
    std::size_t k = 0;
    std::vector<Eigen::Vector3d> normals;
    for (std::size_t i = 0; i < total; ++i) {
        auto& p = report.poses[i];
        if (drop[i]) {
            if (const auto t = locate_target(result.camera, input.views[i])) {
                result.camera_from_target[i] = t->camera_from_target;
                p.rms_px = t->rms_px;
            }
            continue;
        }
        result.camera_from_target[i] = solution.camera_from_target[k];
        if (unit.size()) result.pose_covariance[i] = variance * view_covariance(solution.normal, unit, k);
        result.point_used[i] = used[k];
        const auto n = static_cast<double>(std::count(used[k].begin(), used[k].end(), 1));
        p.rms_px = std::sqrt(
            squares_px2(solution.intrinsics, solution.camera_from_target[k], chosen(data.views[k], used[k])) /
            std::max(n, 1.0));
        p.rms_mm = p.rms_px * (solution.camera_from_target[k] * data.views[k].object_mm.front()).z() /
                   result.camera.fx;
        if (unit.size())
            p.deg = deg_from_rad(std::sqrt(result.pose_covariance[i].bottomRightCorner<3, 3>().trace()));
        if (n < static_cast<double>(used[k].size())) {
            std::string list;
            for (std::size_t q = 0; q < used[k].size(); ++q)
                if (!used[k][q]) list += (list.empty() ? "" : ", ") + std::to_string(q);
            p.note = Text("points left out as wrong: {}", list);
        }
        normals.push_back(solution.camera_from_target[k].linear().col(2));
        ++k;
    }
    for (const auto& a : normals)
        for (const auto& b : normals)
            result.tilt_spread_deg =
                std::max(result.tilt_spread_deg, deg_from_rad(std::acos(std::clamp(a.dot(b), -1.0, 1.0))));
    if (data.views.size() >= 4) {
        const auto p = predict(data, used, freedom, solution);
        report.hold_out.folds = p.folds;
        report.hold_out.left_out = p.left_out;
        report.hold_out.rms_px = std::sqrt(p.mean);
        report.hold_out.rms_mm = std::sqrt(p.square_mm);
        report.hold_out.max_mm = p.max_mm;
    }
    report.judgement = judge(result, data.views.size(), plate_hint(doubt), bent, bends);
    if (report.judgement.verdict == Verdict::undetermined) report.covariance.resize(0, 0);
    return result;
}

}  // namespace seamwright
