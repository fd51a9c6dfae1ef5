#pragma once
// What the acceptance of a measuring process has in common (AIAG MSA 4th edition; VDA volume 5, 3rd edition;
// ISO 22514-7). One measurand, in millimetres: the deviation of a path point across the bead after correction.
// The tolerance T = USL - LSL is the customer's requirement and never follows from the data.
//
// Every index comes with its 95 % confidence limits: those of the true index, two-sided, 2.5 % on either side.
// How they are found is said where the index is.

#include <optional>
#include <string>

namespace seamwright {

struct Interval {
    double low = 0, high = 0;
    bool contains(double value) const { return low <= value && value <= high; }
};

// One measured value. Values of one part and one rehang differ by their run alone; a rehang is the part taken
// out and put in again. The reference is what a better instrument says of this part.
struct StudyValue {
    std::string part, rehang;
    long run = 0;
    double value_mm = 0;
    std::optional<double> reference_mm;
    std::string utc;  // when it was measured, ISO 8601; empty: not known
};

enum class AcceptanceVerdict {
    ok,
    conditional,      // between the limits: for the customer to decide
    not_ok,           // beyond them
    too_little_data,  // the indices are stated, but fewer values than the study asks for prove nothing
};
// "ok", "conditional", "not_ok", "too_little_data"
const char* to_string(AcceptanceVerdict verdict);

}  // namespace seamwright
