#pragma once
// What a study measured against what the stated covariance predicted of it. Where the prediction is true,
//     nu s^2 / sigma^2  is chi-square of nu degrees of freedom      (a standard deviation),
//     b / u             is standard normal                          (a bias).
// p is two-sided: twice the smaller tail. Below 5 % the two disagree at 95 %, below 1 % at 99 %: the process scatters
// more than stated, or less, which is as much a fault of the statement.

namespace seamwright {

enum class Agreement { agrees, beyond_95, beyond_99 };

struct ForecastCheck {
    double predicted_mm = 0, measured_mm = 0;
    double degrees = 0;  // of the measured; 0: a bias
    double p = 1;
    Agreement agreement = Agreement::agrees;
};

// Preconditions: predicted and measured above 0 and finite, degrees above 0.
ForecastCheck check_scatter(double predicted_mm, double measured_mm, double degrees);
// Preconditions: predicted standard uncertainty above 0, both finite.
ForecastCheck check_bias(double predicted_u_mm, double measured_mm);

}  // namespace seamwright
