#include "core/calibration/table/table_nodes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/numbers.h"

namespace seamwright::lookup_table {

using Eigen::Vector2d;

namespace {

double cross(const Vector2d& a, const Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

// Convex hull (Andrew's monotone chain), counter-clockwise in (u, v), without repeated points.
std::vector<Vector2d> convex_hull(std::vector<Vector2d> p) {
    std::sort(p.begin(), p.end(), [](const Vector2d& a, const Vector2d& b) {
        return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
    });
    p.erase(std::unique(p.begin(), p.end()), p.end());
    if (p.size() < 3) return p;
    std::vector<Vector2d> hull;
    for (int side = 0; side < 2; ++side) {
        const std::size_t base = hull.size();
        for (const auto& q : p) {
            while (hull.size() >= base + 2 &&
                   cross(hull.back() - hull[hull.size() - 2], q - hull.back()) <= 0)
                hull.pop_back();
            hull.push_back(q);
        }
        hull.pop_back();
        std::reverse(p.begin(), p.end());
    }
    return hull;
}

double area_of(const std::vector<Vector2d>& hull) {
    double twice = 0;
    for (std::size_t i = 0; i < hull.size(); ++i) twice += cross(hull[i], hull[(i + 1) % hull.size()]);
    return 0.5 * twice;
}

}  // namespace

double outside(const std::vector<Vector2d>& hull, const Vector2d& p) {
    double most = -kInfinity;
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const Vector2d edge = hull[(i + 1) % hull.size()] - hull[i];
        most = std::max(most, -cross(edge, p - hull[i]) / edge.norm());
    }
    return most;
}

Support::Support(const std::vector<Vector2d>& pixel) : hull(convex_hull(pixel)) {
    spacing = std::sqrt(std::max(0.0, area_of(hull)) / static_cast<double>(pixel.size()));
}

double table_error_mm(const SmoothMap& map, const Vector2d& corner, double step) {
    const Vector2d a = map.at(corner), b = map.at(corner + Vector2d(step, 0)),
                   c = map.at(corner + Vector2d(0, step)), d = map.at(corner + Vector2d(step, step));
    return (0.25 * (a + b + c + d) - map.at(corner + Vector2d(step, step) / 2)).norm();
}

LookupTable build_table(const SmoothMap& map, const Support& support, const std::vector<Vector2d>& pixel,
                        int width, int height, double step, int& folded) {
    LookupTable t;
    t.step_u = t.step_v = step;
    t.columns = std::max(2, static_cast<int>(std::ceil((width - 1) / step)) + 1);
    t.rows = std::max(2, static_cast<int>(std::ceil((height - 1) / step)) + 1);
    const auto nodes = static_cast<std::size_t>(t.columns) * static_cast<std::size_t>(t.rows);
    t.x_mm.assign(nodes, kNaN);
    t.z_mm.assign(nodes, kNaN);
    const auto index = [&](int i, int j) {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(t.columns) +
               static_cast<std::size_t>(i);
    };
    constexpr double kReachSpacings = 2, kReachSteps = 0.75;  // from a pair to a node that it supports
    constexpr double kRounding_px = 1e-9;
    std::vector<char> near(nodes, 0);
    const double reach = std::max(kReachSpacings * support.spacing, kReachSteps * step);
    for (const auto& p : pixel)
        for (int j = std::max(0, static_cast<int>(std::ceil((p.y() - reach) / step)));
             j <= std::min(t.rows - 1, static_cast<int>(std::floor((p.y() + reach) / step))); ++j)
            for (int i = std::max(0, static_cast<int>(std::ceil((p.x() - reach) / step)));
                 i <= std::min(t.columns - 1, static_cast<int>(std::floor((p.x() + reach) / step))); ++i)
                if (std::hypot(i * step - p.x(), j * step - p.y()) <= reach) near[index(i, j)] = 1;
    const double margin = 0.5 * std::min(step, support.spacing) + kRounding_px;
    for (int j = 0; j < t.rows; ++j)
        for (int i = 0; i < t.columns; ++i) {
            const Vector2d p(i * step, j * step);
            if (!near[index(i, j)] || outside(support.hull, p) > margin) continue;
            const Vector2d xz = map.at(p);
            if (!xz.allFinite()) continue;
            t.x_mm[index(i, j)] = xz.x();
            t.z_mm[index(i, j)] = xz.y();
        }
    // A map that folds over has cells of the other orientation.
    std::vector<std::pair<std::size_t, double>> turn;
    int left = 0, right = 0;
    for (int j = 0; j + 1 < t.rows; ++j)
        for (int i = 0; i + 1 < t.columns; ++i) {
            const auto at = [&](int a, int b) {
                return Vector2d(t.x_mm[index(i + a, j + b)], t.z_mm[index(i + a, j + b)]);
            };
            const double c = cross(at(1, 1) - at(0, 0), at(0, 1) - at(1, 0));
            if (!std::isfinite(c)) continue;
            (c > 0 ? left : right) += 1;
            turn.emplace_back(index(i, j), c);
        }
    folded = std::min(left, right);
    for (const auto& [n, c] : turn)
        if ((c > 0) != (left >= right))
            for (const std::size_t k : {n, n + 1, n + static_cast<std::size_t>(t.columns),
                                        n + static_cast<std::size_t>(t.columns) + 1})
                t.x_mm[k] = t.z_mm[k] = kNaN;
    return t;
}

}  // namespace seamwright::lookup_table
