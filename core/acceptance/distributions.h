#pragma once
// Distributions for confidence limits, by Boost.Math to rounding (core/calibration/statistics.h: to about 1 %, enough
// for verdicts, not for printed limits); compiled once.

#include <span>
#include <vector>

#include "core/acceptance/acceptance.h"

namespace seamwright {

double normal_cdf(double z);
double t_quantile(double degrees, double probability);
// P(|T| > |t|).
double student_two_sided_p(double degrees, double t);
double chi_square_cdf(double degrees, double x);
double chi_square_quantile(double degrees, double probability);
// P(F > f).
double f_upper(double numerator_degrees, double denominator_degrees, double f);
double f_quantile(double numerator_degrees, double denominator_degrees, double probability);

// Mean and unbiased standard deviation.
struct Moments {
    double mean = 0, s = 0;
};
Moments moments(std::span<const double> values);

// Values are equal as far as doubles tell: their scatter is rounding.
bool all_equal(const Moments& m);

// Of a standard deviation whose square is a mean square of `degrees`: sigma^2 in [nu s^2 / chi^2_0.975,
// nu s^2 / chi^2_0.025]. Exact for normal noise; with the effective degrees of freedom of a sum of mean
// squares it is Satterthwaite's (1946).
Interval sigma_limits(double s, double degrees);

// A mean square and its degrees of freedom.
struct MeanSquare {
    double value = 0, degrees = 0;
};
// Satterthwaite: degrees of sum c_i MS_i, (sum c_i MS_i)^2 / sum((c_i MS_i)^2 / nu_i).
double satterthwaite_degrees(std::span<const MeanSquare> terms);

// Generalised confidence limits (Weerahandi 1993; for gauge studies Burdick, Borror and Montgomery 2005,
// chapter 3) of an x >= 0 that grows with the expectation theta of the `top` mean square:
//     x = max(0, (theta - offset) / scale),    theta* = nu MS / U,  U chi-square of nu,
// `offset` and `scale` being functions of the other mean squares' pivots. The distribution of x* is integrated
// over `others` (equally probable), without random numbers.
struct OtherPivots {
    double offset = 0, scale = 1;
};
Interval generalised_limits(const MeanSquare& top, std::span<const OtherPivots> others);

// theta* of a mean square at `count` equally probable places, the midpoints of its distribution's slices.
std::vector<double> pivots(const MeanSquare& ms, int count);

}  // namespace seamwright
