#include "core/calibration/stripe/laser_plane_camera.h"
#include "core/acceptance/distributions.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "core/calibration/f_test.h"

namespace seamwright {
namespace {

using Freed = Eigen::Matrix<double, 10, 1>;  // pose (tangent), focal lengths (share), centre (px), k1
constexpr Eigen::Index kFreed = 4;
constexpr double kRounding_px = 1e-3;  // of a pattern

CameraModel freed_camera(CameraModel camera, const Freed& by) {
    camera.fx *= 1 + by(6);
    camera.fy *= 1 + by(6);
    camera.cx += by(7);
    camera.cy += by(8);
    camera.k1 += by(9);
    return camera;
}

Eigen::VectorXd misses(const CameraModel& camera, const Pose& pose, const Freed& by,
                       const CameraPoints& view) {
    const CameraModel freed = freed_camera(camera, by);
    const Pose at = retract(pose, by.head<6>());
    Eigen::VectorXd r(2 * static_cast<Eigen::Index>(view.pixel.size()));
    for (std::size_t i = 0; i < view.pixel.size(); ++i)
        r.segment<2>(2 * static_cast<Eigen::Index>(i)) =
            freed.project(at * view.object_mm[i]) - view.pixel[i];
    return r;
}

}  // namespace

CameraDoubt doubt_of_camera(const CameraModel& camera, const Pose& pose, const CameraPoints& view,
                            double squares_px2) {
    CameraDoubt doubt;
    const auto n = static_cast<double>(view.pixel.size());
    const double freedom = 2 * n - static_cast<double>(Freed::RowsAtCompileTime);
    if (!(freedom > 0)) return doubt;
    const double sigma = std::max(std::sqrt(squares_px2 / (2 * n - 6)), kRounding_px);
    constexpr double kFocal = 0.05, kCentre = 0.03, kBending = 0.3;
    const double centre = kCentre * std::max(camera.width > 0 ? camera.width : 2 * camera.cx, 1.0);
    const Eigen::Vector4d held = sigma * Eigen::Vector4d(kFocal, centre, centre, kBending).cwiseInverse();
    Freed step;
    step << 1e-3, 1e-3, 1e-3, 1e-6, 1e-6, 1e-6, 1e-6, 1e-2, 1e-2, 1e-5;
    Freed by = Freed::Zero();
    double least = squares_px2, cost = squares_px2;
    for (int round = 0; round < 4; ++round) {
        const Eigen::VectorXd r = misses(camera, pose, by, view);
        const Eigen::Index rows = r.size();
        Eigen::MatrixXd a = Eigen::MatrixXd::Zero(rows + kFreed, step.size());
        for (Eigen::Index k = 0; k < step.size(); ++k) {
            Freed up = by, down = by;
            up(k) += step(k), down(k) -= step(k);
            a.col(k).head(rows) =
                (misses(camera, pose, up, view) - misses(camera, pose, down, view)) / (2 * step(k));
        }
        a.bottomRightCorner<kFreed, kFreed>() = held.asDiagonal();
        Eigen::VectorXd right(rows + kFreed);
        right << r, held.cwiseProduct(by.tail<kFreed>());
        if (!a.allFinite() || !right.allFinite()) break;
        const Eigen::VectorXd scale = a.colwise().norm().transpose().cwiseMax(1e-12);
        const Eigen::VectorXd back =
            Eigen::MatrixXd(a * scale.cwiseInverse().asDiagonal()).colPivHouseholderQr().solve(right);
        const Freed next = by - back.cwiseQuotient(scale);
        const double squares = misses(camera, pose, next, view).squaredNorm();
        const double total = squares + held.cwiseProduct(next.tail<kFreed>()).squaredNorm();
        if (!(total < cost)) break;
        by = next, least = squares, cost = total;
    }
    doubt.pattern_px = std::sqrt(std::max(0.0, squares_px2 - least) / n);
    // A camera without any distortion is more often a camera whose distortion was left out.
    constexpr double kOfBare = 0.005;
    const bool bare = camera.k1 == 0 && camera.k2 == 0 && camera.k3 == 0 && camera.p1 == 0 && camera.p2 == 0;
    doubt.tells = doubt.pattern_px > kRounding_px &&
                  freed_chance(squares_px2, least, static_cast<double>(kFreed), freedom) <
                      (bare ? kOfBare : kNoAccident);
    doubt.moves = by.head<6>();
    return doubt;
}

std::optional<double> fits_swapped(const CameraModel& camera, const CameraPoints& view, double squares_px2) {
    CameraPoints swapped = view;
    for (Eigen::Vector2d& p : swapped.pixel) p = p.reverse().eval();
    const auto solved = locate_target(camera, swapped);
    if (!solved) return std::nullopt;
    const auto n = static_cast<double>(view.pixel.size());
    const double squares = n * solved->rms_px * solved->rms_px, freedom = 2 * n - 6;
    if (!(freedom > 0) || !(squares < squares_px2)) return std::nullopt;
    if (squares > 0 && std::isfinite(squares_px2) &&
        !(f_upper(freedom, freedom, squares_px2 / squares) < kNoAccident))
        return std::nullopt;
    return solved->rms_px;
}

}  // namespace seamwright
