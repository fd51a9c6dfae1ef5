#pragma once
// Correlation with a better instrument (CMM, laser tracker): each part's mean value against its reference.
//     offset = mean(value - reference),  limits by Student's t over the parts
//     value = a + slope reference,       least squares
// The process agrees where 0 lies inside the offset's limits and 1 inside the slope's. An offset beyond chance
// is stated, never applied here. Least squares takes the references for exact: their own noise of variance u^2
// lowers the slope by the factor V / (V + u^2), V the variance of the parts; parts should differ by much more
// than the other instrument errs.

#include <span>
#include <string>
#include <vector>

#include "core/acceptance/linearity.h"

namespace seamwright {

inline constexpr int kCorrelationPairs = 10;  // fewer prove nothing

struct CorrelationPair {
    std::string part;
    double value_mm = 0, reference_mm = 0;
};
struct Correlation {
    std::vector<CorrelationPair> pairs;  // one a part, by name
    double offset_mm = 0, s_mm = 0;      // of the differences
    double offset_p = 1;
    Interval offset_limits;
    Line line;     // x: reference, y: value
    double r = 0;  // correlation coefficient
    AcceptanceVerdict verdict = AcceptanceVerdict::not_ok;
};

// Values without reference are passed over. Error (input): fewer than 3 parts with a reference, references all
// equal, values not finite, differences without scatter.
Expected<Correlation> correlation_study(std::span<const StudyValue> values);

}  // namespace seamwright
