#include "core/correction/unseen_course.h"

#include <algorithm>
#include <cmath>

#include "core/numbers.h"

namespace seamwright::correction {

UnseenCourse unseen_course(const RegionSystem& system, const RegionSystem::Fit& fit, const Spread& spread,
                           std::span<const double> factor, std::span<const double> slide_mm,
                           const Agreement& all) {
    constexpr double kUnusual = 0.01, kSteepest_deg = 3.5;
    UnseenCourse out;
    const double beyond = all.sum_squares - all.redundancy;
    if (all.redundancy <= 0 || !spread.regular || !system.weights_are_binary() ||
        !(beyond * beyond > 2.0 * all.redundancy) || beyond < 0 ||
        chi_square_p(all.sum_squares, all.redundancy) >= kUnusual)
        return out;
    double told = 0;
    Matrix6 meat = Matrix6::Zero();
    Eigen::Vector3d e;
    Rows rows;
    for (std::size_t n = 0; n < system.size(); ++n) {
        if (!(factor[n] > 0) || !(slide_mm[n] > kNoticedSlide_mm)) continue;
        system.cleared(n, fit, e, rows);
        const PreparedSpot& s = system.spot(n);
        const double v = 1 / (s.sigma * s.sigma);
        const Eigen::Matrix3d unfold = s.shape.inverse();
        Eigen::Matrix3d slid = slide_mm[n] * slide_mm[n] * unfold * unfold.transpose();
        Eigen::Matrix3d kept_share =
            Eigen::Matrix3d::Identity() - v * (rows * spread.bread * rows.transpose() + system.left(n, fit));
        for (int i = 0; i < 3; ++i) {
            if (s.weights[i] > 0) continue;
            slid.row(i).setZero();
            slid.col(i).setZero();
        }
        told += v * (kept_share * slid).trace();
        const Eigen::Matrix<double, 6, 3> gain = rows.transpose() * s.weights.cwiseAbs2().asDiagonal() * v;
        meat += gain * slid * gain.transpose();
    }
    if (!(told > 0)) return out;
    out.slope = std::min(std::sqrt(beyond / told), rad_from_deg(kSteepest_deg));
    out.added = out.slope * out.slope * spread.bread * meat * spread.bread;
    return out;
}

}  // namespace seamwright::correction
