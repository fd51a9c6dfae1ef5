#include "core/profile/z_quantum.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace seamwright {
namespace {

constexpr double kRounded = 1e-9;   // of the largest z: less is the arithmetic's
constexpr double kMultiple = 0.05;  // of the quantum
constexpr std::size_t kFirst = 64;  // steps that tell most contours from a rounded one
constexpr double kNearlyAll = 0.95;
constexpr std::size_t kFewestBends = 12;
constexpr double kCoarsest = 4, kFinest = 1e-3;  // pitches
constexpr int kDivisions = 5;
// Of neighbours that stand at one height to the last digit: a contour that shows no noise.
constexpr double kStill = 0.75;
constexpr double kCoarsestStill = 2;  // pitches
constexpr double kLeastDigit = 1e-4;  // pitches

double pitch_mm(std::span<const double> x, std::size_t n) {
    return std::abs(x[n - 1] - x[0]) / double(n - 1);
}

// Steps of less are none: the arithmetic's.
double nothing_mm(std::span<const double> z) {
    double largest = 0;
    for (const double at : z) largest = std::max(largest, std::abs(at));
    return kRounded * largest;
}

bool stands_still(std::span<const double> z, double nothing) {
    std::size_t still = 0;
    for (std::size_t i = 1; i < z.size(); ++i) still += std::abs(z[i] - z[i - 1]) <= nothing;
    return double(still) >= kStill * double(z.size() - 1);
}

}  // namespace

double z_quantum_mm(std::span<const double> x, std::span<const double> z) {
    const std::size_t n = std::min(x.size(), z.size());
    if (n < kFewestBends) return 0;
    const double nothing = nothing_mm(z.first(n)), pitch = pitch_mm(x, n);
    double quantum = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < n; ++i) {
        const double step = std::abs(z[i] - z[i - 1]);
        if (step > nothing) quantum = std::min(quantum, step);
    }
    // Along a steep side no step is a single quantum: what one of them leaves of the others is nearer to it.
    for (int division = 0; division < kDivisions && std::isfinite(quantum); ++division) {
        std::size_t steps = 0, multiples = 0, bends = 0;
        double left = quantum;
        const auto nearly_all = [&] { return double(multiples) >= kNearlyAll * double(steps); };
        for (std::size_t i = 1; i < n && (steps != kFirst || nearly_all()); ++i) {
            const double step = std::abs(z[i] - z[i - 1]);
            if (i > 1 && std::abs(z[i] - 2 * z[i - 1] + z[i - 2]) > 0.5 * quantum) ++bends;
            if (!(step > nothing)) continue;
            const double times = step / quantum, off = std::abs(times - std::round(times));
            ++steps;
            if (off < kMultiple)
                ++multiples;
            else
                left = std::min(left, off * quantum);
        }
        if (nearly_all()) {
            const bool again_and_again = bends >= kFewestBends;
            if (again_and_again && quantum <= kCoarsest * pitch) return quantum;
            return quantum <= kCoarsestStill * pitch && steps > 0 && stands_still(z.first(n), nothing)
                       ? quantum
                       : 0;
        }
        quantum = left;
        if (quantum < kFinest * pitch) return 0;
    }
    return 0;
}

double z_rounding_mm(std::span<const double> x, std::span<const double> z) {
    const std::size_t n = std::min(x.size(), z.size());
    if (const double quantum = z_quantum_mm(x, z); quantum > 0 || n < kFewestBends) return quantum;
    const double nothing = nothing_mm(z.first(n)), coarsest = kCoarsestStill * pitch_mm(x, n);
    if (!(coarsest > 0) || !stands_still(z.first(n), nothing)) return 0;
    for (double power = std::pow(10.0, std::ceil(std::log10(coarsest))); power > kLeastDigit * coarsest;
         power /= 10)
        for (const double digit : {1.0, 0.5, 0.2}) {
            const double step = digit * power;
            if (step > coarsest) continue;
            std::size_t multiples = 0;
            for (const double at : z.first(n))
                multiples +=
                    std::abs(at - step * std::round(at / step)) <= std::max(nothing, kRounded * step);
            if (double(multiples) >= kNearlyAll * double(n)) return step;
        }
    return 0;
}

}  // namespace seamwright
