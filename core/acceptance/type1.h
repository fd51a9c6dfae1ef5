#pragma once
// Type 1 study: one part of known reference, measured n times without being touched (AIAG MSA 4th edition,
// chapter III-B; Cg and Cgk as in ISO 22514-7 and the car makers' guides).
//     bias = mean - reference,  t = bias sqrt(n) / s  with n - 1 degrees of freedom
//     Cg   = K T / (w s),       Cgk = (K T / 2 - |bias|) / (w s / 2)
// Share K of the tolerance and width w in standard deviations differ from company to company: 0.2 and 6, 0.15
// and 4. The process is capable when both reach the limit of 1.33.
//
// Limits: s and Cg by chi-square, bias by Student's t, all exact for normal noise. Cgk by inverting the
// noncentral t of sqrt(n) (K T / 2 - |bias|) / s, which is exact for one side of the tolerance; where the bias
// is no larger than its own noise the estimate lies on the low side and the limits hold 94 % to 96 %.

#include <optional>
#include <span>

#include "core/acceptance/acceptance.h"
#include "core/error.h"

namespace seamwright {

struct Type1Settings {
    double tolerance_mm = 0;  // T
    double share = 0.2;       // K
    double width = 6;         // w
    double required = 1.33;   // of Cg, and of Cgk where it has none of its own
    std::optional<double> required_cgk = {};
};
inline constexpr int kType1Values = 25;  // fewer prove nothing; 50 are usual

struct Type1 {
    int n = 0;
    double mean_mm = 0, s_mm = 0, reference_mm = 0, bias_mm = 0;
    double t = 0, bias_p = 1;  // p below 0.05: the bias is no chance
    double cg = 0, cgk = 0;
    Interval mean_limits, s_limits, bias_limits, cg_limits, cgk_limits;
    AcceptanceVerdict verdict = AcceptanceVerdict::not_ok;
};

// Error (input): fewer than 2 values, a value or the reference that is not finite, values that are all equal
// (the resolution hides the scatter), settings that are none.
Expected<Type1> type1_study(std::span<const double> values_mm, double reference_mm,
                            const Type1Settings& settings);

// A tolerance, share, width or limit that is none; the word is what it is called.
Expected<void> check_positive(double value, const char* word);

}  // namespace seamwright
