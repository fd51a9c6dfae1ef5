#include "core/features/contour/contour_pitch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/median.h"

namespace seamwright {

bool ContourPitch::is_wall(double dx, double dz) const {
    return std::hypot(dx, dz) > 5 * distance && std::abs(dx) <= most_open() * along_x;
}

bool ContourPitch::is_gap(double dx, double dz) const {
    return std::hypot(dx, dz) > 6 * distance && std::abs(dx) > most_open() * along_x;
}

bool ContourPitch::is_step(std::span<const double> x, std::span<const double> z, std::size_t at,
                           double sigma_mm) const {
    constexpr double kLeastPitches = 2.5, kLeastSigmas = 8, kFlat = 0.35;
    if (at < 1 || at + 2 >= x.size()) return false;
    const double dx = x[at + 1] - x[at], rise = std::abs(z[at + 1] - z[at]);
    return rise > kLeastSigmas * sigma_mm && std::hypot(dx, rise) > kLeastPitches * distance &&
           std::abs(dx) <= most_open() * along_x && std::abs(z[at] - z[at - 1]) < kFlat * rise &&
           std::abs(z[at + 2] - z[at + 1]) < kFlat * rise;
}

int ContourPitch::most_mixed() const {
    return std::max(2, static_cast<int>(std::lround(alike())));
}

// Mean square of what a ramp between points `a` and `b`, which go on to either side as surfaces of one slope, leaves;
// infinite where it is none, or not as long as a mean makes it.
double ContourPitch::ramp_misfit(std::span<const double> x, std::span<const double> z, std::size_t a,
                                 std::size_t b, double sigma_mm) const {
    constexpr std::size_t kSide = 4;
    constexpr double kLeastPitches = 3.5, kLeastSigmas = 10, kFlatter = 0.5, kMostSigmas = 2,
                     kMostOfRise = 0.04;
    constexpr double kNone = std::numeric_limits<double>::infinity();
    if (a + 1 < kSide || b + kSide > x.size()) return kNone;
    const double length = std::abs(x[b] - x[a]),
                 least = std::max(kLeastSigmas * sigma_mm, kLeastPitches * distance);
    if (std::abs(z[b] - z[a]) < 0.5 * least || std::abs(length / along_x - most_mixed()) > 1.5) return kNone;
    // By the lines, which a mean goes by; by x where some of them are missing.
    const bool all_there = std::abs(length / along_x - double(b - a)) < 0.75;
    const auto run = [&](std::size_t k) {
        return all_there ? (double(k) - double(a)) * length / double(b - a)
                         : (x[k] - x[a]) * (x[b] > x[a] ? 1 : -1);
    };
    double x1 = 0, z1 = 0, x2 = 0, z2 = 0, xx = 0, xz = 0;
    for (std::size_t k = 0; k < kSide; ++k)
        x1 += run(a - k) / kSide, z1 += z[a - k] / kSide, x2 += run(b + k) / kSide, z2 += z[b + k] / kSide;
    for (std::size_t k = 0; k < kSide; ++k) {
        const double u = run(a - k) - x1, v = run(b + k) - x2;
        xx += u * u + v * v;
        xz += u * (z[a - k] - z1) + v * (z[b + k] - z2);
    }
    const double slope = xz / xx, foot = z1 - slope * x1, rise = z2 - slope * x2 - foot;
    if (std::abs(rise) < least || std::abs(slope) * length > kFlatter * std::abs(rise)) return kNone;
    double squares = 0;
    for (std::size_t k = a + 1 - kSide; k < b + kSide; ++k) {
        const double part = std::clamp(run(k) / length, 0.0, 1.0);
        squares += std::pow(z[k] - foot - slope * run(k) - part * rise, 2);
    }
    squares /= double(b - a + 2 * kSide - 1);
    const double most = std::max(kMostSigmas * sigma_mm, kMostOfRise * std::abs(rise));
    return squares < most * most ? squares : kNone;
}

int ContourPitch::drawn_out(std::span<const double> x, std::span<const double> z, std::size_t at,
                            double sigma_mm) const {
    if (at == 0) return 0;
    const auto most = static_cast<std::size_t>(most_mixed());
    const auto best_from = [&](std::size_t a) {
        std::pair<double, std::size_t> best{std::numeric_limits<double>::infinity(), 0};
        for (std::size_t b = a + 2; b <= a + most + 1 && b < x.size(); ++b)
            best = std::min(best, {ramp_misfit(x, z, a, b, sigma_mm), b});
        return best;
    };
    const auto [misfit, end] = best_from(at - 1);
    if (end == 0) return 0;
    // The next places fit worse.
    for (std::size_t later = at; later <= at + 1; ++later)
        if (best_from(later).first < misfit) return 0;
    return static_cast<int>(end - at);
}

int ContourPitch::mixed(std::span<const double> x, std::span<const double> z, std::size_t at,
                        double sigma_mm) const {
    if (const int many = alike() > 1 ? drawn_out(x, z, at, sigma_mm) : 0; many > 0) return many;
    constexpr double kLeastPitches = 3.5, kLeastSigmas = 10, kFlat = 0.2;
    for (std::size_t many = 1; many <= 2; ++many) {
        if (at < 3 || at + many + 2 >= x.size()) return 0;
        const std::size_t a = at - 1, b = at + many;
        const double rise = z[b] - z[a], least = std::max(kLeastSigmas * sigma_mm, kLeastPitches * distance);
        if (std::abs(rise) < least || std::abs(x[b] - x[a]) > (1.5 + double(many)) * along_x) continue;
        const double level = kFlat * std::abs(rise);
        if (std::abs(z[a] - z[a - 1]) > level || std::abs(z[a] - z[a - 2]) > level ||
            std::abs(z[b + 1] - z[b]) > level || std::abs(z[b + 2] - z[b]) > level)
            continue;
        const double margin = std::max(4 * sigma_mm, 0.08 * std::abs(rise));
        bool between = true;
        for (std::size_t k = at; k < b; ++k) {
            const double up = (z[k] - z[a]) * (rise > 0 ? 1 : -1);
            between = between && up > margin && up < std::abs(rise) - margin && (z[k] - z[k - 1]) * rise > 0;
        }
        if (between) return static_cast<int>(many);
    }
    return 0;
}

ContourPitch contour_pitch(std::span<const double> x, std::span<const double> z,
                           std::vector<double>& scratch) {
    ContourPitch pitch;
    scratch.clear();
    for (std::size_t i = 1; i < x.size(); ++i) scratch.push_back(std::abs(x[i] - x[i - 1]));
    pitch.along_x = median(scratch);
    scratch.clear();
    for (std::size_t i = 1; i < x.size(); ++i)
        scratch.push_back(std::hypot(x[i] - x[i - 1], z[i] - z[i - 1]));
    pitch.distance = median(scratch);
    return pitch;
}

}  // namespace seamwright
