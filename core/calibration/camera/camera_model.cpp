// Projection with derivatives, homography, closed-form start and refinement: the numbers below
// calibrate_camera.

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "core/calibration/camera/camera_costs.h"
#include "core/calibration/camera/camera_limits.h"
#include "core/calibration/camera/projection.h"
#include "core/geometry/decompositions.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

// Similarity that brings points to mean 0 and mean distance sqrt(2): conditions the DLT.
Eigen::Matrix3d normaliser(const std::vector<Eigen::Vector2d>& points) {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const auto& p : points) mean += p;
    mean /= static_cast<double>(points.size());
    double distance = 0;
    for (const auto& p : points) distance += (p - mean).norm();
    distance /= static_cast<double>(points.size());
    const double s = distance > 0 ? std::sqrt(2.0) / distance : 1;
    Eigen::Matrix3d t;
    t << s, 0, -s * mean.x(), 0, s, -s * mean.y(), 0, 0, 1;
    return t;
}

// Frame of the points' best plane: centre, axes (columns, last = normal) and extents along them, largest
// first.
struct PointFrame {
    Eigen::Vector3d centre;
    Eigen::Matrix3d axes;
    Eigen::Vector3d extent;
};

PointFrame frame_of(const std::vector<Eigen::Vector3d>& points) {
    PointFrame f;
    f.centre.setZero();
    for (const auto& p : points) f.centre += p;
    f.centre /= static_cast<double>(points.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const auto& p : points) scatter += (p - f.centre) * (p - f.centre).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scatter / static_cast<double>(points.size()));
    f.axes.col(0) = eigen.eigenvectors().col(2);
    f.axes.col(1) = eigen.eigenvectors().col(1);
    f.axes.col(2) = f.axes.col(0).cross(f.axes.col(1));
    f.extent = eigen.eigenvalues().reverse().cwiseMax(0).cwiseSqrt();
    return f;
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& m) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d d(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant());
    return svd.matrixU() * d.asDiagonal() * svd.matrixV().transpose();
}

// Pose of plate from a homography of normalised image coordinates.
std::optional<Pose> pose_from_homography(Eigen::Matrix3d h) {
    const double scale = 0.5 * (h.col(0).norm() + h.col(1).norm());
    if (!(scale > 0) || !h.allFinite()) return std::nullopt;
    h /= scale;
    if (h(2, 2) < 0) h = -h;
    Eigen::Matrix3d r;
    r.col(0) = h.col(0);
    r.col(1) = h.col(1);
    r.col(2) = h.col(0).cross(h.col(1));
    constexpr double kEdgeOn = 1e-12;  // of two unit axes' cross product squared: less is no plane
    if (!(r.determinant() > kEdgeOn)) return std::nullopt;
    return make_pose(nearest_rotation(r), h.col(2));
}

// Normalised (x/z, y/z) of every pixel.
std::vector<Eigen::Vector2d> normalised(const CameraModel& camera, const CameraPoints& view) {
    std::vector<Eigen::Vector2d> out;
    out.reserve(view.pixel.size());
    for (const auto& p : view.pixel) out.push_back(camera.undistort(p));
    return out;
}

std::optional<Pose> body_pose(const std::vector<Eigen::Vector3d>& object,
                              const std::vector<Eigen::Vector2d>& image) {
    // DLT of [R | t] on centred, scaled body points.
    const PointFrame f = frame_of(object);
    const double scale = 1 / f.extent.norm();
    Eigen::MatrixXd ata = Eigen::MatrixXd::Zero(12, 12);
    for (std::size_t i = 0; i < object.size(); ++i) {
        const Eigen::Vector4d x = (scale * (object[i] - f.centre)).homogeneous();
        Eigen::Matrix<double, 2, 12> a = Eigen::Matrix<double, 2, 12>::Zero();
        a.block<1, 4>(0, 0) = x.transpose();
        a.block<1, 4>(0, 8) = -image[i].x() * x.transpose();
        a.block<1, 4>(1, 4) = x.transpose();
        a.block<1, 4>(1, 8) = -image[i].y() * x.transpose();
        for (Eigen::Index k = 0; k < 2; ++k)
            ata.selfadjointView<Eigen::Lower>().rankUpdate(a.row(k).transpose());
    }
    const SymmetricEigen eigen = symmetric_eigen(ata);
    if (!eigen.converged) return std::nullopt;
    const Eigen::VectorXd p = eigen.vectors.col(0);
    Eigen::Matrix<double, 3, 4> m;
    m << p.segment<4>(0).transpose(), p.segment<4>(4).transpose(), p.segment<4>(8).transpose();
    if (m(2, 3) < 0) m = -m;
    const Eigen::Matrix3d r = m.leftCols<3>();
    const double s = r.norm() / std::sqrt(3.0);
    if (!(s > 0) || !(r.determinant() > 0)) return std::nullopt;
    const Eigen::Matrix3d rotation = nearest_rotation(r);
    return make_pose(rotation, m.col(3) / s / scale - rotation * f.centre);
}

// Best of the closed-form pose and its mirror (the two poses of a plate that look alike from afar).
std::optional<Pose> plate_or_body_pose(const Intrinsics& k, const CameraPoints& view, int width, int height,
                                       Matrix6* information, double* cost) {
    const CameraModel camera = camera_of(k, width, height);
    const auto image = normalised(camera, view);
    for (const auto& p : image)
        if (!p.allFinite()) return std::nullopt;
    const PointFrame f = frame_of(view.object_mm);
    constexpr double kNoPlane = 1e-6;    // of the length: narrower points span no plane
    constexpr double kLeastDeep = 0.02;  // of the width: flatter points are no body to the linear solution
    constexpr double kMostDeep = 0.3;    // of the width: deeper ones no plate to the homography
    if (!(f.extent(1) > kNoPlane * f.extent(0))) return std::nullopt;
    std::vector<Pose> starts;
    if (f.extent(2) > kLeastDeep * f.extent(1) && view.pixel.size() >= 6)
        if (const auto pose = body_pose(view.object_mm, image)) starts.push_back(*pose);
    if (f.extent(2) < kMostDeep * f.extent(1) || starts.empty()) {
        std::vector<Eigen::Vector2d> flat;
        for (const auto& p : view.object_mm) flat.push_back((f.axes.transpose() * (p - f.centre)).head<2>());
        if (const auto h = homography_dlt(flat, image))
            if (const auto pose = pose_from_homography(*h)) {
                const Pose target_from_flat = make_pose(f.axes, f.centre);
                starts.push_back(*pose * target_from_flat.inverse());
                const Eigen::Vector3d sight = pose->translation().normalized();
                Pose mirror = *pose;
                mirror.linear() = Eigen::AngleAxisd(kPi, sight).toRotationMatrix() * pose->linear() *
                                  Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitZ()).toRotationMatrix();
                starts.push_back(mirror * target_from_flat.inverse());
            }
    }
    std::optional<Pose> best;
    double best_cost = kInfinity;
    for (Pose pose : starts) {
        std::vector<camera_costs::Corner> corners;
        for (std::size_t i = 0; i < view.pixel.size(); ++i)
            corners.push_back({view.object_mm[i], view.pixel[i]});
        const auto fit = camera_costs::solve_pose({{k, Pose::Identity(), std::move(corners)}}, pose);
        if (fit.cost < best_cost) {
            best_cost = fit.cost;
            best = pose;
            if (information) *information = fit.information;
        }
    }
    if (cost) *cost = best_cost;
    return best;
}

}  // namespace

Intrinsics intrinsics_of(const CameraModel& c) {
    Intrinsics k;
    k << c.fx, c.fy, c.cx, c.cy, c.k1, c.k2, c.p1, c.p2, c.k3;
    return k;
}

CameraModel camera_of(const Intrinsics& k, int width, int height) {
    CameraModel c;
    c.fx = k(0), c.fy = k(1), c.cx = k(2), c.cy = k(3), c.k1 = k(4), c.k2 = k(5), c.p1 = k(6), c.p2 = k(7),
    c.k3 = k(8);
    c.width = width, c.height = height;
    return c;
}

Eigen::MatrixXd freedom_basis(const CameraFreedom& freedom) {
    std::vector<Intrinsics> columns;
    if (freedom.two_focals) {
        columns.push_back(Intrinsics::Unit(0));
        columns.push_back(Intrinsics::Unit(1));
    } else {
        columns.push_back(Intrinsics::Unit(0) + Intrinsics::Unit(1));
    }
    if (freedom.centre) {
        columns.push_back(Intrinsics::Unit(2));
        columns.push_back(Intrinsics::Unit(3));
    }
    if (freedom.radial >= 1) columns.push_back(Intrinsics::Unit(4));
    if (freedom.radial >= 2) columns.push_back(Intrinsics::Unit(5));
    if (freedom.tangential) {
        columns.push_back(Intrinsics::Unit(6));
        columns.push_back(Intrinsics::Unit(7));
    }
    if (freedom.radial >= 3) columns.push_back(Intrinsics::Unit(8));
    Eigen::MatrixXd basis(9, static_cast<Eigen::Index>(columns.size()));
    for (std::size_t i = 0; i < columns.size(); ++i) basis.col(static_cast<Eigen::Index>(i)) = columns[i];
    return basis;
}

HeldIntrinsics held_intrinsics(const CameraFreedom& freedom, double focal_px, int width) {
    // How cameras are built (camera.h).
    constexpr double kFocalHeld = 0.001, kCentreHeld = 0.03;  // of the focal length, of the width
    constexpr double kK1Held = 0.3, kK2Held = 0.2, kK3Held = 0.1, kTangentialHeld = 0.002;
    std::vector<std::pair<Intrinsics, double>> held;
    if (!freedom.two_focals)
        held.emplace_back(Intrinsics::Unit(0) - Intrinsics::Unit(1), kFocalHeld * focal_px);
    if (!freedom.centre)
        for (const int i : {2, 3}) held.emplace_back(Intrinsics::Unit(i), kCentreHeld * width);
    if (freedom.radial < 1) held.emplace_back(Intrinsics::Unit(4), kK1Held);
    if (freedom.radial < 2) held.emplace_back(Intrinsics::Unit(5), kK2Held);
    if (freedom.radial < 3) held.emplace_back(Intrinsics::Unit(8), kK3Held);
    if (!freedom.tangential)
        for (const int i : {6, 7}) held.emplace_back(Intrinsics::Unit(i), kTangentialHeld);
    HeldIntrinsics out;
    const auto n = static_cast<Eigen::Index>(held.size());
    out.directions.resize(9, n);
    out.sigma.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        out.directions.col(i) = held[static_cast<std::size_t>(i)].first;
        out.sigma(i) = held[static_cast<std::size_t>(i)].second;
    }
    return out;
}

Intrinsics conform(const Intrinsics& k, const CameraFreedom& freedom, int width, int height) {
    Intrinsics out = k;
    if (!freedom.two_focals) out(0) = out(1) = 0.5 * (k(0) + k(1));
    if (!freedom.centre) out.segment<2>(2) << 0.5 * (width - 1), 0.5 * (height - 1);
    if (freedom.radial < 1) out(4) = 0;
    if (freedom.radial < 2) out(5) = 0;
    if (freedom.radial < 3) out(8) = 0;
    if (!freedom.tangential) out(6) = out(7) = 0;
    return out;
}

CameraPoints chosen(const CameraPoints& view, const std::vector<char>& used) {
    if (used.empty()) return view;
    CameraPoints out;
    out.id = view.id;
    for (std::size_t i = 0; i < view.pixel.size(); ++i)
        if (used[i]) {
            out.object_mm.push_back(view.object_mm[i]);
            out.pixel.push_back(view.pixel[i]);
        }
    return out;
}

double squares_px2(const Intrinsics& k, const Pose& pose, const CameraPoints& view) {
    double sum = 0;
    for (std::size_t i = 0; i < view.pixel.size(); ++i) {
        const Eigen::Vector3d point = pose * view.object_mm[i];
        if (!(point.z() > camera_costs::kLeastDepth_mm)) return kInfinity;
        sum += (pixel_of_ray(k.data(), point.x() / point.z(), point.y() / point.z()) - view.pixel[i])
                   .squaredNorm();
    }
    return std::isfinite(sum) ? sum : kInfinity;
}

std::optional<Eigen::Matrix3d> homography_dlt(const std::vector<Eigen::Vector2d>& from,
                                              const std::vector<Eigen::Vector2d>& to) {
    if (from.size() < 4 || from.size() != to.size()) return std::nullopt;
    const Eigen::Matrix3d a = normaliser(from), b = normaliser(to);
    Eigen::MatrixXd ata = Eigen::MatrixXd::Zero(9, 9);
    for (std::size_t i = 0; i < from.size(); ++i) {
        const Eigen::Vector3d p = a * from[i].homogeneous(), q = b * to[i].homogeneous();
        Eigen::Matrix<double, 2, 9> row = Eigen::Matrix<double, 2, 9>::Zero();
        row.block<1, 3>(0, 0) = p.transpose();
        row.block<1, 3>(0, 6) = -q.x() * p.transpose();
        row.block<1, 3>(1, 3) = p.transpose();
        row.block<1, 3>(1, 6) = -q.y() * p.transpose();
        for (Eigen::Index k = 0; k < 2; ++k)
            ata.selfadjointView<Eigen::Lower>().rankUpdate(row.row(k).transpose());
    }
    constexpr double kAsGood = 1e-12;  // of the largest eigenvalue
    // The answer of a DLT is what the matrix maps to least; none when a second direction is as good.
    const SymmetricEigen eigen = symmetric_eigen(ata);
    if (!eigen.converged || !(eigen.values(1) > kAsGood * eigen.values(8))) return std::nullopt;
    const Eigen::VectorXd v = eigen.vectors.col(0);
    Eigen::Matrix3d h;
    h << v.segment<3>(0).transpose(), v.segment<3>(3).transpose(), v.segment<3>(6).transpose();
    h = b.inverse() * h * a;
    if (!h.allFinite()) return std::nullopt;
    return h;
}

namespace {

// Focal lengths from plate homographies with the centre given: h1' B h2 = 0 and h1' B h1 = h2' B h2 for
// B = diag(1/fx^2, 1/fy^2, 1). One focal length.
std::optional<double> focal_from_homographies(const std::vector<Eigen::Matrix3d>& homographies, double cx,
                                              double cy, double unit) {
    double num = 0, den = 0;
    for (Eigen::Matrix3d h : homographies) {
        h.row(0) -= cx * h.row(2);
        h.row(1) -= cy * h.row(2);
        h.topRows<2>() /= unit;
        h /= h.leftCols<2>().norm();
        const Eigen::Vector3d a = h.col(0), b = h.col(1);
        const double left[2] = {a.x() * b.x() + a.y() * b.y(),
                                a.x() * a.x() + a.y() * a.y() - b.x() * b.x() - b.y() * b.y()};
        const double right[2] = {-a.z() * b.z(), -(a.z() * a.z() - b.z() * b.z())};
        for (int i = 0; i < 2; ++i) {
            num += left[i] * right[i];
            den += left[i] * left[i];
        }
    }
    const double inverse_square = num / den;
    if (!(inverse_square > 0) || !std::isfinite(inverse_square)) return std::nullopt;
    return unit / std::sqrt(inverse_square);
}

}  // namespace

std::optional<CameraSolution> start_camera(const CameraData& data) {
    const double cx = 0.5 * (data.width - 1), cy = 0.5 * (data.height - 1),
                 unit = std::max(data.width, data.height);
    constexpr double kFlatView = 0.1;  // of its width: deeper points are no plate to a homography
    // In longer sides of the image: focal lengths that homographies may say, and those tried beside.
    constexpr double kShortestFocal = 0.1, kLongestFocal = 50;
    constexpr std::array kFocalTrials{0.6, 1.0, 1.7, 3.0, 6.0};
    constexpr double kExplained_px2 = 25.0;  // a point
    std::vector<double> candidates;
    std::vector<Eigen::Matrix3d> homographies;
    for (const auto& view : data.views) {
        const PointFrame f = frame_of(view.object_mm);
        if (f.extent(2) > kFlatView * f.extent(1)) continue;
        std::vector<Eigen::Vector2d> flat;
        for (const auto& p : view.object_mm) flat.push_back((f.axes.transpose() * (p - f.centre)).head<2>());
        if (const auto h = homography_dlt(flat, view.pixel)) homographies.push_back(*h);
    }
    if (!homographies.empty())
        if (const auto f = focal_from_homographies(homographies, cx, cy, unit))
            if (*f > kShortestFocal * unit && *f < kLongestFocal * unit) candidates.push_back(*f);
    for (const double factor : kFocalTrials) candidates.push_back(factor * unit);

    // Cheap trial of each candidate: poses under it, then a refinement of f alone; the best goes on.
    std::optional<CameraSolution> best;
    const CameraFreedom only_focal{false, false, 1, false};
    for (std::size_t c = 0; c < candidates.size(); ++c) {
        CameraSolution s;
        s.intrinsics << candidates[c], candidates[c], cx, cy, 0, 0, 0, 0, 0;
        bool complete = true;
        for (const auto& view : data.views) {
            const auto pose =
                plate_or_body_pose(s.intrinsics, view, data.width, data.height, nullptr, nullptr);
            if (!pose) {
                complete = false;
                break;
            }
            s.camera_from_target.push_back(*pose);
        }
        if (!complete) continue;
        CameraSolution refined = refine_camera(data, {}, only_focal, s);
        if (!std::isfinite(refined.cost) || refined.cost <= 0) continue;
        if (!best || refined.cost < best->cost) best = refined;
        // A start of the homographies that explains the data to a few pixels needs no rivals.
        if (c == 0 && candidates.size() > kFocalTrials.size() &&
            best->cost < kExplained_px2 * static_cast<double>(best->points))
            break;
    }
    return best;
}

Expected<TargetPose> locate_target(const CameraModel& camera, const CameraPoints& view) {
    if (view.pixel.size() != view.object_mm.size() || view.pixel.size() < 4)
        return input_error("a pose needs at least 4 points, each with a pixel", view.id, "give more points");
    for (std::size_t i = 0; i < view.pixel.size(); ++i)
        if (!view.pixel[i].allFinite() || !view.object_mm[i].allFinite())
            return input_error(Text("point {} is not a finite number", std::to_string(i)), view.id,
                               "leave it out");
    const PointFrame f = frame_of(view.object_mm);
    if (!(f.extent(1) > kPointsOnALine * f.extent(0)))
        return input_error("the points lie on one line", view.id, "give points that span a plane");
    TargetPose out;
    Matrix6 information;
    double cost = 0;
    const auto pose =
        plate_or_body_pose(intrinsics_of(camera), view, camera.width, camera.height, &information, &cost);
    if (!pose || !std::isfinite(cost))
        return input_error("no pose of the target in front of the camera explains its points", view.id,
                           "check the order of the points and the camera");
    out.camera_from_target = *pose;
    const auto n = static_cast<double>(view.pixel.size());
    out.rms_px = std::sqrt(cost / n);
    const double variance = 2 * n > 6 ? cost / (2 * n - 6) : 0;
    out.covariance = variance * inverse_matrix(information);
    return out;
}

}  // namespace seamwright
