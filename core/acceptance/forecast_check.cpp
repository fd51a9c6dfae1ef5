#include "core/acceptance/forecast_check.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/acceptance/distributions.h"

namespace seamwright {
namespace {

constexpr double kBeyond99 = 0.01, kBeyond95 = 0.05;  // p below which the two disagree

ForecastCheck with_p(ForecastCheck check, double p) {
    check.p = std::clamp(p, 0.0, 1.0);
    check.agreement = check.p < kBeyond99   ? Agreement::beyond_99
                      : check.p < kBeyond95 ? Agreement::beyond_95
                                            : Agreement::agrees;
    return check;
}

}  // namespace

ForecastCheck check_scatter(double predicted_mm, double measured_mm, double degrees) {
    assert(predicted_mm > 0 && measured_mm > 0 && degrees > 0);
    const double ratio = measured_mm / predicted_mm;
    const double below = chi_square_cdf(degrees, degrees * ratio * ratio);
    return with_p({predicted_mm, measured_mm, degrees}, 2 * std::min(below, 1 - below));
}

ForecastCheck check_bias(double predicted_u_mm, double measured_mm) {
    assert(predicted_u_mm > 0);
    return with_p({predicted_u_mm, measured_mm}, 2 * normal_cdf(-std::abs(measured_mm) / predicted_u_mm));
}

}  // namespace seamwright
