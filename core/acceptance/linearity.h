#pragma once
// Linearity (AIAG MSA 4th edition, chapter III-B): the bias against the known displacement, over g levels with
// m repeats each,
//     bias_i = a + b x_i + noise,    least squares over all g m values, s^2 with g m - 2 degrees of freedom,
// and the 95 % confidence band of the line
//     a + b x -+ t_0.975 s sqrt(1 / gm + (x - mean x)^2 / sum (x_i - mean x)^2).
// The process is linear where the line of no bias lies inside the band from the lowest to the highest level.
// Limits of slope and intercept by Student's t, exact for normal noise equal at all levels.

#include <span>
#include <vector>

#include "core/acceptance/acceptance.h"
#include "core/error.h"

namespace seamwright {

// A straight line y = intercept + slope x with 95 % limits.
struct Line {
    int n = 0;
    double slope = 0, intercept = 0;
    double s = 0;  // of y about the line
    double r2 = 0;
    double t_slope = 0, t_intercept = 0, p_slope = 1, p_intercept = 1;
    Interval slope_limits, intercept_limits;
    double mean_x = 0, sum_x2 = 0;
    double at(double x) const { return intercept + slope * x; }
    Interval band(double x) const;  // 95 % confidence of the line
};
// Preconditions: as many x as y, 3 or more, at least two different x.
Line fit_line(std::span<const double> x, std::span<const double> y);

// Asked for: 5 levels of 10 repeats, or as many values over more levels, no level holding more than half of them.
inline constexpr std::size_t kLinearityLevels = 5, kLinearityRepeats = 10;

struct LinearityLevel {
    double reference_mm = 0;
    int n = 0;
    double bias_mm = 0;  // mean
    double fit_mm = 0;
    Interval band;
};
struct Linearity {
    Line line;                           // x: reference, y: bias, mm
    std::vector<LinearityLevel> levels;  // ascending
    bool zero_inside = false;
    AcceptanceVerdict verdict = AcceptanceVerdict::not_ok;
};

// Error (input): a value without reference or not finite, fewer than 2 levels or 3 values, no scatter at all.
Expected<Linearity> linearity_study(std::span<const StudyValue> values);

}  // namespace seamwright
