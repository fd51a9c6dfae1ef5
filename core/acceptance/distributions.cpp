#include "core/acceptance/distributions.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/acceptance/levels.h"

namespace seamwright {
namespace {

// Boost answers NaN or infinity instead of throwing; what may be asked is asserted here.
using Quiet = boost::math::policies::policy<
    boost::math::policies::domain_error<boost::math::policies::ignore_error>,
    boost::math::policies::pole_error<boost::math::policies::ignore_error>,
    boost::math::policies::overflow_error<boost::math::policies::ignore_error>,
    boost::math::policies::evaluation_error<boost::math::policies::ignore_error>,
    boost::math::policies::promote_double<false>>;
using ChiSquared = boost::math::chi_squared_distribution<double, Quiet>;
using StudentsT = boost::math::students_t_distribution<double, Quiet>;

}  // namespace

const char* to_string(AcceptanceVerdict verdict) {
    switch (verdict) {
        case AcceptanceVerdict::ok:
            return "ok";
        case AcceptanceVerdict::conditional:
            return "conditional";
        case AcceptanceVerdict::not_ok:
            return "not_ok";
        default:
            return "too_little_data";
    }
}

double normal_cdf(double z) {
    return boost::math::cdf(boost::math::normal_distribution<double, Quiet>(), z);
}

double t_quantile(double degrees, double probability) {
    assert(degrees > 0 && probability > 0 && probability < 1);
    return boost::math::quantile(StudentsT(degrees), probability);
}

double student_two_sided_p(double degrees, double t) {
    assert(degrees > 0);
    if (std::isinf(t)) return 0;
    return 2 * boost::math::cdf(boost::math::complement(StudentsT(degrees), std::abs(t)));
}

double chi_square_cdf(double degrees, double x) {
    assert(degrees > 0);
    if (!(x > 0)) return 0;
    return std::isinf(x) ? 1 : boost::math::cdf(ChiSquared(degrees), x);
}

double chi_square_quantile(double degrees, double probability) {
    assert(degrees > 0 && probability > 0 && probability < 1);
    return boost::math::quantile(ChiSquared(degrees), probability);
}

double f_upper(double numerator_degrees, double denominator_degrees, double f) {
    assert(numerator_degrees > 0 && denominator_degrees > 0);
    if (!(f > 0)) return 1;
    return boost::math::cdf(boost::math::complement(
        boost::math::fisher_f_distribution<double, Quiet>(numerator_degrees, denominator_degrees), f));
}

double f_quantile(double numerator_degrees, double denominator_degrees, double probability) {
    assert(numerator_degrees > 0 && denominator_degrees > 0 && probability > 0 && probability < 1);
    return boost::math::quantile(
        boost::math::fisher_f_distribution<double, Quiet>(numerator_degrees, denominator_degrees),
        probability);
}

Moments moments(std::span<const double> values) {
    Moments m;
    for (const double v : values) m.mean += v / static_cast<double>(values.size());
    double squares = 0;
    for (const double v : values) squares += (v - m.mean) * (v - m.mean);
    m.s = values.size() > 1 ? std::sqrt(squares / static_cast<double>(values.size() - 1)) : 0;
    return m;
}

bool all_equal(const Moments& m) {
    return m.s <= kRoundedScatter * std::max(1.0, std::abs(m.mean));
}

Interval sigma_limits(double s, double degrees) {
    return {s * std::sqrt(degrees / chi_square_quantile(degrees, kBelowHigh95)),
            s * std::sqrt(degrees / chi_square_quantile(degrees, kBelowLow95))};
}

double satterthwaite_degrees(std::span<const MeanSquare> terms) {
    double sum = 0, spread = 0;
    for (const MeanSquare& t : terms) {
        sum += t.value;
        if (t.value != 0) spread += t.value * t.value / t.degrees;
    }
    return spread > 0 ? sum * sum / spread : std::numeric_limits<double>::infinity();
}

std::vector<double> pivots(const MeanSquare& ms, int count) {
    std::vector<double> out;
    for (int i = 0; i < count; ++i)
        out.push_back(ms.degrees * ms.value / chi_square_quantile(ms.degrees, (i + 0.5) / count));
    return out;
}

Interval generalised_limits(const MeanSquare& top, std::span<const OtherPivots> others) {
    assert(!others.empty());
    // P(x* <= x): theta* stays below offset + scale x.
    const auto probability = [&](double x) {
        double sum = 0;
        for (const OtherPivots& o : others) {
            const double theta = o.offset + o.scale * x;
            sum += theta > 0 ? 1 - chi_square_cdf(top.degrees, top.degrees * top.value / theta) : 0;
        }
        return sum / static_cast<double>(others.size());
    };
    const auto quantile = [&](double wanted) {
        double low = 0, high = 0, at_low = probability(0) - wanted;
        if (at_low >= 0) return 0.0;
        for (const OtherPivots& o : others) high = std::max(high, top.value / o.scale);
        double at_high = probability(high) - wanted;
        for (int doubled = 0; at_high < 0; ++doubled) {
            if (doubled > 200) return std::numeric_limits<double>::infinity();
            low = high, at_low = at_high;
            high *= 2;
            at_high = probability(high) - wanted;
        }
        // Illinois' false position: the bracket never grows.
        constexpr double kNarrow = 1e-7, kFound = 1e-9;  // of x, and in probability
        for (int step = 0, side = 0; step < 100 && high - low > kNarrow * high; ++step) {
            const double x = (low * at_high - high * at_low) / (at_high - at_low);
            const double at = probability(x) - wanted;
            if (std::abs(at) < kFound) return x;
            if (at > 0) {
                high = x, at_high = at;
                if (side > 0) at_low /= 2;
                side = 1;
            } else {
                low = x, at_low = at;
                if (side < 0) at_high /= 2;
                side = -1;
            }
        }
        return (low + high) / 2;
    };
    return {quantile(kBelowLow95), quantile(kBelowHigh95)};
}

}  // namespace seamwright
