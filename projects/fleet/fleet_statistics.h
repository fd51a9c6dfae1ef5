#pragma once
// Production in numbers over all stations of a fleet: the database counts and adds up, production_statistics' own functions judge
// (projects/statistics/statistics.h). The values follow each other within a station: what scatters from part to part, correlates and
// charts is never one station against another, except in the charts, which show the newest parts of all in the order of time.
//
// From sums that are kept up to date while stations publish (sums.h), of days, of hours where --since and --until cut a day, and of
// the rows where they cut an hour: numbers of parts, means, scatter, capability, correlation, trends, refusals, spots that were not
// measured, mean, scatter and longest of the cycle times. They are those of all values, to rounding. What lies beyond limits is
// counted exactly. Median and 95 % of the cycle times are to three digits. Of the newest kNewestParts alone: charts, EWMA,
// quantiles, the test for normality, the time from part to part. A value below 1e-100 counts as 0, one above 1e100 not at all.
// Nothing is written, so a user who may only read is enough.

#include <string>
#include <vector>

#include "projects/fleet/target.h"
#include "projects/statistics/statistics.h"

namespace seamwright {

// Of each region and panel job; charts and quantiles are theirs.
inline constexpr int kNewestParts = 2000;

struct FleetStatisticsOptions {
    StatisticsOptions statistics;
    std::vector<std::string> stations;  // empty: all
};
// Production::files are the stations, their path their name. No diagnosis of fixtures: that is the stations' own.
// Error (usage): an unknown station or region; (device): the database.
Expected<Statistics> fleet_statistics(const FleetTarget& target, const FleetStatisticsOptions& options);

}  // namespace seamwright
