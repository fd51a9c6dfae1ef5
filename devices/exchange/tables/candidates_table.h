#pragma once
// Candidates of a stripe as text (ProfileCandidates): several points a line, of which tracking chooses one.
//
// CSV: header `line,x_mm,z_mm[,intensity]`, a row a candidate, lines from 0, in any order; or what `seamwright extract`
// writes, `index,position_px[,intensity]`, in pixels: x is the line, z the position. JSON: {"lines":[[[x,z(,intensity)],..],..]},
// a list of candidates for each line, in mm. A line without rows, or with an empty list, has none.
//
// Refused with line or path (Error kind input): what is refused of profile_csv.h, a line below 0 or above kCandidateLines,
// more than kCandidatesPerLine candidates on one, a place that is missing or not finite, no candidate at all, intensities
// for some of them.

#include <filesystem>
#include <string>
#include <string_view>

#include "core/error.h"
#include "core/profile/profile.h"

namespace seamwright {

inline constexpr int kCandidateLines = 1'000'000, kCandidatesPerLine = 64;

struct CandidatesTable {
    ProfileCandidates candidates;
    bool pixels = false;
};

Expected<CandidatesTable> parse_candidates_csv(std::string_view text, const std::string& where);
Expected<CandidatesTable> parse_candidates_json(std::string_view text, const std::string& where);
// By the file's ending: .json, else CSV.
Expected<CandidatesTable> read_candidates(const std::filesystem::path& path);

}  // namespace seamwright
