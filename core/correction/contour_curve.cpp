#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/SpecialFunctions>

#include "core/correction/contour_fit.h"
#include "core/correction/correction.h"
#include "core/geometry/decompositions.h"
#include "core/median.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

constexpr double kCurveSettled = 1e-12;  // of 1 and the coefficients
// Robust sigma: from the one on a point weighs nothing (Tukey), within the other it counts in the last fit. Neither is less
// than kCurveLeastGate.
constexpr double kCurveTukey = 6, kCurveKept = 4, kCurveLeastGate = 1e-9;
constexpr double kCurveRounding = 1e-18;    // squared residual: no noise to test against
constexpr double kCurveNoMisfit = 1e-14;    // squared residual: nothing is left to be explained
constexpr double kCurveSignificant = 1e-3;  // of the F test for a higher order
// Of values that step by a grain: what is no gross error, and the share of its square that a step may leave of a line.
constexpr double kCurveSteps = 1.5, kCurveStepSquare = 0.25;

}  // namespace

PolynomialFit fit_polynomial(std::span<const double> y, std::span<const double> v, int order, double grain) {
    PolynomialFit out;
    out.order = order;
    const auto n = static_cast<Eigen::Index>(y.size());
    double scale = 0;
    for (const double t : y) scale = std::max(scale, std::abs(t));
    if (n < order + 1 || !(scale > 0)) return out;
    Eigen::MatrixXd a(n, order + 1);
    for (Eigen::Index i = 0; i < n; ++i) {
        double power = 1;
        for (int k = 0; k <= order; ++k, power *= y[static_cast<std::size_t>(i)] / scale) a(i, k) = power;
    }
    const Eigen::Map<const Eigen::VectorXd> value(v.data(), n);
    Eigen::VectorXd weight = Eigen::VectorXd::Ones(n), c, residual;
    // Tukey's biweight on a scale from the median: a gross point ends with weight 0.
    double robust = 0;
    for (int round = 0; round < 30; ++round) {
        const Eigen::VectorXd root = weight.cwiseSqrt();
        const LeastSquares solved = least_squares(root.asDiagonal() * a, root.cwiseProduct(value));
        if (solved.rank < order + 1) return out;
        const Eigen::VectorXd next = solved.x;
        const bool settled = round > 0 && (next - c).norm() <= kCurveSettled * (1 + c.norm());
        c = next;
        residual = value - a * c;
        std::vector<double> size(static_cast<std::size_t>(n));
        for (Eigen::Index i = 0; i < n; ++i) size[static_cast<std::size_t>(i)] = std::abs(residual[i]);
        robust = kMadToSigma * median(size);
        if (settled || round == 29) break;
        const double cut =
            std::max({kCurveTukey * robust, kCurveLeastGate, kCurveTukey / kCurveKept * kCurveSteps * grain});
        for (Eigen::Index i = 0; i < n; ++i) {
            const double u = residual[i] / cut;
            weight[i] = std::abs(u) < 1 ? (1 - u * u) * (1 - u * u) : 0.0;
        }
    }
    // The last word is plain least squares on what lies within kCurveKept robust sigma, so that its covariance is the
    // usual one.
    const double keep = std::max({kCurveKept * robust, kCurveLeastGate, kCurveSteps * grain});
    std::vector<Eigen::Index> kept;
    for (Eigen::Index i = 0; i < n; ++i) {
        if (std::abs(residual[i]) <= keep) kept.push_back(i);
    }
    const auto m = static_cast<Eigen::Index>(kept.size());
    if (m < order + 1) return out;
    Eigen::MatrixXd b(m, order + 1);
    Eigen::VectorXd w(m);
    for (Eigen::Index i = 0; i < m; ++i) {
        b.row(i) = a.row(kept[static_cast<std::size_t>(i)]);
        w[i] = value[kept[static_cast<std::size_t>(i)]];
    }
    const LeastSquares solved = least_squares(b, w);
    if (solved.rank < order + 1) return out;
    c = solved.x;
    const double sum = (w - b * c).squaredNorm();
    out.used = static_cast<int>(m);
    out.degrees = static_cast<int>(m) - order - 1;
    out.sum_squares = sum;
    out.sigma = out.degrees > 0 ? std::sqrt(sum / out.degrees) : 0;
    const Eigen::MatrixXd inverse = inverse_matrix(b.transpose() * b);
    double power = 1;
    for (int k = 0; k <= order; ++k, power *= scale) {
        out.coefficient[static_cast<std::size_t>(k)] = c[k] / power;
        out.coefficient_sigma[static_cast<std::size_t>(k)] =
            out.sigma * std::sqrt(std::max(0.0, inverse(k, k))) / power;
    }
    out.ok = true;
    return out;
}

double f_test(double value, double over, double under) {
    if (!(value > 0) || !(under > 0)) return 1;
    return Eigen::numext::betainc(0.5 * under, 0.5 * over, under / (under + over * value));
}

PolynomialFit fit_lowest_order(std::span<const double> y, std::span<const double> v, int lowest, int highest,
                               double grain) {
    std::vector<double> different(y.begin(), y.end());
    std::sort(different.begin(), different.end());
    different.erase(std::unique(different.begin(), different.end()), different.end());
    PolynomialFit best = fit_polynomial(y, v, lowest, grain);
    for (int order = lowest + 1; order <= highest; ++order) {
        // Three points more than coefficients, or a high order would merely run through the noise.
        if (different.size() < static_cast<std::size_t>(order) + 4) break;
        const PolynomialFit higher = fit_polynomial(y, v, order, grain);
        if (!higher.ok || higher.degrees < 1) continue;
        if (!best.ok) {
            best = higher;
            continue;
        }
        // A straight line may reject as outliers what a curve explains: the share kept counts as well.
        const bool keeps_more = higher.used > best.used + 1;
        const int extra = higher.order - best.order;
        const double floor = kCurveRounding * higher.degrees;
        const double variance =
            std::max((higher.sum_squares + floor) / higher.degrees, kCurveStepSquare * grain * grain);
        const double f = (best.sum_squares - higher.sum_squares) / extra / variance;
        const bool better = best.sum_squares > kCurveNoMisfit * best.used &&
                            f_test(f, extra, higher.degrees) < kCurveSignificant;
        if (better || keeps_more) best = higher;
    }
    return best;
}

Expected<ContourCurve> fit_contour_curve(std::span<const TravelPoint> points) {
    std::vector<double> y, x, z;
    for (const TravelPoint& p : points) {
        if (!std::isfinite(p.travel_mm) || !std::isfinite(p.x_mm) || !std::isfinite(p.z_mm)) continue;
        y.push_back(p.travel_mm);
        x.push_back(p.x_mm);
        z.push_back(p.z_mm);
    }
    if (y.size() < 5)
        return input_error(Text("only {} reference points of the pass are usable", y.size()), "contour curve",
                           "record at least 5 profiles between entry and exit");
    const auto [from, to] = std::minmax_element(y.begin(), y.end());
    if (*to - *from < 1.0)
        return input_error(Text("the pass covers only {:.3f} mm of travel", *to - *from), "contour curve",
                           "record profiles over about 20 mm before and after the trigger position");
    const PolynomialFit fx = fit_lowest_order(y, x, 1, 3), fz = fit_lowest_order(y, z, 1, 3);
    if (!fx.ok || !fz.ok)
        return input_error("the reference points do not lie on a curve over the travel", "contour curve",
                           "record profiles at several different travels");
    ContourCurve curve;
    for (std::size_t k = 0; k < 3; ++k) {
        curve.x_coefficients[static_cast<Eigen::Index>(k)] = fx.coefficient[k + 1];
        curve.z_coefficients[static_cast<Eigen::Index>(k)] = fz.coefficient[k + 1];
    }
    curve.valid_from_mm = std::min(0.0, *from);
    curve.valid_to_mm = std::max(0.0, *to);
    return curve;
}

}  // namespace seamwright
