#include "projects/calibrate/stripe_line_points.h"

#include <algorithm>

#include "core/geometry/decompositions.h"
#include "core/profile/filter.h"

namespace seamwright {

Expected<std::vector<Eigen::Vector2d>> stripe_points(const StripeImage& image, StripePeaks& peaks) {
    if (auto found = find_peaks(image, {}, peaks); !found) return tl::unexpected(found.error());
    ProfileCandidates candidates;
    candidates.lines = peaks.lines;
    candidates.per_line = peaks.per_line;
    candidates.count = peaks.count;
    candidates.intensity = peaks.intensity;
    candidates.z_mm.assign(peaks.position_px.begin(),
                           peaks.position_px.end());  // the model has no unit: 1 px stands for 1 mm
    candidates.x_mm.resize(candidates.z_mm.size());
    for (int line = 0; line < peaks.lines; ++line)
        for (int k = 0; k < peaks.per_line; ++k)
            candidates.x_mm[static_cast<std::size_t>(peaks.index(line, k))] = line;
    Profile stripe;
    if (auto tracked = track_stripe(candidates, {}, stripe); !tracked) return tl::unexpected(tracked.error());
    std::vector<Eigen::Vector2d> points;
    for (std::size_t i = 0; i < stripe.size(); ++i)
        if (stripe.segment[i] != kOutlier) points.emplace_back(stripe.x_mm[i], stripe.z_mm[i]);
    return points;
}

std::vector<Eigen::Vector2d> on_the_plate(std::vector<Eigen::Vector2d> points) {
    for (int round = 0; round < 4 && points.size() > 20; ++round) {
        Eigen::MatrixXd a(points.size(), 3);
        Eigen::VectorXd v(points.size());
        for (Eigen::Index i = 0; i < v.size(); ++i) {
            const Eigen::Vector2d& p = points[static_cast<std::size_t>(i)];
            const double u = p.x() / 1000;
            a.row(i) << 1, u, u * u;
            v(i) = p.y();
        }
        const Eigen::VectorXd off = (v - a * least_squares(a, v).x).cwiseAbs();
        std::vector<double> sorted(off.begin(), off.end());
        std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                         sorted.end());
        const double limit = std::max(1.0, 6 * sorted[sorted.size() / 2]);
        std::vector<Eigen::Vector2d> kept;
        for (Eigen::Index i = 0; i < v.size(); ++i)
            if (off(i) <= limit) kept.push_back(points[static_cast<std::size_t>(i)]);
        points = std::move(kept);
    }
    return points;
}

}  // namespace seamwright
