#include "core/calibration/camera/f_test.h"

#include <algorithm>
#include <cmath>

namespace seamwright {
namespace {

// Continued fraction of the incomplete beta function (Lentz), x below its middle.
double beta_fraction(double a, double b, double x) {
    constexpr double kTiny = 1e-300, kSettled = 1e-14;
    double c = 1, d = 1 - (a + b) * x / (a + 1);
    d = 1 / (std::abs(d) < kTiny ? kTiny : d);
    double value = d;
    for (int m = 1; m < 10000; ++m) {
        const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        double step = 1;
        for (const double term : {even, odd}) {
            d = 1 + term * d;
            d = 1 / (std::abs(d) < kTiny ? kTiny : d);
            c = 1 + term / c;
            if (std::abs(c) < kTiny) c = kTiny;
            step = c * d;
            value *= step;
        }
        if (std::abs(step - 1) < kSettled) break;
    }
    return value;
}

double incomplete_beta(double a, double b, double x) {
    if (!(x > 0)) return 0;
    if (!(x < 1)) return 1;
    const double front =
        std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
    return x < (a + 1) / (a + b + 2) ? front * beta_fraction(a, b, x) / a
                                     : 1 - front * beta_fraction(b, a, 1 - x) / b;
}

}  // namespace

double f_chance(double f, double numerator, double denominator) {
    if (!(f > 0)) return 1;
    return incomplete_beta(0.5 * denominator, 0.5 * numerator, denominator / (denominator + numerator * f));
}

double freed_chance(double squares, double least, double freed, double freedom) {
    if (!(freedom > 0) || !(freed > 0)) return 1;
    if (!(least > 0)) return squares > 0 ? 0 : 1;
    return f_chance(std::max(0.0, squares - least) / freed / (least / freedom), freed, freedom);
}

}  // namespace seamwright
