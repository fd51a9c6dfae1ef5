#pragma once
// What the database keeps added up of its rows: for the sources of this folder alone.
//
// Of each station and hour (UTC) the sums of the values (RowSums, core/statistics/row_sums.h) and the values themselves in ascending
// order, from which is counted what lies beyond any limit; of each day what its hours make together, and runs, cycle times,
// refusals and spots that were not measured. All of it is made anew from the rows of the hour or day that a run lies in, in the
// transaction that stores the run: a run that is sent again, one whose outcome changed and one that comes late count once.

#include <cstdint>
#include <pqxx/pqxx>
#include <string>
#include <vector>

namespace seamwright::fleet {

// Of the hours and days that these runs lie in ("{1,2,3}", ids of rows). The session's time zone is UTC, and who calls holds the
// runs' stations.
void update_sums(pqxx::transaction_base& work, const std::string& runs);
// Of all runs, the sums of before gone.
void rebuild_sums(pqxx::transaction_base& work);

// Columns of hour_sums and day_sums after station, time, panel, region, type.
inline constexpr const char* kSumColumns =
    "key, n, sx, st, sxx, sxt, stt, pn, px, px0, pt, pt0, pxx, pxt, ptx, ptt, ranges, lowest, highest, "
    "first_x, "
    "first_t, last_x, last_t";
// The same from the rows themselves, for windows of time within a day each: $1 stations, $2 from, $3 until, $4 a part type or ''.
// Rows: station, the window's beginning, panel, region, type, columns. Times count from the day's beginning.
std::string counts_select();
std::string sums_select();
// A cycle time's class: to three digits.
std::string cycle_class(const char* milliseconds);

// "{1,2,3}"
std::string array_of(const std::vector<std::int64_t>& numbers);
// Of texts: "{"a","b"}", quoted.
std::string array_of(const std::vector<std::string>& texts);

}  // namespace seamwright::fleet
