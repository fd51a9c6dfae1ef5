#include "core/calibration/statistics.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace seamwright {

double normal_quantile(double p) {
    assert(p > 0 && p < 1);
    if (p > 0.5) return -normal_quantile(1 - p);
    // Start on the convex side, where Newton cannot overshoot.
    constexpr double kNewtonSettled = 1e-14;
    double x = -std::sqrt(-2 * std::log(p));
    for (int i = 0; i < 60; ++i) {
        const double excess = 0.5 * std::erfc(-x / std::sqrt(2.0)) - p;
        const double density = std::exp(-0.5 * x * x) / std::sqrt(2 * std::numbers::pi);
        const double step = std::clamp(excess / density, -0.5, 0.5);
        x -= step;
        if (std::abs(step) < kNewtonSettled) break;
    }
    return x;
}

double chi_squared_quantile(double p, double freedom) {
    assert(freedom > 0);
    const double a = 2 / (9 * freedom);
    const double root = 1 - a + normal_quantile(p) * std::sqrt(a);
    return freedom * std::max(0.0, root * root * root);
}

double student_quantile(double p, double freedom) {
    assert(freedom >= 1);
    if (freedom == 1) return std::tan(std::numbers::pi * (p - 0.5));
    if (freedom == 2) return (2 * p - 1) * std::sqrt(2 / (4 * p * (1 - p)));
    if (freedom < 3) {
        // The expansion fails; between whole numbers the logarithm is nearly linear in 1/freedom.
        if (p <= 0.5) return p == 0.5 ? 0 : -student_quantile(1 - p, freedom);
        const double whole = std::floor(freedom);
        const double share = (1 / freedom - 1 / (whole + 1)) / (1 / whole - 1 / (whole + 1));
        return std::pow(student_quantile(p, whole), share) *
               std::pow(student_quantile(p, whole + 1), 1 - share);
    }
    const double z = normal_quantile(p), z2 = z * z;
    const double g1 = (z2 + 1) * z / 4;
    const double g2 = ((5 * z2 + 16) * z2 + 3) * z / 96;
    const double g3 = (((3 * z2 + 19) * z2 + 17) * z2 - 15) * z / 384;
    const double g4 = ((((79 * z2 + 776) * z2 + 1482) * z2 - 1920) * z2 - 945) * z / 92160;
    return z + (g1 + (g2 + (g3 + g4 / freedom) / freedom) / freedom) / freedom;
}

bool contradicts_stated(double chi_squared, double freedom) {
    constexpr double kTold = 0.999;
    return freedom > 0 && !(chi_squared <= chi_squared_quantile(kTold, std::max(1.0, freedom)));
}

}  // namespace seamwright
