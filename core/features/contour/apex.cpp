#include "core/features/contour/apex.h"

#include <algorithm>
#include <cmath>

#include "core/features/contour/line_fit.h"
#include "core/features/contour/reduce_contour.h"

namespace seamwright {
namespace {

constexpr double kBendShare = 0.006;  // of the extent: what departs less is straight
constexpr double kFlankShare = 0.05;  // of the extent: the least length of a flank
constexpr double kReachShare = 0.15;  // of the extent: beyond it a lens bends a straight flank
constexpr double kEndShare = 0.12;    // of a flank that is left out at both of its ends
constexpr double kLeastAngle = 0.35, kLargestAngle = 2.27;  // rad
constexpr std::size_t kLeastPoints = 40;

}  // namespace

std::optional<Apex> find_apex(const std::vector<Eigen::Vector2d>& points) {
    if (points.size() < kLeastPoints) return std::nullopt;
    std::vector<double> x, z;
    Eigen::Vector2d low = points.front(), high = low;
    for (const auto& p : points) {
        if (!p.allFinite()) continue;
        x.push_back(p.x());
        z.push_back(p.y());
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    const double extent = (high - low).norm();
    if (x.size() < kLeastPoints || !(extent > 0)) return std::nullopt;
    std::vector<int> bends;
    reduce_contour(x, z, kBendShare * extent, bends);
    const auto at = [&](int i) {
        return Eigen::Vector2d(x[static_cast<std::size_t>(i)], z[static_cast<std::size_t>(i)]);
    };
    int apex = -1;
    double sharpest = kLargestAngle;
    for (std::size_t k = 1; k + 1 < bends.size(); ++k) {
        const Eigen::Vector2d a = at(bends[k - 1]) - at(bends[k]), b = at(bends[k + 1]) - at(bends[k]);
        if (std::min(a.norm(), b.norm()) < kFlankShare * extent) continue;
        const double angle = std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0));
        if (angle > kLeastAngle && angle < sharpest) {
            sharpest = angle;
            apex = static_cast<int>(k);
        }
    }
    if (apex < 0) return std::nullopt;
    const auto middle = static_cast<std::size_t>(apex);
    LineWorkspace workspace;
    const auto flank = [&](int from, int to, bool apex_first) {
        const Eigen::Vector2d tip = at(bends[middle]);
        const double length = (at(apex_first ? to : from) - tip).norm();
        const double reach = std::min(length * (1 - kEndShare), kReachShare * extent);
        std::vector<double> fx, fz;
        for (int i = from; i <= to; ++i) {
            const double d = (at(i) - tip).norm();
            if (d < kEndShare * std::min(length, reach) || d > reach) continue;
            fx.push_back(x[static_cast<std::size_t>(i)]);
            fz.push_back(z[static_cast<std::size_t>(i)]);
        }
        return fit_line(fx, fz, workspace);
    };
    const LineFit left = flank(bends[middle - 1], bends[middle], false),
                  right = flank(bends[middle], bends[middle + 1], true);
    if (!left.ok || !right.ok || left.used < 8 || right.used < 8) return std::nullopt;
    const double cross = left.direction.x() * right.direction.y() - left.direction.y() * right.direction.x();
    if (std::abs(cross) < std::sin(kLeastAngle)) return std::nullopt;
    const Eigen::Vector2d between = right.centre - left.centre;
    const double along = (between.x() * right.direction.y() - between.y() * right.direction.x()) / cross;
    Apex found;
    found.point = left.centre + along * left.direction;
    // The lines must meet where the contour bends.
    if ((found.point - at(bends[middle])).norm() > kFlankShare * extent) return std::nullopt;
    found.left = at(bends[middle - 1]);
    found.right = at(bends[middle + 1]);
    found.angle_rad = sharpest;
    found.rms = std::sqrt((left.used * left.rms_mm * left.rms_mm + right.used * right.rms_mm * right.rms_mm) /
                          (left.used + right.used));
    if (found.rms > kBendShare * extent) return std::nullopt;
    const double on_right = (found.point - right.centre).dot(right.direction);
    found.sigma = std::sqrt(left.variance_at(along) + right.variance_at(on_right)) / std::abs(cross);
    return found;
}

}  // namespace seamwright
