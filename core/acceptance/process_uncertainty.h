#pragma once
// Uncertainty of measuring system and measuring process, and what it leaves of the tolerance (VDA volume 5, 3rd
// edition; ISO 22514-7; ISO 14253-1). Standard uncertainties, mm:
//     u_CAL  of the reference, as its certificate says            u_RE   resolution / sqrt(12)
//     u_EVR  repeatability on the reference part                  u_BI   |bias| / sqrt(3)
//     u_EVO  repeatability on production parts (type 3)           u_REH  rehanging (type 3)
//     u_MS^2 = u_CAL^2 + u_BI^2 + max(u_EVR, u_RE)^2
//     u_MP^2 = u_CAL^2 + u_BI^2 + max(u_EVR, u_EVO, u_RE)^2 + u_REH^2
//     U = 2 u,   Q = 100 * 2 U / T,    limits 15 % (system) and 30 % (process)
// Of several references the one of the largest bias counts; their repeatability is pooled. A value inside the
// conformity zone [LSL + U_MP, USL - U_MP] proves that the part keeps its limits, one outside [LSL - U_MP, USL
// + U_MP] that it does not; between, nothing is proven.
//
// Limits: Satterthwaite's on u^2, its terms weighted with their degrees of freedom; those of the squared bias b^2
// from its variance 4 b^2 s^2 / n + 2 s^4 / n^2; what is stated (certificate, resolution) counts as certain.

#include <optional>
#include <string>
#include <vector>

#include "core/acceptance/acceptance.h"
#include "core/acceptance/type3.h"
#include "core/error.h"

namespace seamwright {

struct ProcessSettings {
    double lower_mm = 0, upper_mm = 0;  // LSL and USL
    double reference_u_mm = 0;          // u_CAL, standard
    double resolution_mm = 0;
    double system_percent = 15, process_percent = 30;
};
inline constexpr int kProcessValues = 25;  // on the references, all together

struct UncertaintyTerm {
    std::string name;  // "u_CAL", ...
    double u_mm = 0;
    double degrees = 0;                          // infinite: stated
    bool in_system = false, in_process = false;  // counts there
};

struct ProcessUncertainty {
    std::vector<UncertaintyTerm> terms;
    int reference_values = 0;
    double bias_mm = 0;  // the largest
    bool type3 = false;  // production parts are in u_MP
    double u_ms_mm = 0, u_mp_mm = 0, q_ms_percent = 0, q_mp_percent = 0;
    Interval u_ms_limits, u_mp_limits, q_ms_limits, q_mp_limits;
    // Empty (low above high) where U leaves nothing.
    Interval conformity_zone, conformity_low_limits, conformity_high_limits;
    AcceptanceVerdict verdict = AcceptanceVerdict::not_ok;
};

// `references`: values with a reference, of parts measured at least kStandardValues times each (others are
// passed over). `production`: the type 3 study, if there is one.
// Error (input): no such part, values not finite or without scatter, limits that leave no tolerance, a negative
// uncertainty.
inline constexpr int kStandardValues = 10;
Expected<ProcessUncertainty> process_uncertainty(std::span<const StudyValue> references,
                                                 const std::optional<Type3>& production,
                                                 const ProcessSettings& settings);

}  // namespace seamwright
