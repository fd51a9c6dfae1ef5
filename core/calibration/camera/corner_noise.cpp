#include "core/calibration/camera/corner_noise.h"

#include <Eigen/QR>
#include <cmath>

namespace seamwright::detail {

double corner_noise_px(const std::vector<CameraPoints>& views) {
    constexpr Eigen::Index kFewestForThird = 24, kFewestForFourth = 40;  // corners, by the polynomial's order
    double squares = 0, freedom = 0;
    for (const CameraPoints& view : views) {
        const auto n = static_cast<Eigen::Index>(view.pixel.size());
        if (n < kFewestForThird) continue;
        std::vector<Eigen::Vector2d> plate;
        Eigen::Vector2d low(1e300, 1e300), high(-1e300, -1e300);
        for (const auto& p : view.object_mm) {
            plate.push_back(p.head<2>());
            low = low.cwiseMin(plate.back());
            high = high.cwiseMax(plate.back());
        }
        const auto h = homography_dlt(plate, view.pixel);
        if (!h) continue;
        const int order = n >= kFewestForFourth ? 4 : 3;
        const Eigen::Index terms = (order + 1) * (order + 2) / 2;
        Eigen::MatrixXd a(n, terms), left(n, 2);
        for (Eigen::Index i = 0; i < n; ++i) {
            const Eigen::Vector2d& p = plate[static_cast<std::size_t>(i)];
            left.row(i) =
                (view.pixel[static_cast<std::size_t>(i)] - (*h * p.homogeneous()).hnormalized()).transpose();
            const Eigen::Vector2d q = (2 * p - low - high).cwiseQuotient(high - low);
            Eigen::Index term = 0;
            for (int x = 0; x <= order; ++x)
                for (int y = 0; x + y <= order; ++y) a(i, term++) = std::pow(q.x(), x) * std::pow(q.y(), y);
        }
        const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(a);
        const Eigen::MatrixXd rest = left - a * solver.solve(left);
        squares += rest.squaredNorm();
        freedom += 2 * static_cast<double>(n - solver.rank());
    }
    return freedom > 0 ? std::sqrt(squares / freedom) : 0;
}

}  // namespace seamwright::detail
