#pragma once
// Values of a measuring-process study as a table: a header that names the columns
//     part, rehang, run, value [, reference]
// in any order, and one value a row in any order; other columns are ignored. `rehang` may be missing (each part
// was hung once). Part and rehang are names, run is a whole number, value and reference are millimetres ("value
// [mm]" and "value_mm" are value; another unit is converted). An empty reference is none.
//
// Separated by commas, semicolons or tabs, as the header is; with semicolons and tabs the decimal sign may be a
// comma throughout. Quotes as in RFC 4180.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/acceptance/acceptance.h"
#include "core/error.h"

namespace seamwright {

inline constexpr std::size_t kStudyValueLimit = 1'000'000;

// Error (input), with the line: an empty text, a header without part, run or value or naming one twice, a row of
// another width, text where a number belongs, a value missing, not finite or beyond 1 km, a run that is no whole
// number, an empty part, the same part, rehang and run twice.
Expected<std::vector<StudyValue>> parse_study_csv(std::string_view text, const std::string& where);
Expected<std::vector<StudyValue>> read_study_csv(const std::filesystem::path& path);

}  // namespace seamwright
