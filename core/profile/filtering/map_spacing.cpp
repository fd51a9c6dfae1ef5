#include <algorithm>
#include <cmath>
#include <limits>

#include "core/profile/filter.h"

namespace seamwright {
namespace {

// Everything is done for the ratio r = s / s_0, u = ln r, so that lengths of any unit behave alike:
//   h(u)  = -(rm - r)^2 / (2 rho^2) - (u - up)^2 / (2 v) + const,   up = (mu - sigma^2/2) i - v,  v = sigma^2
//   i h'(u) = (rm - r) r / rho^2 - (u - up) / v h''   = (rm - 2 r) r / rho^2 - 1 / v
// (- ln s of (3.7) has been drawn into the square: it moves the mode of the prediction from (mu - sigma^2/2)
// i to up.) Every stationary point lies between the prediction's mode exp(up) and rm; h' falls there
// everywhere except where h'' > 0, which needs r < rm / 2.
struct Density {
    double rm, inv_rho2, up, inv_v;
    double value(double u, double r) const {
        return -0.5 * (rm - r) * (rm - r) * inv_rho2 - 0.5 * (u - up) * (u - up) * inv_v;
    }
    double slope(double u, double r) const { return (rm - r) * r * inv_rho2 - (u - up) * inv_v; }
    double curvature(double r) const { return (rm - 2 * r) * r * inv_rho2 - inv_v; }
};

constexpr int kFastSteps = 8, kSafeSteps = 80;
constexpr double kStepTolerance = 2e-8;  // Newton is quadratic there: the error left is about its square

constexpr double kMostPull = 700;  // in u: exp(-700) is still a number
constexpr double kBelow = 1e-9;    // that the lower end of a bracket lies below what bounds the root
// Step from which exp to third order is exact enough, for the next error is below 1e-6 by its square; and what of that
// next one counts as none.
constexpr double kSmallStep = 1e-4, kNextStep = 1e-9;

// Root of the falling function h' in [lo, hi]: Newton, halving whenever it leaves the bracket or stops
// shrinking.
double safe_root(const Density& d, double lo, double hi, double u) {
    if (!(u > lo && u < hi)) u = 0.5 * (lo + hi);
    double before = hi - lo;
    for (int k = 0; k < kSafeSteps; ++k) {
        const double r = std::exp(u), g = d.slope(u, r), c = d.curvature(r);
        (g > 0 ? lo : hi) = u;
        double step = -g / c;
        if (!(u + step > lo && u + step < hi) || std::abs(step) > 0.5 * before) step = 0.5 * (lo + hi) - u;
        before = std::abs(step);
        u += step;
        if (before < kStepTolerance) break;
    }
    return u;
}

// The general case: up to two maxima, each in an interval where h' falls.
double safe_maximum(const Density& d, double start) {
    if (!(d.rm > 0)) {
        // Below the prediction's mode; the lower end takes the pull of the measurement at its largest.
        const double r = std::exp(d.up);
        const double pull = (r - d.rm) * r * d.inv_rho2 / d.inv_v;
        return safe_root(d, d.up - std::min(pull, kMostPull) - kBelow, d.up, start);
    }
    const double um = std::log(d.rm);
    if (um <= d.up) return safe_root(d, um, d.up, start);
    const double discriminant = d.rm * d.rm - 8 * d.inv_v / d.inv_rho2;
    if (discriminant <= 0) return safe_root(d, d.up, um, start);
    const double root = std::sqrt(discriminant);
    const double r2 = 0.25 * (d.rm + root), r1 = 0.5 * d.inv_v / d.inv_rho2 / r2;  // h'' = 0 at r1 < r2
    const double u1 = std::log(r1), u2 = std::log(r2);
    double best = std::numeric_limits<double>::quiet_NaN(),
           best_value = -std::numeric_limits<double>::infinity();
    const auto consider = [&](double u) {
        const double value = d.value(u, std::exp(u));
        if (value > best_value) best = u, best_value = value;
    };
    if (d.up < u1 && d.slope(u1, r1) < 0) consider(safe_root(d, d.up, u1, start));
    const double lower = std::max(u2, d.up);
    if (d.slope(lower, std::exp(lower)) > 0) consider(safe_root(d, lower, um, start));
    return std::isnan(best) ? um : best;
}

// (3.16)-(3.19) divided by s_0: U1 r + U2 / r + U3 = 0.
double closed_form_ratio(double rm, double mu, double sigma, double rho, int i) {
    const double c1 = 2 * sigma * sigma * i;
    const double c3 = c1 - 2 * (mu - 0.5 * sigma * sigma) * i;
    const double d1 = 2 * rho * rho, d3 = -2 * rm * c1, d4 = c3 * d1;
    const double d6 = 0.5;  // ln(s_0) + 0.5 with s_0 = 1, corrected
    const double U1 = 2 * c1 - d1, U2 = 2 * d6 * d1 - 4 * d1 + d4, U3 = d3 + 4 * d1;
    const double discriminant = U3 * U3 - 4 * U1 * U2;
    if (!(discriminant >= 0)) return std::numeric_limits<double>::quiet_NaN();
    const double q =
        -0.5 * (U3 + std::copysign(std::sqrt(discriminant), U3));  // both roots without cancellation
    for (const double r : {q / U1, U2 / q})
        if (r > 0 && std::isfinite(r) && U1 - U2 / (r * r) > 0) return r;
    return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

double map_spacing_closed_form(double s_meas, double s_0, double mu, double sigma, double sn, int i) {
    return s_0 * closed_form_ratio(s_meas / s_0, mu, sigma, sn / s_0, i);
}

double map_spacing(double s_meas, double s_0, double mu, double sigma, double sn, int i) {
    if (!(s_0 > 0) || !std::isfinite(s_0)) return s_meas > 0 ? s_meas : 0.0;
    const double v = sigma * sigma * i, up = (mu - 0.5 * sigma * sigma) * i - v;
    const double rm = s_meas / s_0, rho = sn / s_0, inv_rho2 = 1 / (rho * rho), inv_v = 1 / v;
    if (!(v > 0) || !std::isfinite(inv_v) || !std::isfinite(rm) || !(inv_rho2 > 0)) return s_0 * std::exp(up);
    if (!std::isfinite(inv_rho2)) return s_meas > 0 ? s_meas : s_0 * std::exp(up);
    const Density d{rm, inv_rho2, up, inv_v};

    const double closed = closed_form_ratio(rm, mu, sigma, rho, i);
    const double start = closed > 0 ? std::log(closed) : up;
    // One maximum for certain: h concave everywhere, or nothing between prediction and measurement below rm
    // / 2.
    if (rm * rm * inv_rho2 <= 8 * inv_v || 1 + up >= 0.5 * rm) {
        double u = start, r = closed > 0 ? closed : std::exp(up);
        for (int k = 0; k < kFastSteps; ++k) {
            const double curvature = d.curvature(r);
            const double step = -d.slope(u, r) / curvature;
            if (!(curvature < 0) || !(std::abs(step) < 1)) break;
            u += step;
            if (std::abs(step) < kSmallStep) {
                r *= 1 + step * (1 + step * (0.5 + step / 6));
                if (std::abs(step) < kStepTolerance ||
                    std::abs(step * step * (1 + inv_rho2 * r * r / -curvature)) < kNextStep)
                    return s_0 * r;
            } else {
                r = std::exp(u);
            }
        }
    }
    return s_0 * std::exp(safe_maximum(d, start));
}

}  // namespace seamwright
