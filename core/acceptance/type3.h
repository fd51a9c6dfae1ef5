#pragma once
// Type 3 study: gauge repeatability and reproducibility without an operator's influence (AIAG MSA 4th edition,
// chapter III-B, by analysis of variance). k parts, each put in h times (rehang, nested in the part), each
// measured r times:
//     value = mean + part + rehang(part) + repeat,      all random
//     E[MS_within] = s_w^2,  E[MS_rehang] = s_w^2 + r s_h^2,  E[MS_part] = s_w^2 + r s_h^2 + r h s_p^2
//     EV^2 = MS_within,  rehang^2 = (MS_rehang - MS_within) / r,  PV^2 = (MS_part - MS_rehang) / (r h)
// (h = 1: without the middle line, PV^2 = (MS_part - MS_within) / r). A negative component is 0 and flagged.
//     GRR^2 = EV^2 + rehang^2,  TV^2 = GRR^2 + PV^2,
//     %GRR = 100 w GRR / T (w = 6) and 100 GRR / TV,  ndc = floor(1.41 PV / GRR).
// Up to 10 % of the tolerance with ndc >= 5 is accepted, beyond 30 % not; between it is the customer's word.
// Where each rehang was measured once, repeat and rehang cannot be told apart: both are EV.
//
// Limits. EV by chi-square (exact). GRR and % of tolerance: the same without rehang, with it Satterthwaite's
// on GRR^2 = MS_rehang / r + (1 - 1 / r) MS_within. Rehang and PV (differences of mean squares), % of total and
// ndc: generalised limits (distributions.h), of % of total without rehang the exact F interval.

#include <span>
#include <vector>

#include "core/acceptance/acceptance.h"
#include "core/error.h"

namespace seamwright {

struct Type3Settings {
    double tolerance_mm = 0;
    double width = 6;
    double accepted_percent = 10, refused_percent = 30;
    int required_ndc = 5;
};
inline constexpr int kType3Parts = 5;  // fewer prove nothing; 25 are usual

struct AnovaRow {
    const char* source = "";  // "part", "rehang", "repeat", "total"
    double df = 0, ss = 0, ms = 0;
};

struct Type3 {
    int parts = 0, rehangs = 1, runs = 0;
    double mean_mm = 0;
    double ev_mm = 0, rehang_mm = 0, pv_mm = 0, grr_mm = 0, tv_mm = 0;  // standard deviations
    double grr_percent_tolerance = 0, grr_percent_total = 0;
    int ndc = 0;
    bool nested = false;            // rehang is a component of its own
    bool rehang_negative = false;   // its component came out negative and is 0
    bool pv_negative = false;       // the same
    bool rehang_in_repeat = false;  // each rehang was measured once
    Interval ev_limits, rehang_limits, pv_limits, grr_limits, tolerance_limits, total_limits, ndc_limits;
    double grr_degrees = 0;  // effective degrees of freedom
    std::vector<AnovaRow> anova;
    AcceptanceVerdict verdict = AcceptanceVerdict::not_ok;
};

// Error (input): fewer than 2 parts, every part measured once, parts with different numbers of rehangs or
// rehangs with different numbers of runs, values not finite or all equal within every part, settings that are
// none.
Expected<Type3> type3_study(std::span<const StudyValue> values, const Type3Settings& settings);

}  // namespace seamwright
