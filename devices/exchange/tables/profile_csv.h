#pragma once
// Profiles as CSV, the text form that crosses the program's edge.
//
// Header `x_mm,z_mm[,intensity]`, one point a row in sensor order. An empty or NaN field of x or z means "no
// return" (z = NaN inside); an empty intensity reads as 0. The columns `valid` (1/0) and `segment` (0.. , -1
// for outliers) of a filtered profile are read back into Profile::segment (with `valid` alone, valid points
// are segment 0); other columns are ignored, in any order. Windows line ends, a UTF-8 byte order mark, blanks
// about a field, fields in double quotes, a leading plus sign and blank lines at the end are accepted.
//
// Refused with the line number (Error kind input): no header, a column missing or named twice, semicolons or
// tabs as separators, decimal commas, too few or too many fields, anything that is no number, infinite
// values, coordinates beyond 1 km (a wrong unit), a segment without a return, `valid` and `segment` that
// contradict each other, no points at all, more than kProfilePointLimit points.

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/alignment/alignment.h"
#include "core/error.h"
#include "core/profile/profile.h"

namespace seamwright {

inline constexpr std::size_t kProfilePointLimit = 10'000'000;

// `where` names the text in errors ("IN.csv"; the line is appended).
// Heights that stand for "no return", as the text writes them, are NaN: `no_returns`, and is_type_limit() (no_return.h).
Expected<Profile> parse_profile_csv(std::string_view text, const std::string& where,
                                    std::span<const double> no_returns = {});
// With `intensity` when the profile has it, with `valid` and `segment` when it is filtered. Numbers are the
// shortest text that reads back as the same double.
std::string profile_csv(const Profile& profile);

Expected<Profile> read_profile_csv(const std::filesystem::path& path);
Expected<void> write_profile_csv(const std::filesystem::path& path, const Profile& profile);

// The pass over a spot (`seamwright align`): header `travel_mm,profile_index,x_mm,z_mm[,intensity]`, the rows
// of a profile together. Besides the above refused: an index that comes back after another one, is negative
// or no whole number, a travel that changes within a profile or is missing. Profiles stay in file order.
Expected<std::vector<TravelProfile>> parse_align_csv(std::string_view text, const std::string& where);
std::string align_csv(std::span<const TravelProfile> pass);
Expected<std::vector<TravelProfile>> read_align_csv(const std::filesystem::path& path);

}  // namespace seamwright
