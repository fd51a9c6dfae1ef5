#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/calibration/table/lookup_table_calibration.h"
#include "core/calibration/table/smooth_map.h"
#include "core/numbers.h"

namespace seamwright {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using lookup_table::kNaN;

std::optional<Vector2d> pixel_in_table(const LookupTable& t, const Vector2d& xz,
                                       std::optional<Vector2d> start) {
    const auto nodes =
        static_cast<std::size_t>(std::max(0, t.columns)) * static_cast<std::size_t>(std::max(0, t.rows));
    if (t.columns < 2 || t.rows < 2 || t.x_mm.size() != nodes || t.z_mm.size() != nodes || !xz.allFinite())
        return std::nullopt;
    const auto node = [&](int i, int j) {
        const auto n =
            static_cast<std::size_t>(j) * static_cast<std::size_t>(t.columns) + static_cast<std::size_t>(i);
        return Vector2d(t.x_mm[n], t.z_mm[n]);
    };
    constexpr double kArrived = 1e-10, kLongestStep = 4, kAside = 0.01;
    // In units of nodes.
    const auto search = [&](Vector2d p) -> std::optional<Vector2d> {
        for (int iteration = 0; iteration < 60 && p.allFinite(); ++iteration) {
            p.x() = std::clamp(p.x(), 0.0, t.columns - 1.0);
            p.y() = std::clamp(p.y(), 0.0, t.rows - 1.0);
            const int i = std::min(static_cast<int>(p.x()), t.columns - 2),
                      j = std::min(static_cast<int>(p.y()), t.rows - 2);
            const double a = p.x() - i, b = p.y() - j;
            const Vector2d n00 = node(i, j), n10 = node(i + 1, j), n01 = node(i, j + 1),
                           n11 = node(i + 1, j + 1);
            const Vector2d value = (1 - b) * ((1 - a) * n00 + a * n10) + b * ((1 - a) * n01 + a * n11);
            Matrix2d slope;
            slope.col(0) = (1 - b) * (n10 - n00) + b * (n11 - n01);
            slope.col(1) = (1 - a) * (n01 - n00) + a * (n11 - n10);
            const Vector2d step = slope.inverse() * (xz - value);
            if (!step.allFinite()) return std::nullopt;
            if (step.norm() < kArrived) return Vector2d(t.u0 + p.x() * t.step_u, t.v0 + p.y() * t.step_v);
            p += step * std::min(1.0, kLongestStep / step.norm());
        }
        return std::nullopt;
    };
    if (start)
        if (const auto found = search({(start->x() - t.u0) / t.step_u, (start->y() - t.v0) / t.step_v}))
            return found;
    double least = kInfinity;
    Vector2d nearest(kNaN, kNaN);
    for (int j = 0; j < t.rows; ++j)
        for (int i = 0; i < t.columns; ++i) {
            const double d = (node(i, j) - xz).squaredNorm();
            if (d < least) least = d, nearest = {i, j};
        }
    if (!nearest.allFinite()) return std::nullopt;
    // The nearest node may stand at the edge of a hole: begin in each of its cells.
    for (const Vector2d& side : {Vector2d(kAside, kAside), Vector2d(-kAside, kAside),
                                 Vector2d(kAside, -kAside), Vector2d(-kAside, -kAside)})
        if (const auto found = search(nearest + side)) return found;
    return std::nullopt;
}

}  // namespace seamwright
