#include "core/calibration/field_scale.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/decompositions.h"

namespace seamwright {

FieldScale better_known(const FieldScale& a, const FieldScale& b) {
    const auto said = [](const FieldScale& s) { return !s.scale_sigma.isZero(0) || s.shear_sigma > 0; };
    if (!said(a) || (b.shown && !a.shown)) return b;
    if (!said(b) || (a.shown && !b.shown)) return a;
    return {a.scale_sigma.cwiseMin(b.scale_sigma), std::min(a.shear_sigma, b.shear_sigma), a.shown};
}

FieldScale field_scale(std::span<const Eigen::Vector2d> places, const Eigen::MatrixXd& covariance) {
    const auto n = static_cast<Eigen::Index>(places.size());
    if (n < 3 || covariance.rows() != 2 * n || covariance.cols() != 2 * n || !covariance.allFinite())
        return {};
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& p : places) middle += p / static_cast<double>(n);
    Eigen::MatrixXd linear(n, 3);  // of one coordinate's error: constant, by x, by z
    for (Eigen::Index i = 0; i < n; ++i)
        linear.row(i) << 1, (places[static_cast<std::size_t>(i)] - middle).transpose();
    const LeastSquares inverse = least_squares(linear, Eigen::MatrixXd::Identity(n, n));
    if (inverse.rank < 3) return {};
    Eigen::MatrixXd from(3, 2 * n);  // kappa_x, kappa_z, shear from the errors
    from.setZero();
    for (Eigen::Index i = 0; i < n; ++i) {
        from(0, 2 * i) = inverse.x(1, i);
        from(1, 2 * i + 1) = inverse.x(2, i);
        from(2, 2 * i) = inverse.x(2, i);
        from(2, 2 * i + 1) = inverse.x(1, i);  // a turn takes the same off one and puts it on the other
    }
    const Eigen::VectorXd variance = (from * covariance * from.transpose()).diagonal().cwiseMax(0);
    return {{std::sqrt(variance[0]), std::sqrt(variance[1])}, std::sqrt(variance[2]), false};
}

}  // namespace seamwright
