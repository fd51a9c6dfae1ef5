#pragma once
// Robust polynomials against travel, shared by the contour curve and the alignment aid.

#include <array>
#include <span>

namespace seamwright {

// v(y) = sum c_k y^k, k = 0..order <= 3, by least squares on the points within 4 robust standard deviations
// (biweight start). `sigma` is the residual standard deviation, the coefficients' sigmas follow from it. ok =
// false when the different travels are too few. `grain`: the values step by so much, as the last point of a contour does; what
// lies within a step and a half is no gross error then, and no order is read into the steps. The sigmas do not know of it.
struct PolynomialFit {
    bool ok = false;
    int order = 0, used = 0, degrees = 0;
    std::array<double, 4> coefficient{}, coefficient_sigma{};
    double sigma = 0, sum_squares = 0;
};
PolynomialFit fit_polynomial(std::span<const double> y, std::span<const double> v, int order,
                             double grain = 0);

// The lowest order in [lowest, highest] that a higher one does not beat significantly (F test, 1e-3).
PolynomialFit fit_lowest_order(std::span<const double> y, std::span<const double> v, int lowest, int highest,
                               double grain = 0);

// Probability of a value as large under F(over, under).
double f_test(double value, double over, double under);

}  // namespace seamwright
