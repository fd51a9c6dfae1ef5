#pragma once
// Quantiles that verdicts rest on; exact to about 1 % from three degrees of freedom on, which no verdict
// depends on.

namespace seamwright {

// Standard normal quantile, 0 < p < 1, to rounding (Newton on erfc).
double normal_quantile(double p);

// Chi-squared quantile (Wilson and Hilferty: the cube root is nearly normal).
double chi_squared_quantile(double p, double freedom);

// Student's t quantile (Cornish-Fisher expansion in 1/freedom; closed forms for one and two degrees of
// freedom).
double student_quantile(double p, double freedom);

// A sigma that was stated is believed as long as the residuals under it are no worse than chance makes them once in a
// thousand; `chi_squared` of `freedom` degrees. Beyond, they contradict it: what they scatter counts, and the verdict says
// so. Every method that is given a sigma judges it by this.
bool contradicts_stated(double chi_squared, double freedom);

// Limit of the F statistic (three numbers of the one left out, `freedom` of the rest) beyond which the most
// suspicious of many observations counts as wrong: the 99.9 % point, raised for having picked the largest.
inline double outlier_limit(double freedom) {
    return 12 + 60 / freedom;
}

}  // namespace seamwright
