#include "core/features/contour/line_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numbers.h"

namespace seamwright {
namespace {

constexpr double kGate = 3.5;  // sigma; keeps 99.95 % of Gaussian noise
constexpr double kSmallest_mm = 1e-9;

// Line through the kept points; false when they have no extent.
bool total_least_squares(std::span<const double> x, std::span<const double> z,
                         const std::vector<std::uint8_t>& keep, LineFit& line) {
    double n = 0, mx = 0, mz = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
        if (keep[i]) {
            n += 1;
            mx += x[i];
            mz += z[i];
        }
    if (n < 2) return false;
    mx /= n;
    mz /= n;
    double xx = 0, xz = 0, zz = 0;
    for (std::size_t i = 0; i < x.size(); ++i)
        if (keep[i]) {
            const double dx = x[i] - mx, dz = z[i] - mz;
            xx += dx * dx;
            xz += dx * dz;
            zz += dz * dz;
        }
    if (!(xx + zz > kSmallest_mm * kSmallest_mm)) return false;
    const double angle = 0.5 * std::atan2(2 * xz, xx - zz);
    line.centre = {mx, mz};
    line.direction = {std::cos(angle), std::sin(angle)};
    line.used = static_cast<int>(n);
    const double c = line.direction.x(), s = line.direction.y();
    line.spread_mm2 = c * c * xx + 2 * c * s * xz + s * s * zz;
    return true;
}

double median_distance(std::span<const double> x, std::span<const double> z, const LineFit& line,
                       std::vector<double>& sizes) {
    sizes.clear();
    for (std::size_t i = 0; i < x.size(); ++i) sizes.push_back(std::abs(line.distance({x[i], z[i]})));
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    return *middle;
}

}  // namespace

LineFit fit_line(std::span<const double> x, std::span<const double> z, LineWorkspace& workspace) {
    LineFit line;
    const int n = static_cast<int>(std::min(x.size(), z.size()));
    if (n < 3) return line;
    auto& keep = workspace.keep;
    keep.assign(static_cast<std::size_t>(n), 1);
    if (!total_least_squares(x, z, keep, line)) return line;
    double spread = median_distance(x, z, line, workspace.sizes);

    // Least median of squares over pairs at fixed places: the same answer every time, and one of the pairs is
    // good even when two fifths of the points are not.
    LineFit trial = line;
    constexpr int kPlaces = 9;
    for (int a = 0; a < kPlaces; ++a)
        for (int b = a + 3; b < kPlaces; ++b) {
            const int i = a * (n - 1) / (kPlaces - 1), j = b * (n - 1) / (kPlaces - 1);
            const Eigen::Vector2d d(x[j] - x[i], z[j] - z[i]);
            if (!(d.norm() > kSmallest_mm)) continue;
            trial.centre = {x[i], z[i]};
            trial.direction = d.normalized();
            const double m = median_distance(x, z, trial, workspace.sizes);
            // Well below, or the whole set agrees anyway and its own line is the better start.
            if (m < 0.5 * spread) {
                spread = m;
                line.centre = trial.centre;
                line.direction = trial.direction;
            }
        }
    for (int round = 0; round < 12; ++round) {
        const double gate =
            std::max(kGate * kMadToSigma * median_distance(x, z, line, workspace.sizes), kSmallest_mm);
        bool changed = round == 0;
        for (int i = 0; i < n; ++i) {
            const std::uint8_t in = std::abs(line.distance({x[i], z[i]})) <= gate;
            changed = changed || in != keep[i];
            keep[i] = in;
        }
        if (!changed) break;
        if (!total_least_squares(x, z, keep, line)) return line;
    }
    if (line.used < 3) return line;
    const Eigen::Vector2d sense(x[n - 1] - x[0], z[n - 1] - z[0]);
    if (line.direction.dot(sense) < 0) line.direction = -line.direction;
    double rss = 0;
    workspace.sizes.clear();
    for (int i = 0; i < n; ++i)
        if (keep[i]) {
            const double d = line.distance({x[i], z[i]});
            workspace.sizes.push_back(d);
            rss += d * d;
            const double s = line.direction.dot(Eigen::Vector2d(x[i], z[i]) - line.centre);
            line.first_mm = std::min(line.first_mm, s);
            line.last_mm = std::max(line.last_mm, s);
        }
    line.rms_mm = std::sqrt(rss / line.used);
    const int freedom = line.used - 2;
    const PooledSigma pooled = pooled_sigma(std::sqrt(rss / freedom), freedom, workspace.noise);
    line.sigma_mm = pooled.sigma_mm;
    line.widening = pooled.widening;
    line.alike = alike_widening(workspace.sizes, 2, workspace.noise);
    line.ok = true;
    return line;
}

}  // namespace seamwright
