#include "core/calibration/camera/plate_bends.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "core/acceptance/distributions.h"
#include "core/calibration/camera/plate_corners.h"
#include "core/calibration/f_test.h"

namespace seamwright {
namespace {

using Shapes = Eigen::Matrix<double, 5, 5>;

struct View {
    ShapeNumbers bent = ShapeNumbers::Zero();
    Shapes covariance = Shapes::Zero();
    Eigen::Matrix<double, 9, 5> camera_by_bent = Eigen::Matrix<double, 9, 5>::Zero();
    double freedom = 0;
};

// The intrinsics' derivatives by differences, as those of pose and shape.
Eigen::MatrixXd by_intrinsics(const CameraPoints& view, const Intrinsics& k, const Pose& pose,
                              const PlateShape& shape, const Eigen::MatrixXd& basis) {
    Eigen::MatrixXd j(2 * static_cast<Eigen::Index>(view.pixel.size()), 9);
    for (Eigen::Index i = 0; i < 9; ++i) {
        const double step = i < 4 ? 1e-2 : 1e-6;
        const Intrinsics by = step * Intrinsics::Unit(i);
        j.col(i) = (corner_misses(k + by, pose, shape, shape.numbers(), view) -
                    corner_misses(k - by, pose, shape, shape.numbers(), view)) /
                   (2 * step);
    }
    return j * basis;
}

std::optional<View> shape_of(const CameraPoints& view, const CameraSolution& solution, const Pose& pose,
                             const PlateShape& shape, const Eigen::MatrixXd& unit) {
    const Eigen::MatrixXd j = by_pose_and_shape(solution.intrinsics, pose, shape, view);
    const Eigen::VectorXd r = corner_misses(solution.intrinsics, pose, shape, shape.numbers(), view);
    const Eigen::MatrixXd c = by_intrinsics(view, solution.intrinsics, pose, shape, solution.basis);
    const Eigen::Index unknowns = j.cols(), rows = r.size();
    if (!j.allFinite() || !r.allFinite() || !c.allFinite() || rows < 3 * unknowns) return std::nullopt;
    // What the pose does not take up.
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(j.leftCols(kPoseNumbers));
    const Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(rows, kPoseNumbers);
    const auto rest = [&](const Eigen::MatrixXd& a) -> Eigen::MatrixXd {
        return a - q * (q.transpose() * a);
    };
    const Eigen::MatrixXd s = rest(j.rightCols(kShapeNumbers));
    const Eigen::LDLT<Shapes> normal(Shapes(s.transpose() * s));
    if (normal.info() != Eigen::Success || !(normal.vectorD().minCoeff() > 0)) return std::nullopt;
    View out;
    const Eigen::VectorXd left = rest(r);
    out.bent = normal.solve(s.transpose() * left);
    const Eigen::VectorXd noise = left - s * out.bent;
    out.freedom = static_cast<double>(rows - unknowns);
    const Eigen::MatrixXd scores = noise.asDiagonal() * s;
    out.covariance = normal.solve(normal.solve(Shapes(scores.transpose() * scores)).transpose()) *
                     (static_cast<double>(rows) / out.freedom);
    out.camera_by_bent = solution.basis * (unit * (c.transpose() * s));
    return out;
}

}  // namespace

PlateBends bends_of_plate(const CameraData& data, const std::vector<std::vector<char>>& used,
                          const CameraSolution& solution, const Eigen::MatrixXd& unit) {
    constexpr double kRounding_mm = 1e-6;
    PlateBends out;
    if (data.views.size() < 5 || !given_flat(data) || unit.size() == 0) return out;
    const PlateShape shape = shape_over(data);
    std::vector<View> views;
    double freedom = 0;
    for (std::size_t i = 0; i < data.views.size(); ++i)
        if (auto view = shape_of(chosen(data.views[i], used[i]), solution, solution.camera_from_target[i],
                                 shape, unit)) {
            freedom += view->freedom;
            views.push_back(std::move(*view));
        }
    const double n = static_cast<double>(views.size());
    if (views.size() < 5) return out;
    ShapeNumbers scatter2 = ShapeNumbers::Zero();
    for (Eigen::Index k = 0; k < kShapeNumbers; ++k) {
        double weights = 0, mean = 0;
        for (const View& v : views) weights += 1 / v.covariance(k, k), mean += v.bent(k) / v.covariance(k, k);
        mean /= weights;
        double squares = 0, excess = 0;
        for (const View& v : views) {
            const double off2 = std::pow(v.bent(k) - mean, 2);
            squares += off2 / v.covariance(k, k);
            excess += (off2 - v.covariance(k, k)) / (n - 1);
        }
        // Any of the five numbers; a variance by one view's corners is known to a tenth or so.
        const double chance =
            static_cast<double>(kShapeNumbers) * f_upper(n - 1, freedom / n, squares / (n - 1));
        if (chance < kNoAccident && excess > kRounding_mm * kRounding_mm) scatter2(k) = excess;
    }
    out.tells = scatter2.tail<3>().maxCoeff() > 0;
    out.bow_mm = std::sqrt(scatter2.tail<3>().maxCoeff());
    for (const View& v : views)
        out.covariance += v.camera_by_bent * scatter2.asDiagonal() * v.camera_by_bent.transpose();
    return out;
}

}  // namespace seamwright
