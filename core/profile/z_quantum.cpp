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

}  // namespace

double z_quantum_mm(std::span<const double> x, std::span<const double> z) {
    const std::size_t n = std::min(x.size(), z.size());
    if (n < kFewestBends) return 0;
    double largest = 0;
    for (std::size_t i = 0; i < n; ++i) largest = std::max(largest, std::abs(z[i]));
    const double nothing = kRounded * largest;
    double quantum = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < n; ++i) {
        const double step = std::abs(z[i] - z[i - 1]);
        if (step > nothing) quantum = std::min(quantum, step);
    }
    if (!(quantum <= std::abs(x[n - 1] - x[0]) / double(n - 1))) return 0;
    std::size_t steps = 0, multiples = 0, bends = 0;
    for (std::size_t i = 1; i < n; ++i) {
        const double step = std::abs(z[i] - z[i - 1]);
        if (i > 1 && std::abs(z[i] - 2 * z[i - 1] + z[i - 2]) > 0.5 * quantum) ++bends;
        if (!(step > nothing)) continue;
        const double times = step / quantum;
        ++steps;
        if (std::abs(times - std::round(times)) < kMultiple) ++multiples;
        if (steps == kFirst && double(multiples) < kNearlyAll * double(steps)) return 0;
    }
    return bends >= kFewestBends && double(multiples) >= kNearlyAll * double(steps) ? quantum : 0;
}

}  // namespace seamwright
