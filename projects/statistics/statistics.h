#pragma once
// Production in numbers: for each region and panel job how its parts lie, whether that is calm, where it drifts to, why
// parts were refused and how long a part took.
//
// Values. Of a region the six numbers of its displacement D (mm; KUKA angles in degree) that are free, and what D moves
// a path point by across the bead, n . (D p - p) of path_direction.h, at every spot in both directions; of these the
// one with the largest mean square is the worst point. Of a panel job gap and flush of every place as measured after
// the motion, where they were. A value comes of every correction that the gate passed and of those over its limits:
// to leave the latter out would make the parts look better than they were. Other refusals (too few spots, too large
// a sigma) say nothing of where the part lay; they are counted.
//
// Limits. Of a displacement the region's own, of gap and flush taught +- the job's tolerance, of path points half of
// `tolerance_mm` to either side. A region limits the length of the translation and the angle of the rotation, so a
// number within its limits may still be refused. Cpk here says how far the parts are from a refusal; the bead's
// quality after correction is the matter of `acceptance`.
//
// Charts. Shewhart's of single values or of subgroups with Nelson's rules (core/acceptance/stability.h) and the EWMA of
// the single values (core/statistics/ewma.h), limits from the values themselves.

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/acceptance/stability.h"
#include "core/statistics/capability.h"
#include "core/statistics/ewma.h"
#include "core/statistics/row_sums.h"
#include "core/statistics/trend.h"
#include "projects/statistics/diagnosis.h"

namespace seamwright {

struct StatisticsOptions {
    RunValuesWanted runs;
    std::string region;                  // region or panel job; empty: all
    std::optional<double> tolerance_mm;  // T = USL - LSL of a path point
    int subgroup = 1;                    // 1..25 values that follow each other
};

struct Characteristic {
    std::string key;  // "x_mm", "a_deg", "S1_normal_mm", "P1_gap_mm"; of its region unique
    Text name;        // "X", "spot S1, normal"
    const char* unit = "mm";
    bool worst_point = false;  // of the region's path points
    bool path_point = false;
    ProcessLimits limits;
    double nominal = 0;
    std::vector<std::size_t> runs;  // in Production::runs
    std::vector<double> values;     // of a large production only the newest, see ProductionTotals
    ProcessSummary summary;
    std::optional<Stability> chart;  // none: fewer than 2 subgroups, no scatter
    std::optional<Ewma> ewma;
    std::optional<Trend> trend;
    std::vector<Text> caveats;
};

// Why parts were refused, by the pattern of the sentence: whatever numbers and names stood in it.
struct RefusalReason {
    std::string pattern;  // English, with its {}
    Text first;           // as it was said the first time
    int count = 0;
    std::string last_utc;
    // "…" for what varies.
    std::string said(Language language) const;
};
struct UnmeasuredSpot {
    std::string spot_id;
    SpotStatus status = SpotStatus::not_measured;
    int count = 0;
};

// A region or a panel job.
struct RegionStatistics {
    std::string id;
    bool panel = false;
    int runs = 0, passed = 0, over_limit = 0;
    int left_out = 0;  // refused otherwise, or not solved: without a value
    std::vector<Characteristic> characteristics;
    std::vector<RefusalReason> refusals;  // most frequent first
};

// Seconds from the start of a run to its end; of a pushed one the wait for the application to begin is in it.
struct CycleTime {
    int n = 0;
    double mean_s = 0, s_s = 0, median_s = 0, p95_s = 0, longest_s = 0;
    double between_s = 0;  // median time from start to start
};

struct Statistics {
    StatisticsOptions options;
    Production production;  // of a fleet only the newest runs
    std::size_t parts = 0;
    std::string first_utc, last_utc;     // when they were begun; empty: no part
    std::map<std::string, int> by_type;  // of runs that have one
    std::array<int, 8> by_status{};      // by RunStatus
    std::vector<RegionStatistics> regions;
    std::vector<UnmeasuredSpot> unmeasured;  // most frequent first
    std::optional<CycleTime> cycle;
    std::optional<CarrierDiagnosis> diagnosis;  // of a project with a fixture
    std::vector<Text> caveats;
    int count(RunStatus status) const { return by_status[static_cast<std::size_t>(status)]; }
};

// What a database that holds more runs than anybody wants to load says of all of them, where Production has only the newest
// of each region.
struct RegionTotals {
    int runs = 0, passed = 0, over_limit = 0, left_out = 0;
    std::map<std::string, RowSums>
        sums;  // by the key of the characteristic; rows are followed within a station
    std::vector<RefusalReason> refusals;
};
struct ProductionTotals {
    std::size_t parts = 0;
    std::string first_utc, last_utc;
    std::map<std::string, int> by_type;
    std::array<int, 8> by_status{};
    std::map<std::string, RegionTotals> regions, panels;
    std::vector<UnmeasuredSpot> unmeasured;
    std::optional<CycleTime> cycle;
    // How many values of a region's or panel job's characteristic lie beyond its limits.
    std::function<Expected<int>(const std::string& id, bool panel, const std::string& key,
                                const ProcessLimits& limits)>
        beyond;
};

// The six numbers of a displacement (mm; KUKA angles in degree).
inline constexpr std::array<const char*, 6> kDisplacementKeys{"x_mm",  "y_mm",  "z_mm",
                                                              "a_deg", "b_deg", "c_deg"};
std::array<double, 6> displacement_numbers(const Pose& workobject_from_movedworkobject);
std::string path_point_key(const PathDirection& at);
std::string place_key(const std::string& place_id, bool gap);
// Whether a region's displacement is a value of production, see above.
bool is_value(const RegionValue& region);
// What a refusal is counted by: its pattern, and its sentence without those that only join.
std::string refusal_pattern(const Text& text);
const Text& telling_refusal(const Text& text);

// Of runs that were read from anywhere; with `totals` of all that they say, the runs being the newest. Charts, median,
// quantiles and the test for normality are of the runs that are there.
Expected<Statistics> statistics_of(Production production, const StatisticsOptions& options,
                                   const ProductionTotals* totals = nullptr);
Expected<void> check_statistics_options(const StatisticsOptions& options);

// Error (usage): an unknown region, options that are none; (file).
Expected<Statistics> production_statistics(const std::vector<std::filesystem::path>& files,
                                           const StatisticsOptions& options);

}  // namespace seamwright
