#pragma once
// Production in numbers over all stations of a fleet: the database counts and adds up, production_statistics' own functions judge
// (projects/statistics/statistics.h). The values follow each other within a station: what scatters from part to part, correlates and
// charts is never one station against another, except in the charts, which show the newest parts of all in the order of time.
//
// Of closed days the sums are there (fleet_schema.h); those of today, and of days that --since and --until cut, are made from the
// values. Nothing is written, so a user who may only read is enough.

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
