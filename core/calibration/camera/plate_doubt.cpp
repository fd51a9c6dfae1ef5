#include "core/calibration/camera/plate_doubt.h"
#include "core/acceptance/distributions.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "core/calibration/camera/plate_corners.h"
#include "core/calibration/f_test.h"

namespace seamwright {
namespace {

// Of r within the columns of a; how many of these are independent is added to `rank`.
double squares_within(Eigen::MatrixXd a, const Eigen::VectorXd& r, double sign, double& rank) {
    constexpr double kSame = 1e-6;  // of a column that others nearly say
    for (Eigen::Index k = 0; k < a.cols(); ++k) a.col(k) /= std::max(a.col(k).norm(), 1e-12);
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
    qr.setThreshold(kSame);
    qr.compute(a);
    rank += sign * static_cast<double>(qr.rank());
    return (qr.householderQ().transpose() * r).head(qr.rank()).squaredNorm();
}

// What a shape of its own would take off each view, per number (px^2).
double own_shapes_px2(const CameraData& data, const std::vector<std::vector<char>>& used,
                      const PlateBundleState& at, double& freedom) {
    double sum = 0;
    freedom = -static_cast<double>(kShapeNumbers);  // the common one is fitted
    const ShapeNumbers bent = at.shape.numbers();
    for (std::size_t i = 0; i < data.views.size(); ++i) {
        const CameraPoints view = chosen(data.views[i], used[i]);
        const Pose& pose = at.camera_from_target[i];
        const Eigen::VectorXd r = corner_misses(at.intrinsics, pose, at.shape, bent, view);
        const Eigen::MatrixXd j = by_pose_and_shape(at.intrinsics, pose, at.shape, view);
        if (!j.allFinite() || !r.allFinite()) continue;
        sum += squares_within(j, r, 1, freedom) - squares_within(j.leftCols(kPoseNumbers), r, -1, freedom);
    }
    return freedom > 0 ? std::max(0.0, sum) / freedom : 0;
}

}  // namespace

PlateDoubt doubt_of_plate(const CameraData& data, const std::vector<std::vector<char>>& used,
                          const CameraFreedom& freedom, bool exactly, double corner_sigma_px,
                          const CameraSolution& solution) {
    constexpr double kRounding_px = 1e-3;
    PlateDoubt doubt;
    if (data.views.size() < 5 || !given_flat(data) || !(corner_sigma_px > 0)) return doubt;
    PlateBundle p;
    p.data = &data;
    p.point_used = used;
    p.freedom = freedom;
    // A stretch and unequal focal lengths are told apart by views turned about the axis alone.
    p.freedom.two_focals = exactly && freedom.two_focals;
    p.hold_exactly = exactly;
    p.corner_sigma_px = std::max(corner_sigma_px, kRounding_px);
    p.shape = ShapeFreedom::bowed;
    PlateBundleState s;
    s.intrinsics = solution.intrinsics;
    s.camera_from_target = solution.camera_from_target;
    s.shape = shape_over(data);
    const auto fit = solve_plate_bundle(p, s);
    if (!fit.converged || !fit.covariance.size() || !(fit.corner_cost < solution.cost)) return doubt;
    const double left = 2.0 * static_cast<double>(solution.points) -
                        static_cast<double>(kPoseNumbers) * static_cast<double>(data.views.size()) -
                        static_cast<double>(freedom_basis(freedom).cols() + kShapeNumbers);
    if (!(left > 0)) return doubt;
    const double gain = solution.cost - fit.corner_cost, numbers = static_cast<double>(kShapeNumbers);
    double own_freedom = 0;
    const double own = own_shapes_px2(data, used, fit.state, own_freedom), noise = fit.corner_cost / left;
    const double chance = own > noise ? f_upper(numbers, own_freedom, gain / numbers / own)
                                      : freed_chance(solution.cost, fit.corner_cost, numbers, left);
    doubt.tells =
        chance < kNoAccident && gain > kRounding_px * kRounding_px * static_cast<double>(solution.points);
    doubt.shape = fit.state.shape;
    doubt.fall = gain / solution.cost;
    doubt.moves = fit.state.intrinsics - solution.intrinsics;
    return doubt;
}

}  // namespace seamwright
